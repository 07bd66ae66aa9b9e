// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Options of `update_vertices`.
struct VertexUpdateOptions {
	/// Number of steps of eq. 12, 0 or more; centroids are computed anew in each.
	int iterations = 10;
	/// Weight each face around a vertex by its area (at the start of each step) instead of equally
	/// as eq. 12 is printed. Off in the paper's method.
	bool area_weights = false;
	/// A vertex with a face whose normal is turned away from its target by more than this cosine
	/// also moves across the targets, halfway to the mean of the centroids around it: eq. 12 by
	/// itself never turns a folded face back. -1 never does so. Off in the paper's method.
	double unfold_cosine = -1;
};

/// Moves vertices towards the planes through the face centroids with the given normals (eq. 12).
///
/// All vertices move at once in each step, so the result does not depend on their order. O(#F) a
/// step.
///
/// @param normals   #F target unit normals; a face whose vector is zero is left out of the mean
/// @param positions #V, moved in place; fixed vertices, and those without a face that has a normal,
///                  stay bit for bit
/// Throws Cancelled; positions are then somewhere on the way.
void update_vertices(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const VertexUpdateOptions& options,
	std::vector<Point>& positions);

} // namespace orthopoly
