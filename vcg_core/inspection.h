// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

namespace orthopoly {

/// What can be wrong with a mesh; none of it but coordinates that are not finite stops a method.
struct Inspection {
	/// Vertices with a coordinate that is not a finite number.
	Index not_finite_vertices = 0;
	Index unreferenced_vertices = 0;
	/// Vertices at the same place as one before them.
	Index duplicate_vertices = 0;
	/// Those of them that are the same as another on a seam (seams.h): methods move these together.
	Index seam_vertices = 0;
	/// Faces on the same three vertices as one before them, whatever their orientation.
	Index duplicate_faces = 0;
	/// Faces without area.
	Index degenerate_faces = 0;
	/// Vertices on an edge that belongs to one face only.
	Index boundary_vertices = 0;
	/// Edges with more than two faces or two faces of opposite orientation.
	Index non_manifold_edges = 0;
	/// Parts that share no vertex; unreferenced vertices do not count.
	Index components = 0;
};

/// Looks for all of that. The faces have to name vertices that are there, as every reader of files
/// makes sure.
Inspection inspect(const TriangleMesh& mesh);

} // namespace orthopoly
