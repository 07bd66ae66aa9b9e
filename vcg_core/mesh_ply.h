// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <string_view>

namespace orthopoly {

/// Reads a PLY file, as text or binary in either byte order, in the precision it was written with.
/// What it holds beside vertices and triangles is passed over.
///
/// vcglib's reader takes the counts, list lengths and vertex indices of a file on trust, cuts
/// polygons into triangles without saying so and does not know how to read double precision in the
/// other byte order. Throws FileError, saying where and what: for counts the file has no room for,
/// words that are not numbers, faces that are not triangles, indices out of range, an end before
/// the last element.
TriangleMesh parse_ply(std::string_view content);

} // namespace orthopoly
