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
	/// Builds the connectivity. Mesh and execution must outlive the workspace.
	Workspace(const TriangleMesh& mesh, Execution& execution);

	const TriangleMesh& mesh;
	Execution& execution;
	/// Faces around every vertex, #V lists.
	IndexLists vertex_faces;
	/// Faces that share a vertex with a face, #F lists.
	IndexLists face_neighbors;
	/// Vertices on edges that do not belong to exactly two faces, #V flags.
	std::vector<std::uint8_t> boundary;
	/// Mean edge length of the mesh as given.
	double mean_edge_length;
};

/// Faces that are folded over: their normal is more than 90 degrees away from the area-weighted
/// mean normal of the faces around them (those that share a vertex, themselves left out).
Index count_folded_faces(const std::vector<Point>& positions, const Workspace& workspace);

} // namespace orthopoly
