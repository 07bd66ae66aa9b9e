// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "residual_variances.h"
#include "workspace.h"

#include <cstddef>
#include <vector>

namespace orthopoly {

/// What is read off a sample of vertices to tell the noise by.
struct NoiseSample {
	/// The vertices; the variances are one a vertex.
	std::vector<Index> vertices;
	/// Over whole rings: the narrow ones at each vertex, the wider ones at some.
	VariancesByRings whole;
	/// Over the similar faces, at some.
	std::vector<ResidualVariance> similar;
	/// Median ratio of the residuals of wide polynomials (see LocalHeights).
	double median_ratio = 1;
	/// Mean edge length of the surface below the noise.
	double edge_length = 0;
};

/// Noise that differs from place to place: with the angle that a scanner saw the surface at, the
/// distance, or the scans that a mesh is put together from.
struct UnevenNoise {
	/// How certain it is that the noise is uneven, 0 to 1.
	double certainty = 0;
	/// Root mean square over the vertices that may move, in mean edge lengths.
	double level = 0;
	/// #V levels over that one, as far as it is certain that they differ (1 where it is not at
	/// all); empty where the noise is even.
	std::vector<double> factors = {};
};

/// Looks for noise that differs from place to place.
///
/// Around each of some vertices of the sample, spread over it, the level is read off the nearest
/// ones of the same component as `estimate_noise_level` reads it off all. Features raise it too, so
/// that it counts only where levels differ by more than these make them, and where the higher ones
/// are noise: residuals of rings of all widths alike, and no faces in planes. Noise along one axis
/// (AxisNoise) is looked for as well; of both kinds the one whose levels are nearer to the
/// residuals is taken.
///
/// @param smooth #V, the surface below the noise
/// O(#V), for a few hundred places. The same bits on any number of threads. Throws Cancelled.
UnevenNoise find_uneven_noise(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth,
	const NoiseSample& sample);

} // namespace orthopoly
