// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "adjacency.h"
#include "execution.h"
#include "triangle_mesh.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// What all steps of one computation share: the mesh as given, its connectivity (which no step
/// changes), and the threads to run on.
struct Workspace {
	/// Builds the connectivity. Mesh and execution must outlive the workspace. Throws Cancelled.
	Workspace(const TriangleMesh& mesh, Execution& execution);

	const TriangleMesh& mesh;
	Execution& execution;
	/// Faces around every vertex, #V lists.
	IndexLists vertex_faces;
	/// Flags of boundary and irregular vertices, #V each, and the number of non-manifold edges.
	EdgeDefects edges;
	/// Mean edge length of the mesh as given.
	double mean_edge_length;

	/// A collector of rings of this mesh.
	RingCollector ring_collector() const { return {mesh.faces, vertex_faces}; }
	/// One for each worker of the execution.
	std::vector<RingCollector> ring_collectors() const
	{
		return {static_cast<std::size_t>(execution.threads()), ring_collector()};
	}
};

/// Sum of the cross products of the faces around a vertex: along its normal, weighted by area.
Point cross_product_around(
	const Workspace& workspace, const std::vector<Point>& positions, Index vertex);

/// The same around every vertex, #V.
std::vector<Point>
cross_products_around(const Workspace& workspace, const std::vector<Point>& positions);

/// #V unit normals, weighted by area; zero where there is none.
std::vector<Point> vertex_normals(const Workspace& workspace, const std::vector<Point>& positions);

/// Sum of the ways from a vertex to the corners of the faces around it: a neighbour counts once for
/// each face shared.
inline Point
sum_of_ways_around(const Workspace& workspace, const std::vector<Point>& positions, Index vertex)
{
	const Point& here = positions[at(vertex)];
	Point sum = Point::Zero();
	const Index* const end = workspace.vertex_faces.end(vertex);
	for (const Index* face = workspace.vertex_faces.begin(vertex); face != end; ++face) {
		for (const Index corner : workspace.mesh.faces[at(*face)])
			sum += positions[at(corner)] - here;
	}
	return sum;
}

/// Sum of the cross products of the faces beside a face, from its own and those `sums` around all
/// vertices. Neighbours across an edge count twice.
inline Point
cross_product_beside(const Face& face, const Point& own, const std::vector<Point>& sums)
{
	return -3 * own + sums[at(face[0])] + sums[at(face[1])] + sums[at(face[2])];
}

/// Mean square of the lengths of the edges of the faces around a vertex; zero for one without a
/// face.
double mean_edge_square_around(
	const Workspace& workspace, const std::vector<Point>& positions, Index vertex);

/// As the functions of the same names for any mesh, on all threads.
FaceGeometry face_geometry(const Workspace& workspace, const std::vector<Point>& positions);
double mean_edge_length(const Workspace& workspace, const std::vector<Point>& positions);

/// #F flags of the faces that are folded over: their normal is more than 90 degrees away from the
/// area-weighted mean normal of the faces around them (those that share a vertex, themselves left
/// out).
std::vector<std::uint8_t>
folded_faces(const std::vector<Point>& positions, const Workspace& workspace);
Index count_folded_faces(const std::vector<Point>& positions, const Workspace& workspace);

} // namespace orthopoly
