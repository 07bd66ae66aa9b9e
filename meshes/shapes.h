// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <array>

namespace orthopoly {

// Clean meshes of any size, made by rule: the same call gives the same mesh. The number of faces is
// the closest to the one asked for that the shape's pattern allows. README.md has the recipes.

/// A box around the origin, `counts` squares along its edges of the given lengths; two triangles a
/// square, closed.
TriangleMesh make_box(const std::array<int, 3>& counts, const Point& lengths);

/// The cube of side 2; 32 squares along an edge give 12288 faces.
TriangleMesh make_cube(Index faces);

/// A square plate whose two sides are one mean edge length apart.
TriangleMesh make_thin_plate(Index faces);

/// The unit sphere, an icosahedron subdivided; the vertices lie on the sphere exactly.
TriangleMesh make_sphere(Index faces);

/// A torus of radii 1 and 0.4; the vertices lie on it exactly.
TriangleMesh make_torus(Index faces);

/// A machined part of genus one: a block with sharp edges and corners on a thin round flange, a
/// rounded rim and a bore. Flat, curved and sharp regions; the flange is 0.06 thick at a diameter
/// of 3. The pattern of the triangles is irregular.
TriangleMesh make_part(Index faces);

/// A height field as a scanner gives it: jittered samples over a rectangle of 2 by 1.5, rolling
/// ground with a step, open boundary with bites out of it, a hole inside.
TriangleMesh make_height_field(Index faces);

/// What a line scanner gives of a bent sheet of 2 by 2 with a rib and a bead across its lines: the
/// samples of a line are eight times as close as the lines, so that all triangles are long and
/// thin.
TriangleMesh make_scan_lines(Index faces);

} // namespace orthopoly
