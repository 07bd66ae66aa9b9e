// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Where the triangles of a mesh are long and thin, as those of scan lines and of lofted surfaces
/// are. Their normals scatter by the short edges, and a ring of faces around a vertex reaches far
/// in one direction and hardly anywhere in the other.
struct Anisotropy {
	/// #V, how far that is so around a vertex: from 0, about twice as long as wide or less, to 1.
	/// Empty: nowhere.
	std::vector<double> shares;
	/// #V positions to read lengths from, smoothed there, since noise hides short edges.
	std::vector<Point> smoothed;
	/// #V lists of the vertices that are one place with a vertex, itself left out: with them a ring
	/// of faces reaches about as far in every direction. No lists where `shares` is empty.
	IndexLists nearby;
	/// How many times the faces around a vertex those around its place are, on average: 1 or more.
	double crowding = 1;
};

/// Looks for long thin triangles, in a mesh that may be noisy. The same on any number of threads
/// and for any numbering. O(#V).
Anisotropy find_anisotropy(const Workspace& workspace, const std::vector<Point>& positions);

/// Mean square edge of the equilateral triangles whose normals noise of the vertices would tilt as
/// much as those around a vertex, the caller's length unit squared: independent noise tilts a
/// triangle by its variance times the sum of the squared edges over four times the squared area.
/// Zero for a vertex without a face that has an area.
double steady_edge_square_around(
	const Workspace& workspace, const std::vector<Point>& positions, Index vertex);

} // namespace orthopoly
