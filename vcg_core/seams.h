// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "adjacency.h"
#include "triangle_mesh.h"

#include <vector>

namespace orthopoly {

/// Vertices that are one and the same on the surface.
///
/// Formats with one texture coordinate, normal or colour a vertex have a vertex twice where it has
/// two of these, and some have three of its own for every triangle. Open edges then coincide, and
/// what moves their ends apart tears the surface.
struct Seams {
	/// #V: the vertex of the sewn mesh that this one becomes, which has those that are the same
	/// once, in the order of their first. Empty where there is no seam.
	std::vector<Index> vertices;
	/// Vertices that are the same as one before them.
	Index repeated = 0;

	Index sewn(Index vertex) const { return vertices.empty() ? vertex : vertices[at(vertex)]; }
};

/// Finds edges that belong to one face only and have both ends at exactly the same places as
/// another such edge: these ends are the same. Vertices at one place that no such edges join stay
/// apart, and so do the two sides of a sheet: edges whose faces lie on each other.
///
/// @param around the faces around every vertex
/// @param edges of the mesh, whose positions have to be finite. O(#F), and a logarithm of the open
/// edges.
Seams find_seams(const TriangleMesh& mesh, const IndexLists& around, const EdgeDefects& edges);

/// The same from the mesh alone.
Seams find_seams(const TriangleMesh& mesh);

/// The mesh with its seams closed: faces in their order. A vertex is fixed where any of those that
/// it stands for is.
TriangleMesh sew(const TriangleMesh& mesh, const Seams& seams);

} // namespace orthopoly
