// SPDX-License-Identifier: GPL-3.0-or-later
#include "filter_parameters.h"

#include <algorithm>
#include <limits>
#include <locale>
#include <sstream>

namespace orthopoly {

namespace {

FilterParameter named(const char* name, const char* label, const std::string& tooltip)
{
	FilterParameter parameter;
	parameter.name = name;
	parameter.label = label;
	parameter.tooltip = tooltip;
	return parameter;
}

bool is_anything_selected(const CMeshO& mesh)
{
	return std::any_of(mesh.face.begin(), mesh.face.end(), [](const CFaceO& face) {
		return !face.IsD() && face.IsS();
	});
}

constexpr double DEFAULT_MAX_ANGLE = 30;

} // namespace

FilterParameter only_selected_parameter(const MeshDocument& document)
{
	FilterParameter parameter = named(
		"only_selected",
		"Affect only selected faces",
		"Only vertices whose faces are all selected move; the others stay exactly where they are. On by "
		"default where anything is selected: a forgotten selection restricts the filter too, which the "
		"log tells.");
	parameter.type = ParameterType::Boolean;
	parameter.maximum = 1;
	parameter.default_value =
		document.mm() != nullptr && is_anything_selected(document.mm()->cm) ? 1 : 0;
	return parameter;
}

FilterParameter reference_parameter(const MeshDocument& document, const std::string& tooltip)
{
	FilterParameter parameter = named("reference", "Reference mesh", tooltip);
	parameter.input = FilterParameter::Input::Layer;
	if (document.mm() == nullptr)
		return parameter;
	const int current = static_cast<int>(document.mm()->id());
	int chosen = current;
	for_each_layer(document, [&](const MeshModel& layer) {
		if (chosen == current)
			chosen = static_cast<int>(layer.id());
	});
	parameter.default_value = chosen;
	return parameter;
}

FilterParameter max_angle_parameter()
{
	FilterParameter parameter = named(
		"max_angle",
		"Colour range (degrees)",
		"Angular error drawn in red, 0.1 to 180 degrees; 0 is blue, cyan, green and yellow lie between, "
		"and what is above stays red. Less shows smaller errors. The range is fixed so that the colours "
		"of two results can be compared: use the same one for both.");
	parameter.minimum = 0.1;
	parameter.maximum = 180;
	parameter.default_value = DEFAULT_MAX_ANGLE;
	return parameter;
}

FilterParameter max_distance_parameter(const MeshDocument& document)
{
	FilterParameter parameter = named(
		"max_distance",
		"Largest distance (0: no limit)",
		"Faces and vertices farther than this from the reference are not measured: they turn grey, "
		"with quality -1. A length, or a percentage of the bounding box diagonal of the current layer. "
		"0 measures everything. Set it where the reference covers only a part of the mesh.");
	parameter.input = FilterParameter::Input::Length;
	parameter.maximum = std::numeric_limits<float>::max();
	if (document.mm() != nullptr)
		parameter.full_length = document.mm()->cm.bbox.Diag();
	// A percentage of nothing is of no use, and some hosts divide by it.
	if (!(parameter.full_length > 0 && parameter.full_length < parameter.maximum))
		parameter.full_length = 1;
	return parameter;
}

double checked_value(const FilterParameter& parameter, const ParameterValues& values)
{
	const double value = values.numbers.at(parameter.name);
	parameter.check(value);
	return value;
}

double as_written(float value)
{
	for (int digits = 6; digits <= std::numeric_limits<float>::max_digits10; ++digits) {
		std::stringstream text;
		text.imbue(std::locale::classic());
		text.precision(digits);
		text << value;
		double number = 0;
		text >> number;
		if (static_cast<float>(number) == value)
			return number;
	}
	// Not a finite number: left for the range check to refuse.
	return static_cast<double>(value);
}

} // namespace orthopoly
