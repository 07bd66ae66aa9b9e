// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lanes.h"
#include "workspace.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// What `filter_normals` reads: one entry a face (#F each).
struct NormalField {
	/// Unit guide directions V_i, which decide who is similar to whom. Zero: the face is left out.
	std::vector<Point> guides;
	/// Unit normals d_j to fit.
	std::vector<Point> data;
	/// Weights of the data, not negative. Zero: the face is no observation.
	std::vector<double> weights;
	/// Face centroids: the nodes.
	std::vector<Point> nodes;
	/// Variances of the data by noise alone, up to a common factor; positive. Empty: all the same.
	std::vector<double> scatters = {};
	/// Flags of the faces whose data have noise to tell its variance by. Empty: all have.
	std::vector<std::uint8_t> noisy = {};
};

/// Options of `filter_normals`.
struct NormalFilterOptions {
	/// Faces are similar where the cosine of their guide directions is above this.
	double cos_threshold = 0.6;
	/// Where positive, a structure of the faces above a threshold lower by this is fitted too, and
	/// taken where its risk is less.
	double loosening = 0;
	/// A structure reaches over this many rings of faces to that many (1 to MAX_RINGS); each face
	/// takes the number with the least risk.
	int smallest_ring = 2;
	int largest_ring = 4;
	/// A coefficient is kept where its energy exceeds this many times the noise variance.
	double selection = 9;
	/// One in so many faces, spread evenly, gets a structure of its own; the others take
	/// what these vote. 1 or more.
	int faces_per_structure = 1;
	/// #V lists of the vertices that are one place with a vertex (see `Anisotropy`), or nothing.
	const IndexLists* nearby = nullptr;
	/// Work on four doubles at once, which only a processor with wide lanes can. The same bits.
	bool wide_lanes = has_wide_lanes();

	static constexpr int MAX_RINGS = 15;
};

/// Filters face normals by discrete orthogonal polynomials of degree two over the similar faces
/// around each face, with their centroids in the guide's tangent plane as scattered nodes.
///
/// Each coefficient is kept or dropped by itself, by its energy against the noise; size and
/// threshold of a structure are those whose variance and unexplained residual together, its risk,
/// are least. A structure votes for all its members; a face's result is the mean of its votes,
/// weighted by their certainty.
///
/// @returns #F unit normals; a face without votes keeps its data. The same bits on any number of
/// threads. O(#F R^2). Throws Cancelled.
std::vector<Point> filter_normals(
	const Workspace& workspace, const NormalField& field, const NormalFilterOptions& options);

} // namespace orthopoly
