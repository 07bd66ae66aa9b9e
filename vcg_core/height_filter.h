// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "deviations.h"
#include "lanes.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// What `normals_from_heights` reads; the arrays have to outlive it.
struct HeightField {
	/// #F unit guide directions V_i, already filtered. Zero: the face is left out.
	const std::vector<Point>& guides;
	/// #F centroids, where the normals are wanted.
	const std::vector<Point>& nodes;
	/// #V positions as measured, with all their noise.
	const std::vector<Point>& positions;
};

/// Options of `normals_from_heights`.
struct HeightFilterOptions {
	/// Faces are similar where the cosine of their guide directions is above this.
	double cos_threshold = 0.9;
	/// Where positive, a structure of the faces above a threshold lower by this is fitted too, and
	/// taken where its risk is clearly less.
	double loosening = 0;
	/// A structure reaches over this many rings of faces to that many; each face takes the number
	/// with the least risk, of a few that grow like powers. Those of more than 7 are tried where 7
	/// are the best of the others, and at fewer faces.
	int smallest_ring = 1;
	int largest_ring = 5;
	/// One in so many faces, spread evenly, gets a structure of its own; the others take what
	/// these vote. 1 or more.
	int faces_per_structure = 1;
	/// #V lists of the vertices that are one place with a vertex (see `Anisotropy`), or nothing.
	const IndexLists* nearby = nullptr;
	/// Work on four doubles at once, which only a processor with wide lanes can. The same bits.
	bool wide_lanes = has_wide_lanes();
	/// The noise of the positions.
	Deviations sigma = 0;
	/// A coefficient beyond the plane is kept where its energy exceeds this many noise variances.
	double selection = 9;
};

/// What `normals_from_heights` finds: one entry a face (#F each).
struct HeightNormals {
	/// Unit normals.
	std::vector<Point> normals;
	/// How far the votes for a face differ: one less the length of their weighted mean, about half
	/// the variance of their directions in radians squared. 1 for a face without votes.
	std::vector<double> spreads;
};

/// Estimates face normals from the measured vertices themselves: discrete orthogonal polynomials of
/// degree three for the height above the guide's tangent plane, over the vertices of the similar
/// faces.
///
/// The noise of the heights is white and its variance is known, which that of face normals (which
/// share vertices) is not, so a plane through many vertices is steadier than the mean of many
/// normals. But it knows edges only through the guides. Structure size, selection and votes as in
/// `filter_normals`.
///
/// @returns a face without votes keeps its guide. The same bits on any number of threads.
/// O(#F R^2). Throws Cancelled.
HeightNormals normals_from_heights(
	const Workspace& workspace, const HeightField& field, const HeightFilterOptions& options);

} // namespace orthopoly
