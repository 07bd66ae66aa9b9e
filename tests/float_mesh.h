// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vcg/complex/complex.h>
#include <vector>

namespace orthopoly {

/// The least VCG mesh that the adapter has to cope with: a vertex with coordinates and flags, a
/// face with corners and flags.
class FloatVertex;
class FloatFace;
struct FloatTypes :
		vcg::UsedTypes<vcg::Use<FloatVertex>::AsVertexType, vcg::Use<FloatFace>::AsFaceType> {};
class FloatVertex : public vcg::Vertex<FloatTypes, vcg::vertex::Coord3f, vcg::vertex::BitFlags> {};
class FloatFace : public vcg::Face<FloatTypes, vcg::face::VertexRef, vcg::face::BitFlags> {};
using FloatMesh = vcg::tri::TriMesh<std::vector<FloatVertex>, std::vector<FloatFace>>;

} // namespace orthopoly
