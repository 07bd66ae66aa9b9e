// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "denoise.h"
#include "mesh_noise.h"

namespace orthopoly {

/// Rings a structure may reach.
struct Rings {
	int smallest;
	int largest;
};

/// What a run of the adaptive method goes by: all that depends on the noise or can be set.
struct AdaptivePlan {
	/// How far the noise is taken as correlated, 0 to 1.
	double correlation = 0;
	/// In mean edge lengths, strength included.
	double noise = 0;
	/// What may have folded faces, in times of that level: 1 or more.
	double fold_factor = 1;
	/// Taubin pairs of the prefilter where noise is correlated.
	double scanner_pairs = 0;
	int iterations = 1;
	/// How much of their way the iterations before the last go, 0 to 1.
	double guiding = 1;
	/// Of the last iteration, and of those before.
	int vertex_iterations = 1;
	int guiding_vertex_iterations = 1;
	double cos_threshold = 0;
	double cos_threshold_increment = 0;
	/// Energy over noise variance from which a coefficient of the normals is kept.
	double selection = 1;
	Rings rings = {2, 4};
	Rings height_rings = {1, 5};
	/// One in so many faces has a structure of its own, of normals and of heights.
	int faces_per_structure = 1;
	int faces_per_height_structure = 1;

	bool is_mostly_white() const { return correlation < 0.5; }
	/// Threshold of similar directions in an iteration, counted from 0.
	double cos_threshold_of(int iteration) const;
	/// Taubin pairs of the prefilter where the noise is so many of the edge lengths around.
	double prefilter_pairs(double local_noise) const;
};

/// What the strength multiplies the noise by.
double strength_factor(Strength strength);

/// The plan for a noise in mean edge lengths, strength included. What is set in the options is
/// taken from there.
AdaptivePlan plan_for(const DenoiseOptions& options, double noise, const Correlation& kind);

/// Writes down what the plan resolved.
void record(const AdaptivePlan& plan, DenoiseOptions& resolved);

} // namespace orthopoly
