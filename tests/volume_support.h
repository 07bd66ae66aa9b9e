// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <functional>

namespace orthopoly {

/// The surface where a function of a place within [-1, 1] on each axis is zero, below it inside: by
/// vcglib's marching cubes from a volume of `cubes` a side.
/// @param noise standard deviation of what is added to each value of the volume, in cubes
TriangleMesh
surface_of(const std::function<double(const Point&)>& distance, int cubes, double noise);

/// The same of a ball of that radius.
TriangleMesh ball_of_volume(double radius, int cubes, double noise);

/// A ball of that radius whose surface goes up and down as that of one reconstructed from noisy
/// points: a random field of waves of three to six cubes.
/// @param noise standard deviation of the surface, in cubes
TriangleMesh ball_from_points(double radius, int cubes, double noise);

} // namespace orthopoly
