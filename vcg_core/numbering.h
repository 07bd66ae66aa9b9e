// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "execution.h"
#include "triangle_mesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace orthopoly {

/// Another numbering of a mesh: where its faces and vertices were before. A permutation each.
struct Numbering {
	std::vector<Index> faces;
	std::vector<Index> vertices;
};

/// Numbers faces along a Hilbert curve through their bounding box (Hilbert 1891; its index by
/// Skilling 2004), and vertices as the faces come upon them, those without a face last. What is
/// close in space is then close in memory, and consecutive faces make up compact patches.
///
/// Throws Cancelled.
Numbering number_by_place(const TriangleMesh& mesh, Execution& execution);

/// The numbering the mesh has.
Numbering same_numbering(const TriangleMesh& mesh);

/// The mesh under that numbering, moved so that `origin` is at zero: far from it, coordinates
/// have fewer digits to spare.
TriangleMesh renumbered(const TriangleMesh& mesh, const Numbering& numbering, const Point& origin);

/// Distance of a cell from the start of the Hilbert curve that passes through all of 2^bits cells
/// along each axis; at most 21 bits.
std::uint64_t hilbert_index(std::array<std::uint32_t, 3> cell, int bits);

} // namespace orthopoly
