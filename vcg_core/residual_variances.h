// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <array>
#include <vector>

namespace orthopoly {

/// What height polynomials around a vertex leave: a variance, negative where there is none, and its
/// degrees of freedom.
struct ResidualVariance {
	double value = -1;
	double free = 0;
};

/// A share of the residual variances and the same quantile of the normal distribution.
struct Quantile {
	double share;
	double normal;
};

/// The share of the variances over whole rings that is taken as free of features, which only ever
/// add to them: low for coarse meshes with few flat places, but not so low that it is ruled by the
/// tail of noise that is not Gaussian.
constexpr Quantile FLAT = {0.2, -0.8416};

/// The same over similar faces alone, which edges add little to.
constexpr Quantile SIMILAR_FLAT = {0.35, -0.3853};

/// The deviation that so many variances tell, each normalised by its degrees of freedom (Wilson and
/// Hilferty 1931); zero where there is none.
double level_of(const std::vector<ResidualVariance>& variances, const Quantile& wanted);

/// The level of whole rings, or that of similar faces where it shows edges in the first; in edge
/// lengths.
double level_beside_edges(double whole, double similar, double length);

/// Of whole rings around vertices: narrow ones, and two wider by one and by two.
using VariancesByRings = std::array<std::vector<ResidualVariance>, 3>;

/// The share of the noise in what the narrow rings leave, the rest being detail.
///
/// Noise leaves the same over any number of rings, detail as small as the triangles leaves more the
/// wider they are.
double share_of_noise(const VariancesByRings& variances);

/// How far a surface was drawn with its faces in planes, rather than measured with noise of that
/// level, 0 to 1: noise leaves hardly a pair of faces in one plane.
///
/// @param vertices the sample to look at the faces around of
/// @param level    the caller's length unit
double share_drawn(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Index>& vertices,
	double level);

} // namespace orthopoly
