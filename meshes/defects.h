// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

namespace orthopoly {

// Small meshes with one thing wrong with each, on an otherwise sound body.

/// A box with a fin on one of its edges: three faces share each edge along the foot of the fin.
TriangleMesh make_non_manifold_edge();
/// Two boxes that touch in one vertex.
TriangleMesh make_non_manifold_vertex();
/// A box in which two faces have no area: one with its corners in a line, one with a vertex twice.
TriangleMesh make_degenerate_face();
/// A box in which one corner is two vertices at the same place, each with a part of the faces.
TriangleMesh make_duplicate_vertex();
/// A box in two charts: the vertices where its upper half begins are there twice, one for each.
TriangleMesh make_seam();
/// A box in which every face has three vertices of its own.
TriangleMesh make_loose_triangles();
/// A box with one face twice, and once more the other way round.
TriangleMesh make_duplicate_face();
/// A box and a vertex that no face uses, some way off.
TriangleMesh make_unreferenced_vertex();
/// A box and one triangle that shares nothing with it.
TriangleMesh make_isolated_face();
/// A box with every fifth face turned over.
TriangleMesh make_mixed_orientation();
/// Two boxes apart from each other.
TriangleMesh make_two_components();
/// No vertex, no face.
TriangleMesh make_empty();
/// The vertices of a box without its faces.
TriangleMesh make_points_only();
/// A box with a coordinate that is not a number, at vertex 7.
TriangleMesh make_nan_coordinate();

} // namespace orthopoly
