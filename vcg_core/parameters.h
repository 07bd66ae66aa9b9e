// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "denoise.h"
#include "errors.h"
#include "noise.h"

#include <functional>
#include <string>
#include <vector>

namespace orthopoly {

enum class ParameterType { Boolean, Integer, Real, Choice };

/// The value that stands for "automatic" wherever a parameter may be automatic.
constexpr double AUTOMATIC = -1.0;

/// What every host has to know of a parameter, whatever it belongs to.
struct ParameterInfo {
	/// snake_case; the same in every host, frozen once released.
	std::string name;
	/// A few words for a dialog.
	std::string label;
	/// What it does, the effect of more and of less, unit, range, when to change it.
	std::string tooltip;
	ParameterType type = ParameterType::Real;
	/// Range of accepted values (Integer and Real), both ends included.
	double minimum = 0;
	double maximum = 0;
	/// True where -1 (in `orthopoly` also the word auto) lets the method choose.
	bool can_be_automatic = false;
	/// Names of a Choice's values, in the order of their numbers.
	std::vector<std::string> choices = {};
	/// Shown only to those who ask for it.
	bool advanced = false;

	/// Throws InvalidParameter, naming the parameter, the value and the range, where the value is
	/// not finite, out of the range, or not whole for a type that wants whole numbers.
	void check(double value) const;

	/// Reads a value as a person writes it: a number, true or false, the name of a choice, auto.
	/// Throws InvalidParameter as `check` does, and where the text is none of these.
	double parse(const std::string& text) const;

	/// The value as a person would write it: the inverse of `parse`.
	std::string format(double value) const;
};

/// A parameter and the field it stands for. Booleans are 0 or 1, choices their number.
template<class Options>
struct Parameter : ParameterInfo {
	std::function<double(const Options&)> get;
	/// Stores a value that has been checked.
	std::function<void(Options&, double)> set;
};

/// The parameters of a struct of options, in the order a dialog shows them.
template<class Options>
using ParameterTable = std::vector<Parameter<Options>>;

const ParameterTable<DenoiseOptions>& denoise_parameters();
const ParameterTable<NoiseOptions>& noise_parameters();

/// Sets the parameter of that name from text. Throws InvalidParameter where there is no such name
/// (the message lists those there are) or the value is refused.
template<class Options>
void set_parameter(
	const ParameterTable<Options>& table,
	const std::string& name,
	const std::string& text,
	Options& options)
{
	const auto* parameter = static_cast<const Parameter<Options>*>(nullptr);
	std::string known;
	for (const Parameter<Options>& candidate : table) {
		if (candidate.name == name)
			parameter = &candidate;
		known += (known.empty() ? "" : ", ") + candidate.name;
	}
	if (parameter == nullptr)
		throw InvalidParameter("there is no parameter '" + name + "'; there are " + known);
	parameter->set(options, parameter->parse(text));
}

} // namespace orthopoly
