// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameters.h"

#include "number_text.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

namespace orthopoly {

namespace {

template<class Value>
struct IsOptional : std::false_type {
};
template<class Value>
struct IsOptional<std::optional<Value>> : std::true_type {
};

// Joins what a host shows to the field it stands for.
template<class Options, class Field>
Parameter<Options> bind(Field Options::*field, ParameterInfo info)
{
	Parameter<Options> parameter;
	static_cast<ParameterInfo&>(parameter) = std::move(info);
	if constexpr (IsOptional<Field>::value) {
		using Value = typename Field::value_type;
		parameter.can_be_automatic = true;
		parameter.get = [field](const Options& options) {
			const Field& value = options.*field;
			return value ? static_cast<double>(*value) : AUTOMATIC;
		};
		parameter.set = [field](Options& options, double value) {
			options.*field = value == AUTOMATIC ? Field() : Field(static_cast<Value>(value));
		};
	}
	else {
		parameter.get = [field](const Options& options) {
			return static_cast<double>(options.*field);
		};
		parameter.set = [field](Options& options, double value) {
			options.*field = static_cast<Field>(value);
		};
	}
	return parameter;
}

ParameterInfo named(ParameterType type, const char* name, const char* label, const char* tooltip)
{
	ParameterInfo info;
	info.name = name;
	info.label = label;
	info.tooltip = tooltip;
	info.type = type;
	return info;
}

ParameterInfo boolean(const char* name, const char* label, const char* tooltip)
{
	ParameterInfo info = named(ParameterType::Boolean, name, label, tooltip);
	info.maximum = 1;
	return info;
}

ParameterInfo within(double minimum, double maximum, ParameterInfo info)
{
	info.minimum = minimum;
	info.maximum = maximum;
	return info;
}

ParameterInfo choice(std::vector<std::string> choices, ParameterInfo info)
{
	info.choices = std::move(choices);
	info.maximum = static_cast<double>(info.choices.size() - 1);
	return info;
}

ParameterInfo advanced(ParameterInfo info)
{
	info.advanced = true;
	return info;
}

std::string accepted_values(const ParameterInfo& info)
{
	std::string text;
	if (info.type == ParameterType::Boolean) {
		text = "true or false";
	}
	else if (info.type == ParameterType::Choice) {
		for (std::size_t i = 0; i < info.choices.size(); ++i)
			text += (i == 0 ? "" : ", ") + info.choices[i];
	}
	else {
		text = std::string(info.type == ParameterType::Integer ? "a whole number" : "a number") +
			   " from " + number_text(info.minimum) + " to " + number_text(info.maximum);
	}
	return info.can_be_automatic ? text + ", or -1 for automatic" : text;
}

[[noreturn]] void refuse(const ParameterInfo& info, const std::string& value)
{
	throw InvalidParameter(info.name + " is " + value + "; give " + accepted_values(info));
}

} // namespace

void ParameterInfo::check(double value) const
{
	if (can_be_automatic && value == AUTOMATIC)
		return;
	const bool whole = type == ParameterType::Real || value == std::floor(value);
	// Written so that a value which is not a number is refused as well.
	if (!(value >= minimum && value <= maximum && whole))
		refuse(*this, number_text(value));
}

double ParameterInfo::parse(const std::string& text) const
{
	double value = 0;
	if (can_be_automatic && text == "auto")
		return AUTOMATIC;
	for (std::size_t i = 0; i < choices.size(); ++i) {
		if (choices[i] == text)
			return static_cast<double>(i);
	}
	if (type == ParameterType::Boolean && (text == "true" || text == "false"))
		return text == "true" ? 1 : 0;
	if (!read_number(text, value))
		refuse(*this, "'" + text + "'");
	check(value);
	return value;
}

std::string ParameterInfo::format(double value) const
{
	if (can_be_automatic && value == AUTOMATIC)
		return "auto";
	if (type == ParameterType::Choice)
		return choices[static_cast<std::size_t>(value)];
	if (type == ParameterType::Boolean)
		return value != 0 ? "true" : "false";
	return number_text(value);
}

const ParameterTable<DenoiseOptions>& denoise_parameters()
{
	using Options = DenoiseOptions;
	using Type = ParameterType;
	static const ParameterTable<Options> table = {
		bind(
			&Options::method,
			choice(
				{"adaptive", "paper"},
				named(
					Type::Choice,
					"method",
					"Method",
					"adaptive finds everything it needs from the mesh itself and is the one to use. "
					"paper is the published method (discrete orthogonal polynomials over non-local "
					"similar structures) with its own parameters, to compare with."))),
		bind(
			&Options::strength,
			choice(
				{"gentle", "normal", "strong"},
				named(
					Type::Choice,
					"strength",
					"Strength",
					"How much to take away: gentle removes what half the estimated noise would "
					"explain, normal all of it, strong twice as much. Choose gentle where fine detail "
					"is lost, strong where noise is left. Adaptive method only."))),
		bind(
			&Options::noise_type,
			choice(
				{"auto", "white", "scanner"},
				named(
					Type::Choice,
					"noise_type",
					"Kind of noise",
					"white: every vertex is off by itself, as in most tests and many scans. scanner: "
					"the errors of neighbouring vertices go together over several edges, as depth "
					"cameras, volumes and surface reconstructions leave them: a rippled surface; much "
					"wider surroundings are used. auto takes it for white unless its noise clearly "
					"goes together: on a single view of a depth camera, on a mesh extracted from a "
					"volume, as reconstructions are, and where smoothing or decimation left ripples on "
					"smooth parts. Set scanner for such noise on other meshes, white to keep a fine "
					"relief that is the same all over. Adaptive method only."))),
		bind(
			&Options::noise_level,
			within(
				0,
				2,
				named(
					Type::Real,
					"noise_level",
					"Noise level (-1: automatic)",
					"Standard deviation of the noise along the surface normal, in mean edge lengths, "
					"0 to 2; where it differs from place to place, the root mean square. -1 "
					"estimates it from the vertices that may move, and does nothing where that is "
					"below 0.025, but for spikes (lone vertices far out), which are put back; a level "
					"that is set is used however small. More smooths more, less keeps more detail. "
					"Set it where the estimate in the log is wrong. Adaptive method only."))),
		bind(
			&Options::iterations,
			within(
				1,
				50,
				named(
					Type::Integer,
					"iterations",
					"Iterations (-1: automatic)",
					"Rounds of normal filtering and vertex update, 1 to 50. -1 lets the method choose "
					"(the paper: 5; the adaptive method: 1 or 2). More makes flat regions flatter and "
					"edges sharper, and costs fine detail and time."))),
		bind(
			&Options::keep_boundary,
			boolean(
				"keep_boundary",
				"Keep boundary vertices",
				"Vertices on open edges, which belong to one face only, stay exactly where they are. "
				"Use it where the mesh must still fit its neighbour; the noise on the boundary then "
				"stays too.")),
		bind(
			&Options::vertex_iterations,
			advanced(within(
				1,
				500,
				named(
					Type::Integer,
					"vertex_iterations",
					"Vertex update steps (-1: automatic)",
					"Steps that move the vertices towards the filtered normals in each iteration, 1 to "
					"500 (the paper: 10). More follows the normals more closely; fewer leaves the "
					"vertices closer to where they were. The adaptive method takes a quarter of them "
					"before the last iteration.")))),
		bind(
			&Options::structure_ring,
			advanced(within(
				1,
				Options::MAX_RINGS,
				named(
					Type::Integer,
					"structure_ring",
					"Structure ring R (-1: automatic)",
					"Rings of faces searched for similar structures, 1 to 10. The adaptive method "
					"tries smaller ones too and takes the best for each face, and goes further "
					"for heights, up to 14; in the paper's method it "
					"may not be less than the guide ring, and automatic is one more. More averages "
					"over a wider surrounding and takes longer (with the square of it).")))),
		bind(
			&Options::cos_threshold,
			advanced(within(
				-1 + 1e-3,
				1,
				named(
					Type::Real,
					"cos_threshold",
					"Similarity threshold, cosine (-1: automatic)",
					"Directions whose cosine is above this count as similar, up to 1. Paper: 0.7 to "
					"0.9 for little noise, 0.5 to 0.65 for much. The adaptive method uses it for "
					"normals only, and up to 0.95; it tries a lower one (by 0.25) too, and takes the "
					"better for each face. More keeps shallower edges, less removes more noise.")))),
		bind(
			&Options::cos_threshold_increment,
			advanced(within(
				0,
				1,
				named(
					Type::Real,
					"cos_threshold_increment",
					"Threshold increment (-1: automatic)",
					"Added to the similarity threshold after each iteration, 0 to 1 (the paper: 0.05 "
					"to 0.08). More makes later iterations respect shallower edges.")))),
		bind(
			&Options::guide_ring,
			advanced(within(
				1,
				Options::MAX_RINGS,
				named(
					Type::Integer,
					"guide_ring",
					"Guide ring r (paper)",
					"Rings of faces that vote for the direction of a face's surroundings, 1 to 10; not "
					"more than the structure ring. More steadies the direction in strong noise and "
					"blurs small features. Paper's method only.")))),
		bind(
			&Options::sigma_theta,
			advanced(within(
				1,
				90,
				named(
					Type::Real,
					"sigma_theta",
					"Angle scale sigma_theta in degrees (paper)",
					"How fast the vote of a neighbour falls with the angle between the normals (eq. 3), "
					"1 to 90 degrees. More lets faces across an edge vote too. Paper's method only.")))),
		bind(
			&Options::order_x,
			advanced(within(
				0,
				10,
				named(
					Type::Integer,
					"order_x",
					"Polynomial order a (paper)",
					"Order of the polynomials along the rows of the matrix of normals (eq. 11), 0 to "
					"10. 0 fits the mean; more follows the normals, and their noise, more closely. "
					"Paper's method only.")))),
		bind(
			&Options::order_y,
			advanced(within(
				0,
				10,
				named(
					Type::Integer,
					"order_y",
					"Polynomial order b (paper)",
					"Order of the polynomials along the columns of the matrix of normals (eq. 11), 0 "
					"to 10. 0 fits the mean; more follows the normals, and their noise, more closely. "
					"Paper's method only.")))),
		bind(
			&Options::threads,
			advanced(within(
				0,
				256,
				named(
					Type::Integer,
					"threads",
					"Threads (0: all processors)",
					"Processors to work on, 0 to 256; 0 takes all. The result is the same bit for bit "
					"on any number.")))),
	};
	return table;
}

const ParameterTable<NoiseOptions>& noise_parameters()
{
	using Options = NoiseOptions;
	using Type = ParameterType;
	static const ParameterTable<Options> table = {
		bind(
			&Options::sigma,
			within(
				0,
				10,
				named(
					Type::Real,
					"sigma",
					"Standard deviation (mean edge lengths)",
					"Standard deviation of the displacement in mean edge lengths, 0 to 10. 0.1 is "
					"mild, 0.3 strong, beyond 0.5 most faces have lost their direction."))),
		bind(
			&Options::direction,
			choice(
				{"random", "normal", "isotropic"},
				named(
					Type::Choice,
					"direction",
					"Direction",
					"random: a Gaussian amplitude along a direction drawn evenly from the sphere. "
					"normal: along the vertex normal. isotropic: independent along each axis."))),
		bind(
			&Options::impulsive_share,
			within(
				0,
				1,
				named(
					Type::Real,
					"impulsive_share",
					"Share of vertices moved",
					"Share of the vertices that are moved, 0 to 1. 1 is ordinary noise; 0.1 leaves "
					"most of the mesh clean with outliers here and there."))),
		bind(
			&Options::seed,
			within(
				0,
				// What a host's integer field holds.
				std::numeric_limits<std::int32_t>::max(),
				named(
					Type::Integer,
					"seed",
					"Seed",
					"Start of the random numbers. The same mesh, parameters and seed give the same "
					"noise on every platform; another seed gives another noise."))),
	};
	return table;
}

} // namespace orthopoly
