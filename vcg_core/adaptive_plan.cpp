// SPDX-License-Identifier: GPL-3.0-or-later
#include "adaptive_plan.h"

#include "interpolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace orthopoly {

namespace {

// Noise from which a prefilter pays (fading in until the second): below it faces do not fold, and
// smoothing would only cost detail.
constexpr double PREFILTER_FROM = 0.065;
constexpr double PREFILTER_FULL = 0.095;

// Taubin pairs of the prefilter: a base, and more with the noise over the edges around a vertex, as
// much as folds ask for. More than the most, and it would reach beyond the structures; those of
// strong noise are wider.
constexpr double PREFILTER_BASE_PAIRS = 0.5;
constexpr double PREFILTER_PAIRS_PER_NOISE = 5;
constexpr double MOST_PREFILTER_PAIRS = 8;
constexpr double MOST_STRONG_PREFILTER_PAIRS = 16;

// Noise from which structures have to grow with it, until the second: on fine meshes, which have
// so much of it, more rings still see a plain piece of the surface.
constexpr double STRONG_FROM = 0.45;
constexpr double STRONG_FULL = 1.1;
constexpr Rings ORDINARY_RINGS = {3, 5};
constexpr Rings STRONG_RINGS = {6, 10};

// Iterations, the last of which makes the result, and those before better guides for it. Up to the
// first noise guides need no improving, and filtering twice would only cost detail; from there to
// the second the first of two iterations moves vertices a growing part of its way.
constexpr int ITERATIONS = 2;
constexpr double GUIDING_FROM = 0.12;
constexpr double GUIDING_FULL = 0.18;

// Steps of the vertex update in the last iteration (accelerated ones: as good as three to five
// times as many plain ones), and what part of them guides need: triangles turn long before waves
// over many of them settle.
constexpr int VERTEX_ITERATIONS = 20;
constexpr double GUIDING_SHARE = 0.25;

// Increment of the threshold of similar directions, from one noise to the other: the more noise the
// first iteration took out of the guides, the stricter the next can be.
constexpr double LEAST_INCREMENT = 0.05;
constexpr double LEAST_INCREMENT_NOISE = 0.1;
constexpr double LARGEST_INCREMENT = 0.08;
constexpr double LARGEST_INCREMENT_NOISE = 0.2;

// Energy over noise variance from which a coefficient is kept: three standard deviations.
constexpr double SELECTION = 9;

// Noise from which structures are wide: height structures of one ring hold too few vertices to be
// worth fitting, and those of normals have so many members in common that some of the faces having
// their own is enough; fewer where they are widest.
constexpr double WIDE_STRUCTURES_NOISE = 0.15;
constexpr int FACES_PER_WIDE_STRUCTURE = 3;
constexpr int FACES_PER_WIDEST_STRUCTURE = 6;

// Rings of the height structures: more than those of the normals, since heights are steadier the
// wider they reach. Fourteen rings instead of seven leave half the angle of a flat face at noise of
// 0.1, two thirds at 0.3.
constexpr int HEIGHT_RINGS = 14;
constexpr int FACES_PER_HEIGHT_STRUCTURE = 2;
constexpr int FACES_PER_WIDE_HEIGHT_STRUCTURE = 4;

// Noise correlated over several edges: more smoothing from one noise to the other, where guides are
// no longer steady without, structures that may be wide but are of strictly similar directions, and
// a selection that allows for each independent value being shared by some twenty faces; by seven
// where it goes together over an edge or two, and structures need not be that wide. Heights are no
// better known than normals then. Where it is not certain that the noise is of that kind,
// everything lies between.
constexpr double LEAST_SCANNER_PAIRS = 3;
constexpr double LEAST_SCANNER_PAIRS_NOISE = 0.15;
constexpr double MOST_SCANNER_PAIRS = 10;
constexpr double MOST_SCANNER_PAIRS_NOISE = 0.25;
constexpr Rings NEAR_RINGS = {2, 8};
constexpr Rings FAR_RINGS = {3, 10};
constexpr int FACES_PER_SCANNER_STRUCTURE = 6;
constexpr double SCANNER_THRESHOLD = 0.85;
constexpr double SCANNER_THRESHOLD_INCREMENT = 0.05;
constexpr double NEAR_SELECTION = 60;
constexpr double FAR_SELECTION = 200;

// Steps of the vertex update where that is more likely than not; plain ones, since vertices are
// held back too little there should accelerated ones go too far.
constexpr int SCANNER_VERTEX_ITERATIONS = 60;

// No threshold of similar directions is higher, however many iterations raise it: with none but the
// face itself above it, there would be nothing to tell the noise by.
constexpr double HIGHEST_THRESHOLD = 0.95;

// Threshold of similar directions by noise level: strict while normals can be trusted, loose enough
// for their scatter after the prefilter beyond.
double cos_threshold_for(double noise)
{
	using Entry = std::array<double, 2>;
	constexpr std::array<Entry, 4> TABLE = {
		Entry {0.05, 0.80}, Entry {0.11, 0.65}, Entry {0.19, 0.55}, Entry {0.30, 0.60}};
	if (noise <= TABLE.front()[0])
		return TABLE.front()[1];
	for (std::size_t k = 1; k < TABLE.size(); ++k) {
		if (noise < TABLE[k][0]) {
			const double share = (noise - TABLE[k - 1][0]) / (TABLE[k][0] - TABLE[k - 1][0]);
			return TABLE[k - 1][1] + share * (TABLE[k][1] - TABLE[k - 1][1]);
		}
	}
	return TABLE.back()[1];
}

double cos_threshold_increment_for(double noise)
{
	return LEAST_INCREMENT + way_between(LEAST_INCREMENT_NOISE, LARGEST_INCREMENT_NOISE, noise) *
								 (LARGEST_INCREMENT - LEAST_INCREMENT);
}

// How far noise is from where structures grow with it to where they are widest.
double strong_share(double noise)
{
	return way_between(STRONG_FROM, STRONG_FULL, noise);
}

// Taubin pairs of the prefilter for white noise, here in the edge lengths around a vertex.
double white_pairs_for(double noise, double most)
{
	return std::min(
		most,
		way_between(PREFILTER_FROM, PREFILTER_FULL, noise) *
			(PREFILTER_BASE_PAIRS + PREFILTER_PAIRS_PER_NOISE * noise));
}

// The same for noise correlated over several edges.
double scanner_pairs_for(double noise)
{
	return LEAST_SCANNER_PAIRS +
		   way_between(LEAST_SCANNER_PAIRS_NOISE, MOST_SCANNER_PAIRS_NOISE, noise) *
			   (MOST_SCANNER_PAIRS - LEAST_SCANNER_PAIRS);
}

// How much of its way the first of two iterations goes.
double guiding_for(double noise)
{
	return way_between(GUIDING_FROM, GUIDING_FULL, noise);
}

int rings_between(int from, int to, double share)
{
	return static_cast<int>(std::lround(between(from, to, share)));
}

Rings rings_between(const Rings& from, const Rings& to, double share)
{
	return {
		rings_between(from.smallest, to.smallest, share),
		rings_between(from.largest, to.largest, share)};
}

// Wider the more there is to average.
Rings rings_for(double noise)
{
	if (noise < 0.08)
		return {2, 3};
	if (noise < 0.25)
		return {2, 4};
	if (noise < 0.35)
		return {3, 4};
	return rings_between(ORDINARY_RINGS, STRONG_RINGS, strong_share(noise));
}

// Of ratios of variances, hence by their logarithms.
double between_ratios(double from, double to, double share)
{
	return from * std::pow(to / from, share);
}

} // namespace

