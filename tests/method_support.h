// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "denoise.h"
#include "step_fixture.h"

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

namespace orthopoly {

/// The mesh with other positions.
inline TriangleMesh with_positions(TriangleMesh mesh, std::vector<Point> positions)
{
	mesh.positions = std::move(positions);
	return mesh;
}

/// Denoises without anyone watching.
inline DenoiseResult denoised(const TriangleMesh& mesh, const DenoiseOptions& options)
{
	Progress progress;
	return denoise(mesh, options, progress);
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

} // namespace orthopoly
