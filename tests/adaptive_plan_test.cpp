// SPDX-License-Identifier: GPL-3.0-or-later
#include "adaptive_plan.h"

#include <catch2/catch.hpp>

using namespace orthopoly;

namespace {

constexpr Correlation WHITE = {};

} // namespace

TEST_CASE("A plan changes little where the noise does", "[adaptive_plan]")
{
	constexpr double STEP = 0.001;
	AdaptivePlan before = plan_for({}, STEP, WHITE);
	for (int k = 2; k < 1600; ++k) {
		const AdaptivePlan plan = plan_for({}, k * STEP, WHITE);
		CAPTURE(k * STEP);
		CHECK(plan.cos_threshold == Approx(before.cos_threshold).margin(0.005));
		CHECK(plan.cos_threshold_increment == Approx(before.cos_threshold_increment).margin(0.005));
		CHECK(plan.guiding == Approx(before.guiding).margin(0.02));
		CHECK(
			plan.prefilter_pairs(plan.noise) ==
			Approx(before.prefilter_pairs(before.noise)).margin(0.05));
		CHECK(plan.rings.largest >= before.rings.largest);
		CHECK(plan.rings.largest <= before.rings.largest + 1);
		before = plan;
	}
}

TEST_CASE("A plan for noise of neither kind lies between", "[adaptive_plan]")
{
	for (const double noise : {0.05, 0.2, 0.4}) {
		const AdaptivePlan white = plan_for({}, noise, WHITE);
		for (const double reach : {0.0, 1.0}) {
			const AdaptivePlan scanner = plan_for({}, noise, {1, reach});
			const AdaptivePlan half = plan_for({}, noise, {0.4, reach});
			CHECK(half.is_mostly_white());
			CHECK_FALSE(scanner.is_mostly_white());
			CHECK(scanner.selection > half.selection);
			CHECK(half.selection > white.selection);
			CHECK(scanner.rings.largest > half.rings.largest);
			CHECK(half.rings.largest > white.rings.largest);
			CHECK(
				half.cos_threshold ==
				Approx(0.6 * white.cos_threshold + 0.4 * scanner.cos_threshold));
			CHECK(
				half.prefilter_pairs(noise) ==
				Approx(0.6 * white.prefilter_pairs(noise) + 0.4 * scanner.prefilter_pairs(noise)));
		}
	}
	CHECK(plan_for({}, 0.2, {1, 1}).selection > plan_for({}, 0.2, {1, 0}).selection);
}

TEST_CASE("What is set is planned, and written down", "[adaptive_plan]")
{
	DenoiseOptions options;
	options.iterations = 3;
	options.vertex_iterations = 7;
	options.structure_ring = 1;
	options.cos_threshold = 0.9;
	options.cos_threshold_increment = 0.2;
	const AdaptivePlan plan = plan_for(options, 0.3, WHITE);
	CHECK(plan.iterations == 3);
	CHECK(plan.guiding == 1);
	CHECK(plan.vertex_iterations == 7);
	CHECK(plan.rings.largest == 1);
	CHECK(plan.rings.smallest == 1);
	CHECK(plan.height_rings.largest >= plan.height_rings.smallest);
	CHECK(plan.cos_threshold_of(0) == 0.9);
	// However many iterations raise it, some directions are still similar.
	CHECK(plan.cos_threshold_of(2) < 1);
	DenoiseOptions resolved;
	record(plan, resolved);
	CHECK(resolved.iterations == 3);
	CHECK(resolved.vertex_iterations == 7);
	CHECK(resolved.structure_ring == 1);
	CHECK(resolved.cos_threshold == 0.9);
	CHECK(resolved.cos_threshold_increment == 0.2);
}

TEST_CASE("Rings are in order, whatever reach is set", "[adaptive_plan]")
{
	DenoiseOptions options;
	for (const int ring : {1, 10}) {
		options.structure_ring = ring;
		for (const double noise : {0.05, 0.2, 0.5}) {
			const AdaptivePlan plan = plan_for(options, noise, WHITE);
			CHECK(plan.rings.largest == ring);
			CHECK(plan.rings.smallest >= 1);
			CHECK(plan.rings.smallest <= plan.rings.largest);
			CHECK(plan.height_rings.smallest >= 1);
			CHECK(plan.height_rings.smallest <= plan.height_rings.largest);
		}
	}
}

TEST_CASE("Structures grow with strong noise", "[adaptive_plan]")
{
	const AdaptivePlan ordinary = plan_for({}, 0.4, WHITE);
	const AdaptivePlan strong = plan_for({}, 1.2, WHITE);
	CHECK(strong.rings.largest >= 2 * ordinary.rings.largest);
	CHECK(strong.rings.smallest > ordinary.rings.smallest);
	CHECK(strong.faces_per_structure > ordinary.faces_per_structure);
	// So may what is prefiltered, at places of more noise than elsewhere too.
	CHECK(strong.prefilter_pairs(3) > ordinary.prefilter_pairs(3));
}

TEST_CASE("Heights follow a reach that is set, but for the widest", "[adaptive_plan]")
{
	const int by_itself = plan_for({}, 0.2, WHITE).height_rings.largest;
	const auto planned = [](int ring) {
		DenoiseOptions options;
		options.structure_ring = ring;
		return plan_for(options, 0.2, WHITE).height_rings.largest;
	};
	CHECK(planned(1) < planned(2));
	CHECK(planned(2) < by_itself);
	CHECK(planned(10) == by_itself);
}

TEST_CASE("The strength dial halves and doubles", "[adaptive_plan]")
{
	CHECK(strength_factor(Strength::Normal) == 1);
	CHECK(strength_factor(Strength::Gentle) == 0.5);
	CHECK(strength_factor(Strength::Strong) == 2);
	// How much is smoothed doubles as well, whatever the noise.
	DenoiseOptions strong;
	strong.strength = Strength::Strong;
	CHECK(
		plan_for(strong, 0.4, {1, 0}).scanner_pairs ==
		Approx(2 * plan_for({}, 0.2, {1, 0}).scanner_pairs));
}
