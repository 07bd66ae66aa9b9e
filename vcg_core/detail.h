// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Gives back the detail that denoising took along with the noise.
///
/// Where vertices within a few rings have been moved along their normals further than the noise
/// accounts for, the surface has detail there that the denoised one has not. Vertices go that share
/// of the way back to where they were measured (the workspace's mesh) which is not noise: one less
/// the noise variance, with a margin, over the mean square of the moves, as a Wiener filter has it.
///
/// @param sigma     standard deviation of the noise along the normal, the caller's length unit
/// @param most      share of the way at most, 0 to 1
/// @param positions #V denoised, moved in place; fixed vertices stay bit for bit
///
/// O(#V); the same bits on any number of threads. Throws Cancelled.
void give_back_detail(
	const Workspace& workspace, double sigma, double most, std::vector<Point>& positions);

/// The same where outliers made the noise, so that the other vertices were never off: those that
/// have been moved no further than is ordinary around them go all the way back, but for the noise
/// that is left without the outliers.
///
/// Parameters, cost and errors as those of `give_back_detail`; sigma is the noise that is left.
void give_back_inliers(
	const Workspace& workspace, double sigma, double most, std::vector<Point>& positions);

} // namespace orthopoly
