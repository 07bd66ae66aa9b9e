// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "denoise.h"
#include "prefilter.h"
#include "step_fixture.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <vector>

namespace orthopoly {

/// The mesh with its coordinates rounded to steps of so many mean edge lengths.
inline TriangleMesh rounded(TriangleMesh mesh, double step)
{
	const double unit = step * mean_edge_length(mesh.positions, mesh.faces);
	for (Point& position : mesh.positions)
		position = unit * (position / unit).array().round().matrix();
	return mesh;
}

/// The sphere with bumps all over it, so many edges from one to the next and in edges.
inline TriangleMesh bumpy_sphere(Index faces, double edges, double height)
{
	TriangleMesh mesh = make_sphere(faces);
	const double edge = mean_edge_length(mesh.positions, mesh.faces);
	const double wave = 2 * M_PI / (edges * edge);
	for (Point& p : mesh.positions) {
		const double bumps =
			std::cos(wave * p.x()) * std::cos(wave * p.y()) * std::cos(wave * p.z());
		p *= 1 + height * edge * bumps / p.norm();
	}
	return mesh;
}

/// Denoises without anyone watching.
inline DenoiseResult denoised(const TriangleMesh& mesh, const DenoiseOptions& options)
{
	Progress progress;
	return denoise(mesh, options, progress);
}

/// The same with every parameter at its default.
inline DenoiseResult denoised(const TriangleMesh& mesh, int threads = 1)
{
	DenoiseOptions options;
	options.threads = threads;
	return denoised(mesh, options);
}

/// The same mesh with its vertices and faces in another order, and the way back.
struct Renumbered {
	TriangleMesh mesh;
	/// #V: where each vertex went.
	std::vector<std::size_t> places;

	explicit Renumbered(const TriangleMesh& given) : mesh(given), places(given.positions.size())
	{
		std::mt19937 generator(3);
		std::iota(places.begin(), places.end(), std::size_t(0));
		std::shuffle(places.begin(), places.end(), generator);
		for (std::size_t i = 0; i < places.size(); ++i)
			mesh.positions[places[i]] = given.positions[i];
		std::shuffle(mesh.faces.begin(), mesh.faces.end(), generator);
		for (Face& face : mesh.faces) {
			for (Index& corner : face)
				corner = static_cast<Index>(places[static_cast<std::size_t>(corner)]);
			std::rotate(face.begin(), face.begin() + generator() % 3, face.end());
		}
	}

	/// Positions of the renumbered mesh in the order of the one given.
	std::vector<Point> in_given_order(const std::vector<Point>& positions) const
	{
		std::vector<Point> result;
		for (const std::size_t place : places)
			result.push_back(positions[place]);
		return result;
	}
};

/// Noise as a scanner leaves it: white noise smoothed over the surface, made as strong as before.
inline TriangleMesh
with_correlated_noise(const TriangleMesh& truth, double sigma, int smoothing_steps = 4)
{
	const StepFixture f(truth);
	const double edge = f.workspace.mean_edge_length;
	std::vector<Point> offsets = noisy(truth, 1).positions;
	for (std::size_t i = 0; i < offsets.size(); ++i)
		offsets[i] -= truth.positions[i];
	for (int step = 0; step < smoothing_steps; ++step) {
		std::vector<Point> mean(offsets.size(), Point::Zero());
		for (Index i = 0; i < truth.vertex_count(); ++i) {
			const IndexLists& around = f.workspace.vertex_faces;
			for (const Index* it = around.begin(i); it != around.end(i); ++it) {
				for (const Index corner : truth.faces[static_cast<std::size_t>(*it)])
					mean[static_cast<std::size_t>(i)] +=
						offsets[static_cast<std::size_t>(corner)] / (3.0 * around.size(i));
			}
		}
		offsets.swap(mean);
	}
	double square = 0;
	for (const Point& offset : offsets)
		square += offset.squaredNorm();
	const double factor = sigma * edge / std::sqrt(square / static_cast<double>(offsets.size()));
	TriangleMesh mesh = truth;
	for (std::size_t i = 0; i < offsets.size(); ++i)
		mesh.positions[i] += factor * offsets[i];
	return mesh;
}

/// What a single pair of Taubin smoothing leaves of a mesh and its noise.
inline TriangleMesh hardly_smoothed(const TriangleMesh& mesh)
{
	const StepFixture f(mesh);
	TriangleMesh result = mesh;
	taubin_smooth(f.workspace, 1, result.positions);
	return result;
}

/// Detail from a few edges to many all over a surface, the wider the higher, as the roughness of
/// scanned things is.
inline TriangleMesh with_relief(const TriangleMesh& truth)
{
	TriangleMesh mesh = with_correlated_noise(truth, 0.1, 2);
	mesh = with_correlated_noise(mesh, 0.2, 8);
	return with_correlated_noise(mesh, 0.4, 32);
}

} // namespace orthopoly
