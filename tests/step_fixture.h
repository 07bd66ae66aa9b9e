// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "noise.h"
#include "shapes.h"
#include "test_support.h"
#include "workspace.h"

#include <Eigen/Geometry>
#include <cstring>
#include <utility>
#include <vector>

namespace orthopoly {

/// A mesh with what the steps of a method need to work on it.
struct StepFixture {
	explicit StepFixture(TriangleMesh given, int threads = 1) :
			mesh(std::move(given)), execution(threads, progress), workspace(mesh, execution),
			geometry(face_geometry(mesh.positions, mesh.faces))
	{
	}

	TriangleMesh mesh;
	Progress progress;
	Execution execution;
	Workspace workspace;
	FaceGeometry geometry;
};

/// The square [0, 1]^2 at z = 0 in n x n squares of two triangles, normals up.
inline TriangleMesh make_flat_grid(int n)
{
	TriangleMesh mesh;
	for (int y = 0; y <= n; ++y) {
		for (int x = 0; x <= n; ++x)
			mesh.positions.emplace_back(double(x) / n, double(y) / n, 0.0);
	}
	for (int y = 0; y < n; ++y) {
		for (int x = 0; x < n; ++x) {
			const Index a = y * (n + 1) + x;
			mesh.faces.push_back({a, a + 1, a + n + 2});
			mesh.faces.push_back({a, a + n + 2, a + n + 1});
		}
	}
	return mesh;
}

/// The same mesh with noise on it.
inline TriangleMesh
noisy(TriangleMesh mesh, double sigma, NoiseDirection direction = NoiseDirection::Normal)
{
	NoiseOptions options;
	options.sigma = sigma;
	options.direction = direction;
	options.seed = 7;
	mesh.positions = add_noise(mesh, options);
	return mesh;
}

/// The same with a share of the noise that depends on the place: `share(point)` of it.
template<class Share>
TriangleMesh unevenly_noisy(const TriangleMesh& mesh, double sigma, Share share)
{
	TriangleMesh result = noisy(mesh, sigma);
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		const Point& p = mesh.positions[i];
		result.positions[i] = p + share(p) * (result.positions[i] - p);
	}
	return result;
}

/// #V: that share at the mesh's vertices.
template<class Share>
std::vector<double> share_at_vertices(const TriangleMesh& mesh, Share share)
{
	std::vector<double> shares;
	for (const Point& position : mesh.positions)
		shares.push_back(share(position));
	return shares;
}

/// A rotation about no axis in particular.
inline Eigen::Matrix3d some_rotation()
{
	return Eigen::AngleAxisd(1.1, Point(1, -2, 3).normalized()).toRotationMatrix();
}

template<class Transform>
std::vector<Point> each(std::vector<Point> points, Transform transform)
{
	for (Point& point : points)
		point = transform(point);
	return points;
}

/// One point, as `same_bits` of test_support.h does with many.
inline bool same_bits(const Point& a, const Point& b)
{
	return std::memcmp(a.data(), b.data(), 3 * sizeof(double)) == 0;
}

} // namespace orthopoly
