// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshlab_document.h"
#include "parameters.h"

#include <map>
#include <string>
#include <vector>

namespace orthopoly {

/// A parameter as a host shows it: one of the core's tables, or one that only a host has.
struct FilterParameter : ParameterInfo {
	enum class Input {
		/// What the type of the core says.
		Value,
		/// A choice among the layers of the document; the value is the id of one.
		Layer,
		/// A length, also offered as a percentage of `full_length`.
		Length,
	};
	Input input = Input::Value;
	double default_value = 0;
	/// Length: what 100 % is.
	double full_length = 1;
};

using FilterParameters = std::vector<FilterParameter>;

/// The values a host hands over. A layer that is not there is null.
struct ParameterValues {
	std::map<std::string, double> numbers;
	std::map<std::string, MeshModel*> layers;

	bool is_on(const std::string& name) const { return numbers.at(name) != 0; }
};

/// The table of the core with its defaults, as parameters of a filter.
template<class Options>
FilterParameters table_parameters(const ParameterTable<Options>& table)
{
	FilterParameters parameters;
	for (const Parameter<Options>& entry : table) {
		FilterParameter parameter;
		static_cast<ParameterInfo&>(parameter) = entry;
		parameter.default_value = entry.get(Options());
		parameters.push_back(parameter);
	}
	return parameters;
}

/// The options that the values of the table's parameters stand for. Throws InvalidParameter.
template<class Options>
Options table_options(const ParameterTable<Options>& table, const ParameterValues& values)
{
	Options options;
	for (const Parameter<Options>& entry : table) {
		const double value = values.numbers.at(entry.name);
		entry.check(value);
		entry.set(options, value);
	}
	return options;
}

/// "Affect only selected faces", on where anything is selected, as MeshLab's own filters have it.
FilterParameter only_selected_parameter(const MeshDocument& document);

/// The layer to compare with: by default the first one that is not the current one.
FilterParameter reference_parameter(const MeshDocument& document, const std::string& tooltip);

/// The angle that is drawn in the last colour of the ramp, degrees.
FilterParameter max_angle_parameter();

/// The distance beyond which nothing is measured.
FilterParameter max_distance_parameter(const MeshDocument& document);

/// The value of a parameter that is not in a table of the core. Throws InvalidParameter.
double checked_value(const FilterParameter& parameter, const ParameterValues& values);

/// The number a person wrote, where the host keeps it in single precision only: 0.65 rather than
/// 0.64999998, so that all hosts and the command work with the same value.
double as_written(float value);

} // namespace orthopoly