double AdaptivePlan::cos_threshold_of(int iteration) const
{
	const double guided = iteration * guiding;
	return std::min(HIGHEST_THRESHOLD, cos_threshold + guided * cos_threshold_increment);
}

double AdaptivePlan::prefilter_pairs(double local_noise) const
{
	const double most =
		between(MOST_PREFILTER_PAIRS, MOST_STRONG_PREFILTER_PAIRS, strong_share(noise));
	return between(white_pairs_for(local_noise, most), scanner_pairs, correlation);
}

double strength_factor(Strength strength)
{
	switch (strength) {
	case Strength::Gentle: return 0.5;
	case Strength::Strong: return 2;
	case Strength::Normal: break;
	}
	return 1;
}

AdaptivePlan plan_for(const DenoiseOptions& options, double noise, const Correlation& kind)
{
	AdaptivePlan plan;
	const double correlation = kind.share;
	plan.noise = noise;
	plan.correlation = correlation;
	const double strength = strength_factor(options.strength);
	plan.scanner_pairs = strength * scanner_pairs_for(noise / strength);
	plan.vertex_iterations = plan.is_mostly_white() ? VERTEX_ITERATIONS : SCANNER_VERTEX_ITERATIONS;
	plan.cos_threshold = between(cos_threshold_for(noise), SCANNER_THRESHOLD, correlation);
	plan.cos_threshold_increment =
		between(cos_threshold_increment_for(noise), SCANNER_THRESHOLD_INCREMENT, correlation);
	plan.selection = between_ratios(
		SELECTION, between_ratios(NEAR_SELECTION, FAR_SELECTION, kind.reach), correlation);
	plan.rings = rings_between(
		rings_for(noise), rings_between(NEAR_RINGS, FAR_RINGS, kind.reach), correlation);
	plan.height_rings.largest = HEIGHT_RINGS;
	if (options.structure_ring) {
		const double share = std::min(1.0, double(*options.structure_ring) / plan.rings.largest);
		plan.height_rings.largest = rings_between(0, HEIGHT_RINGS, share);
		plan.rings.largest = *options.structure_ring;
		plan.rings.smallest = std::min(plan.rings.smallest, plan.rings.largest);
	}
	const bool wide = noise >= WIDE_STRUCTURES_NOISE;
	if (!plan.is_mostly_white())
		plan.faces_per_structure = FACES_PER_SCANNER_STRUCTURE;
	else if (wide)
		plan.faces_per_structure = static_cast<int>(std::lround(
			between(FACES_PER_WIDE_STRUCTURE, FACES_PER_WIDEST_STRUCTURE, strong_share(noise))));
	plan.faces_per_height_structure = FACES_PER_HEIGHT_STRUCTURE;
	if (wide) {
		plan.height_rings.smallest = std::min(2, plan.height_rings.largest);
		plan.faces_per_height_structure = FACES_PER_WIDE_HEIGHT_STRUCTURE;
	}
	plan.guiding = between(guiding_for(noise), 1.0, correlation);
	plan.iterations = plan.guiding > 0 ? ITERATIONS : 1;
	// Another number than by itself: all of it, then.
	if (options.iterations && *options.iterations != plan.iterations) {
		plan.iterations = *options.iterations;
		plan.guiding = 1;
	}
	plan.vertex_iterations = options.vertex_iterations.value_or(plan.vertex_iterations);
	plan.guiding_vertex_iterations = static_cast<int>(
		std::ceil(between(GUIDING_SHARE, 1.0, correlation) * plan.vertex_iterations));
	plan.cos_threshold = options.cos_threshold.value_or(plan.cos_threshold);
	plan.cos_threshold_increment =
		options.cos_threshold_increment.value_or(plan.cos_threshold_increment);
	return plan;
}

void record(const AdaptivePlan& plan, DenoiseOptions& resolved)
{
	resolved.iterations = plan.iterations;
	resolved.vertex_iterations = plan.vertex_iterations;
	resolved.structure_ring = plan.rings.largest;
	resolved.cos_threshold = plan.cos_threshold;
	resolved.cos_threshold_increment = plan.cos_threshold_increment;
}

} // namespace orthopoly
