// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <string>
#include <string_view>

namespace orthopoly {

// The formats without types and headers of their own, on text in memory. vcglib's readers of them
// keep neither double precision (STL) nor faces that name a vertex twice (OBJ), and trust the
// numbers in a damaged file; its writers round coordinates. All of these throw FileError with the
// line and what is wrong there, and do not depend on the locale.

/// Reads an OFF file, whatever its vertices carry beside their coordinates.
TriangleMesh parse_off(std::string_view text);

/// Reads an OBJ file; everything but `v` and `f` is passed over.
TriangleMesh parse_obj(std::string_view text);

/// Reads an STL file of either kind. Corners with the same coordinates become one vertex.
TriangleMesh parse_stl(std::string_view content);

/// An OFF file in which every coordinate reads back bit for bit.
std::string format_off(const TriangleMesh& mesh);

/// An OBJ file in which every coordinate reads back bit for bit.
std::string format_obj(const TriangleMesh& mesh);

} // namespace orthopoly
