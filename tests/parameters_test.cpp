// SPDX-License-Identifier: GPL-3.0-or-later
#include "parameters.h"

#include "comma_locale.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>
#include <string>
#include <vector>

using namespace orthopoly;
using Catch::Contains;

namespace {

template<class Options>
void check_table(const ParameterTable<Options>& table)
{
	std::set<std::string> names;
	const Options defaults;
	for (const Parameter<Options>& parameter : table) {
		CAPTURE(parameter.name);
		CHECK(names.insert(parameter.name).second);
		for (const char c : parameter.name)
			CHECK(
				(std::islower(static_cast<unsigned char>(c)) || c == '_' ||
				 std::isdigit(static_cast<unsigned char>(c))));
		CHECK_FALSE(parameter.label.empty());
		CHECK(std::isupper(static_cast<unsigned char>(parameter.label.front())));
		CHECK(parameter.tooltip.size() > 40);
		CHECK(parameter.tooltip.back() == '.');
		CHECK(parameter.minimum < parameter.maximum);
		CHECK_NOTHROW(parameter.check(parameter.get(defaults)));
		CHECK((parameter.type == ParameterType::Choice) == !parameter.choices.empty());

		// Both ends of the range are accepted and come back from the field as they went in.
		for (const double value : {parameter.minimum, parameter.maximum}) {
			Options options;
			CHECK_NOTHROW(parameter.check(value));
			parameter.set(options, value);
			CHECK(parameter.get(options) == value);
			CHECK(parameter.parse(parameter.format(value)) == value);
		}
		for (const double value :
			 {parameter.maximum + 1,
			  std::min(parameter.minimum, AUTOMATIC) - 1,
			  std::numeric_limits<double>::quiet_NaN(),
			  std::numeric_limits<double>::infinity()}) {
			CHECK_THROWS_AS(parameter.check(value), InvalidParameter);
			CHECK_THROWS_WITH(parameter.check(value), Contains(parameter.name));
		}
		if (parameter.type == ParameterType::Integer)
			CHECK_THROWS_AS(parameter.check(parameter.minimum + 0.5), InvalidParameter);

		Options options;
		if (parameter.can_be_automatic) {
			parameter.set(options, AUTOMATIC);
			CHECK(parameter.get(options) == AUTOMATIC);
			CHECK(parameter.parse("auto") == AUTOMATIC);
			CHECK(parameter.parse("-1") == AUTOMATIC);
			CHECK(parameter.format(AUTOMATIC) == "auto");
		}
		else {
			// A choice may be called that.
			const auto& choices = parameter.choices;
			if (std::find(choices.begin(), choices.end(), "auto") == choices.end())
				CHECK_THROWS_AS(parameter.parse("auto"), InvalidParameter);
			else
				CHECK(parameter.format(parameter.parse("auto")) == "auto");
		}
		CHECK_THROWS_AS(parameter.parse(""), InvalidParameter);
		CHECK_THROWS_AS(parameter.parse("1x"), InvalidParameter);
		CHECK_THROWS_AS(parameter.parse("much"), InvalidParameter);
	}
}

} // namespace

TEST_CASE("every parameter has what a host needs and refuses what it must", "[parameters]")
{
	check_table(denoise_parameters());
	check_table(noise_parameters());
}

TEST_CASE("choices are set by name or number", "[parameters]")
{
	DenoiseOptions options;
	set_parameter(denoise_parameters(), "method", "paper", options);
	CHECK(options.method == Method::Paper);
	set_parameter(denoise_parameters(), "method", "0", options);
	CHECK(options.method == Method::Adaptive);
	set_parameter(denoise_parameters(), "strength", "strong", options);
	CHECK(options.strength == Strength::Strong);
	CHECK_THROWS_WITH(
		set_parameter(denoise_parameters(), "method", "bilateral", options),
		Contains("'bilateral'") && Contains("adaptive, paper"));
	CHECK_THROWS_AS(
		set_parameter(denoise_parameters(), "method", "0.5", options), InvalidParameter);
	NoiseOptions noise;
	set_parameter(noise_parameters(), "direction", "isotropic", noise);
	CHECK(noise.direction == NoiseDirection::Isotropic);
}

TEST_CASE("switches and numbers are set from text", "[parameters]")
{
	DenoiseOptions options;
	set_parameter(denoise_parameters(), "keep_boundary", "true", options);
	CHECK(options.keep_boundary);
	set_parameter(denoise_parameters(), "keep_boundary", "0", options);
	CHECK_FALSE(options.keep_boundary);
	set_parameter(denoise_parameters(), "cos_threshold", "7.5e-1", options);
	CHECK(options.cos_threshold == 0.75);
	set_parameter(denoise_parameters(), "iterations", "12", options);
	CHECK(options.iterations == 12);
	set_parameter(denoise_parameters(), "iterations", "auto", options);
	CHECK_FALSE(options.iterations.has_value());
}

TEST_CASE("an unknown name is refused with those that are known", "[parameters]")
{
	DenoiseOptions options;
	CHECK_THROWS_AS(set_parameter(denoise_parameters(), "sigma_s", "1", options), InvalidParameter);
	CHECK_THROWS_WITH(
		set_parameter(denoise_parameters(), "sigma_s", "1", options),
		Contains("'sigma_s'") && Contains("cos_threshold") && Contains("iterations"));
}

TEST_CASE("numbers do not depend on the locale", "[parameters]")
{
	const CommaLocale comma;
	DenoiseOptions options;
	set_parameter(denoise_parameters(), "sigma_theta", "12.5", options);
	CHECK(options.sigma_theta == 12.5);
	CHECK_THROWS_AS(
		set_parameter(denoise_parameters(), "sigma_theta", "12,5", options), InvalidParameter);
	for (const Parameter<DenoiseOptions>& parameter : denoise_parameters()) {
		if (parameter.name == "sigma_theta")
			CHECK(parameter.format(12.5) == "12.5");
		if (parameter.name == "threads")
			CHECK(parameter.format(1234) == "1234");
	}
	// The check is one only where the comma has come into force.
	std::ostringstream text;
	text << 1234.5;
	CHECK(text.str() == "1.234,5");
}

TEST_CASE("options at odds with each other are refused", "[parameters]")
{
	DenoiseOptions options;
	CHECK_NOTHROW(validate(options));
	options.method = Method::Paper;
	options.guide_ring = 4;
	options.structure_ring = 3;
	CHECK_THROWS_AS(validate(options), InvalidParameter);
	CHECK_THROWS_WITH(
		validate(options), Contains("guide_ring is 4") && Contains("structure_ring is 3"));
	options.structure_ring = 4;
	CHECK_NOTHROW(validate(options));
	options.sigma_theta = std::nan("");
	CHECK_THROWS_WITH(validate(options), Contains("sigma_theta"));
}
