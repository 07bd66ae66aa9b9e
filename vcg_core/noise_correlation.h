// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "voxel_grid.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// What tells the noise of a depth camera or of a volume, correlated over several edges, from white
/// noise.
///
/// Fine detail all over a surface looks the same as correlated noise to any statistic of heights,
/// and what takes the one away ruins the other. So several things have to come together, and one of
/// them is that the mesh itself shows where it comes from.
struct NoiseCorrelation {
	/// Root mean square deviation of the triangles' areas, as seen from the direction from which
	/// they are most alike, over their mean: 0 for a regular grid seen from one side, 1 for a
	/// closed surface. Noise along the view, however strong, changes nothing here.
	double view_irregularity = 1;
	/// How much of the mesh lies on a grid of cubes.
	VoxelShares voxels = {};
	/// Of the residuals of neighbours to height polynomials, less what white noise gives; over the
	/// flattest places, where detail contributes least. 0 where not measured.
	double edge_correlation = 0;
	/// Residual deviation of wide polynomials over that of narrow ones in the flattest places.
	/// Detail makes it large; white noise 1. 0 where not measured.
	double growth = 0;
	/// The same of polynomials between these over narrow ones, which see less of the surface.
	double middle_growth = 0;
	/// Residual deviation of wide polynomials at an ordinary place over that in the flattest ones:
	/// 1 where the noise is all there is. 0 where not measured.
	double unevenness = 0;
	/// Residual deviations of wide and of narrow polynomials in the flattest places, in mean edge
	/// lengths. 0 where not measured.
	double level = 0;
	double narrow_level = 0;

	/// From 0 (white, or not to be told) to 1 (correlated), with a ramp between.
	double certainty() const;
	/// From 0 to 1: how surely the mesh was extracted from a volume, whatever its noise.
	double is_of_voxels() const;
	/// How far the noise goes together, from 0 (over an edge or two) to 1 (over many).
	double reach() const;
};

/// Measures the noise of a mesh. Where it comes neither from a depth camera nor from a volume, the
/// rest is left out, unless it is wanted in any case. O(#V) time.
NoiseCorrelation measure_noise_correlation(
	const Workspace& workspace, const std::vector<Point>& positions, bool in_any_case = false);

} // namespace orthopoly
