// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <string>

namespace orthopoly {

/// Reads PLY (both kinds), OBJ, OFF or STL, told apart by the name's ending.
///
/// Vertices and faces keep the order of the file; the corners of an STL file that have the same
/// coordinates become one vertex (in the order of their first mention). Polygons are an error; what
/// else the file holds (colours, normals, texture coordinates, materials) is passed over.
/// Throws FileError with the file's name and what is wrong.
TriangleMesh load_mesh(const std::string& path);

/// Writes PLY (binary, double precision), OBJ, OFF or STL (binary), told apart by the name's
/// ending; PLY and STL through vcglib. Throws FileError; nothing is left behind under the name
/// where writing failed.
void save_mesh(const std::string& path, const TriangleMesh& mesh);

/// Throws FileError where the ending of the name or its folder would make save_mesh fail: worth
/// knowing before a long computation.
void check_savable(const std::string& path);

} // namespace orthopoly
