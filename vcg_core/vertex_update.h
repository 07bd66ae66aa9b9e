// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Options of `update_vertices`.
struct VertexUpdateOptions {
	/// Number of steps of eq. 12; centroids are computed anew in each.
	int iterations = 10;
};

/// Moves vertices towards the planes through the face centroids with the given normals (eq. 12).
///
/// @param normals   #F target unit normals; a face whose vector is zero is left out of the mean
/// @param positions #V, moved in place; fixed vertices stay bit for bit
void update_vertices(
	const Workspace&           workspace,
	const std::vector<Point>&  normals,
	const VertexUpdateOptions& options,
	std::vector<Point>&        positions);

} // namespace orthopoly
