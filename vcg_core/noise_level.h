// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "uneven_noise.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Below this an estimate cannot be told from what clean meshes read (up to 0.023), and the angles
/// left are below three degrees.
constexpr double LEAST_NOISE = 0.025;

/// Standard deviation of the noise along the surface normal, in mean edge lengths.
///
/// Around each of a sample of vertices a cubic height polynomial is fitted to the 2-ring; what it
/// leaves is noise where the surface is smooth. A low quantile of the residual variances, each
/// normalised by its degrees of freedom, keeps edges out. Triangles lower than the noise tell too
/// little and are left out, as far as there are others; where nearly all are, long and thin ones,
/// heights over a surface that is smoothed more are asked as well. Where edges are too close to
/// each other for that, so that polynomials over the similar faces alone leave less, the level is
/// what these leave. Where polynomials over more rings leave more, the growth tells how much of it
/// is detail as small as the triangles, which is no noise. Zero where no vertex has neighbours
/// enough, and where more pairs of faces lie in a plane than noise would leave. Where the noise
/// differs from place to place, the root mean square (UnevenNoise). O(#V) time.
double estimate_noise_level(const Workspace& workspace, const std::vector<Point>& positions);

/// The same in several ways, and what kind of noise it is.
struct NoiseLevels {
	/// In the flatter places. Misses outliers that are rare.
	double flat = 0;
	/// Share of the level that is not there, 0 to 1: of surfaces that were drawn with their faces
	/// in planes, or where but some vertices are outliers.
	double drawn = 0;
	/// The same with what is taken for detail: noise that goes together over several edges grows
	/// like it.
	double rough = 0;
	/// In ordinary places: with rare outliers, and on coarse meshes some of the surface itself.
	double ordinary = 0;
	/// Of coordinates that were rounded to a lattice (see lattice_step); zero where they were not,
	/// and where what that would leave is not seen, as on what was drawn on a lattice.
	double rounding = 0;
	/// Median ratio of the residuals of wide polynomials (see LocalHeights): 1 where the noise is
	/// Gaussian, 0.8 where its directions are random, two thirds where it is impulsive.
	double median_ratio = 1;
	/// Where the noise differs from place to place.
	UnevenNoise uneven = {};
};
NoiseLevels estimate_noise_levels(const Workspace& workspace, const std::vector<Point>& positions);
/// @param smooth #V, what `surface_below_heights` makes of the positions
NoiseLevels estimate_noise_levels(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth);

} // namespace orthopoly
