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
	/// Chebyshev acceleration of the steps: they reach as far along the surface as two to five
	/// times as many plain ones. Off in the paper's method.
	bool accelerated = false;
	/// Where vertices rest (#V), or null: each step also goes a small part of the way there, in the
	/// directions the normals around the vertex leave free and as far as its faces are still turned
	/// away from their targets. Where normals do not agree eq. 12 would let vertices slide. Null in
	/// the paper's method.
	const std::vector<Point>* rest = nullptr;
	/// Share of each step that a vertex takes (#V, above 0 to 1), or null for all of it. The steps
	/// bring short waves of the surface in line with the normals first and long ones last, so a
	/// vertex that goes slowly keeps long waves as they were. Null in the paper's method.
	const std::vector<double>* paces = nullptr;
};

/// Moves vertices towards the planes through the face centroids with the given normals (eq. 12).
///
/// Each step is one of steepest descent (scaled by the areas around each vertex) on the energy
/// sum_f A_f sum_(v in f) (n_f . (c_f - x_v))^2, whose spectrum is within [0, 1]. All vertices move
/// at once in each step, so the result does not depend on their order. O(#F) a
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
