// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// Which way a noisy vertex is pushed.
enum class NoiseDirection {
	/// A Gaussian amplitude times a direction drawn evenly from the sphere (Table 2 of the paper).
	Random,
	/// A Gaussian amplitude along the vertex normal.
	Normal,
	/// An independent Gaussian amplitude along each axis.
	Isotropic,
};

/// Options of `add_noise`.
struct NoiseOptions {
	/// Standard deviation of the amplitude, in mean edge lengths.
	double sigma = 0.2;
	NoiseDirection direction = NoiseDirection::Random;
	/// Share of the vertices that are moved (0 to 1); 1 is ordinary noise, less is impulsive noise.
	double impulsive_share = 1.0;
	std::uint32_t seed = 1;
};

/// The positions with noise on them, #V. Fixed vertices stay bit for bit; those that are the same
/// on a seam (seams.h) move together.
///
/// Same mesh, options and seed: same result on every platform (the generator, the transformation to
/// a Gaussian and the order of the draws are all fixed here; the standard library's distributions
/// are not). Throws InvalidParameter for an option out of its range (parameters.h), InvalidMesh for
/// a mesh without faces, with a coordinate that is not finite or an index out of range.
std::vector<Point> add_noise(const TriangleMesh& mesh, const NoiseOptions& options);

} // namespace orthopoly
