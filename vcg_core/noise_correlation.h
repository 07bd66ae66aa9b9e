// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "correlated_moves.h"
#include "voxel_grid.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// What tells noise correlated over several edges (of a depth camera or a volume, or white noise
/// that was smoothed, remeshed or decimated) from white noise.
///
/// Fine detail all over a surface looks much the same as correlated noise to a statistic of
/// heights, and what takes the one away ruins the other. So several things have to come together.
/// One of them is that the mesh itself shows where it comes from, or else that in its flattest
/// places the residuals of polynomials rise with the rings at first and then hardly any more: they
/// do where noise goes together over an edge or two. Those of a surface go on rising (a cubic
/// leaves the fourth power of the rings where it is smooth, the first where it is rough), and those
/// of white noise do not begin.
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
	/// The power of the rings that the residual deviation rises by, from the narrowest polynomials
	/// to the narrow ones and from these to the wide ones, in the flattest tenth of the places. 0
	/// where not measured.
	double first_rise = 0;
	double further_rise = 0;
	/// Residual deviation of narrow polynomials in the flattest fifth of the places over that in
	/// the flattest tenth. 0 where not measured.
	double narrow_spread = 0;
	/// What polynomials over three rings see, which is less of the shape than any wider ones do. 0
	/// where not measured.
	struct Near {
		/// Residual deviation in the flattest tenth of the places, in mean edge lengths.
		double level = 0;
		/// The one in the flattest fifth over that, and the one at an ordinary place.
		double spread = 0;
		double unevenness = 0;
		/// As that of all, over the flattest places.
		double edge_correlation = 0;
		/// The power of the rings that the residual deviation rises by from two rings, and the one
		/// it goes on by to four.
		double rise = 0;
		double next_rise = 0;

		/// How much more it rises then than noise does, where it rises by as much before.
		double bend() const;
	};
	Near near = {};
	/// Residual deviation of wide polynomials at an ordinary place over that in the flattest ones:
	/// 1 where the noise is all there is. 0 where not measured.
	double unevenness = 0;
	/// Residual deviations of wide and of narrow polynomials in the flattest places, in mean edge
	/// lengths. 0 where not measured.
	double level = 0;
	double narrow_level = 0;
	/// Of polynomials between these in the flattest tenth. 0 where not measured.
	double middle_level = 0;

	/// From 0 (white, or not to be told) to 1 (correlated), with a ramp between, where the mesh
	/// shows where it comes from.
	double certainty() const;
	/// The same by the rise of the residuals, wherever the mesh comes from, and how far the noise
	/// is to be taken for correlated then: less where residuals are the shape's, too. Not to be
	/// asked where white noise differs from place to place or is made of outliers: residuals rise
	/// there as well, from places that have little of it into those around.
	struct ByRise {
		double certainty = 0;
		double share = 0;
	};
	ByRise by_rise() const;
	/// The same by what a run for such noise took from the mesh, which tells it from detail better
	/// than any residuals do; and from 0 to 1 how far the residuals make it worth trying one.
	double by_trial(const CorrelatedMoves& taken) const;
	double worth_trying() const;
	/// From 0 to 1: how surely the mesh was extracted from a volume, whatever its noise.
	double is_of_voxels() const;
	/// Of the noise along the normals, in mean edge lengths, where it is correlated: more than any
	/// of the polynomials leaves, which follow a part of it. 0 where not measured.
	double deviation() const;
	/// How far the noise goes together, from 0 (over an edge or two) to 1 (over many).
	double reach() const;

private:
	double looks_smoothed() const;
	double looks_hardly_smoothed() const;
};

/// Measures the noise of the positions. Where the mesh comes neither from a depth camera nor from a
/// volume and residuals do not rise from the narrowest polynomials on, the rest is left out, unless
/// it is wanted in any case. O(#V) time.
/// @param smooth #V, what `surface_below_heights` makes of the positions
NoiseCorrelation measure_noise_correlation(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth,
	bool in_any_case = false);

} // namespace orthopoly
