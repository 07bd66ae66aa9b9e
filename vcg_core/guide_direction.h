// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Options of `guide_directions`.
struct GuideDirectionOptions {
	/// Rings r of the local structure S_i that votes, in face rings, 1 or more. More steadies the
	/// direction in strong noise and blurs small features.
	int ring = 1;
	/// sigma_theta of eq. 3, degrees, above 0 up to 90: how fast a vote falls with the angle
	/// between the normals. More lets faces across an edge vote too.
	double sigma_theta = 30.0;
};

/// The guide direction V_i of every face (section 2.1): the eigenvector of the largest eigenvalue
/// of the sum of the normal tensors of its r-ring (eqs. 1 to 4), turned to the side of the mean
/// normal with the same weights.
///
/// Faces without a normal do not vote. Eqs. 2 and 3 are printed upside down; used are the weights
/// of Huang et al. 2013, which the paper cites for them. About O(n log n) a face with n faces in
/// its ring.
///
/// @param geometry of all faces
/// @return #F unit vectors, zero for faces without a normal
/// Throws Cancelled.
std::vector<Point> guide_directions(
	const Workspace& workspace, const FaceGeometry& geometry, const GuideDirectionOptions& options);

} // namespace orthopoly
