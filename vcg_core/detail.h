// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "deviations.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// What denoising took from the vertices, along their normals.
struct TakenMoves {
	/// Median over the vertices (those with at least half of the overall noise) of the mean square
	/// around each, in noise variances.
	double square = 0;
	/// And of the share of the variance that neighbours predict (see MovePredictor): detail, but
	/// for a little that is chance.
	double predicted = 0;
};

/// Gives back the detail that denoising took along with the noise, in three steps.
///
/// Noise moves each vertex by itself. What the moves of vertices along their normals have in common
/// with those around them is detail, however small, and so are averages of them, as far as they go
/// together with the moves themselves: vertices go back along these averages (smoothing what was
/// taken and adding it, Tukey 1977, "twicing") by the gain that leaves the least mean square within
/// a few rings. Edges take no part, along which vertices slide.
///
/// Where most of a mesh has ridges or grooves as narrow as its triangles, vertices go back as far
/// as their neighbours predict it.
///
/// Where moves then are still further than the noise accounts for, the surface has detail as small
/// as its triangles. Vertices go that share of the way back to where they were measured (the
/// workspace's mesh) which is not noise: one less the noise variance, with a margin, over the mean
/// square of the moves, as a Wiener filter has it.
///
/// @param sigma     the noise; > 0
/// @param most      share of the way at most, 0 to 1
/// @param positions #V denoised, moved in place; fixed vertices stay bit for bit
///
/// Returns what was taken, ridges and grooves included. O(#V); the same bits on any number of
/// threads. Throws Cancelled.
TakenMoves give_back_detail(
	const Workspace& workspace,
	const Deviations& sigma,
	double most,
	std::vector<Point>& positions);

/// The same where outliers made the noise, so that the other vertices were never off: those that
/// have been moved no further than is ordinary around them go all the way back, but for the noise
/// that is left without the outliers.
///
/// Parameters, cost and errors as those of `give_back_detail`; sigma is the noise that is left, its
/// standard deviation along the normal in the caller's length unit.
void give_back_inliers(
	const Workspace& workspace, double sigma, double most, std::vector<Point>& positions);

} // namespace orthopoly
