// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// Some places of a mesh with what is around them, to try out on what would take long on all of it.
struct MeshPart {
	TriangleMesh mesh;
	/// Of its vertices in the mesh that it was cut from.
	std::vector<Index> indices;
	/// Flags of the vertices that are far from where it was cut off.
	std::vector<std::uint8_t> inner;

	/// Of values at the vertices of that mesh those at its own; nothing of nothing.
	std::vector<double> values_of(const std::vector<double>& values) const;
};

/// About eight places of some thousand faces, the same ones however the mesh is numbered.
MeshPart cut_out_places(const Workspace& workspace);

} // namespace orthopoly
