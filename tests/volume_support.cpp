// SPDX-License-Identifier: GPL-3.0-or-later
#include "volume_support.h"

#include "float_mesh.h"
#include "vcg_adapter.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>
// Without their assertions these leave paths that GCC takes for reachable.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif
#include <vcg/complex/algorithms/create/marching_cubes.h>
#include <vcg/complex/algorithms/create/mc_trivial_walker.h>

namespace orthopoly {

namespace {

using Volume = vcg::SimpleVolume<vcg::SimpleVoxel<float>>;

} // namespace

TriangleMesh
surface_of(const std::function<double(const Point&)>& distance, int cubes, double noise)
{
	Volume volume;
	const int values = cubes + 1;
	volume.Init(vcg::Point3i(values, values, values), Volume::Box3x({-1, -1, -1}, {1, 1, 1}));
	std::mt19937 generator(1);
	std::normal_distribution<double> normal;
	const double cube = 2.0 / cubes;
	for (int z = 0; z < values; ++z) {
		for (int y = 0; y < values; ++y) {
			for (int x = 0; x < values; ++x) {
				// Within a few cubes of the surface, as fused depth images have it: none elsewhere.
				const double value = distance(cube * Point(x, y, z) - Point(1, 1, 1)) / cube;
				const double near = std::max(-3.0, std::min(3.0, value));
				volume.Val(x, y, z) = static_cast<float>(near + noise * normal(generator));
			}
		}
	}
	using Walker = vcg::tri::TrivialWalker<FloatMesh, Volume>;
	FloatMesh mesh;
	Walker walker;
	vcg::tri::MarchingCubes<FloatMesh, Walker> marching(mesh, walker);
	walker.BuildMesh(mesh, volume, marching, 0);
	return read_vcg_mesh(mesh).mesh;
}

TriangleMesh ball_of_volume(double radius, int cubes, double noise)
{
	const auto distance = [&](const Point& p) { return p.norm() - radius; };
	return surface_of(distance, cubes, noise);
}

TriangleMesh ball_from_points(double radius, int cubes, double noise)
{
	struct Wave {
		Point vector;
		double phase;
	};
	constexpr int WAVES = 200;
	std::mt19937 generator(1);
	std::normal_distribution<double> normal;
	std::uniform_real_distribution<double> uniform(0, 1);
	const double cube = 2.0 / cubes;
	std::vector<Wave> waves;
	for (int k = 0; k < WAVES; ++k) {
		Point direction;
		for (double& x : direction)
			x = normal(generator);
		const double length = (3 + 3 * uniform(generator)) * cube;
		waves.push_back(
			{2 * M_PI / length * direction.normalized(), 2 * M_PI * uniform(generator)});
	}
	const double height = noise * cube * std::sqrt(2.0 / WAVES);
	const auto distance = [&](const Point& p) {
		double sum = p.norm() - radius;
		if (std::abs(sum) < 4 * cube) {
			for (const Wave& wave : waves)
				sum += height * std::cos(wave.vector.dot(p) + wave.phase);
		}
		return sum;
	};
	return surface_of(distance, cubes, 0);
}

} // namespace orthopoly
