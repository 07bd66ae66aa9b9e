// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_part.h"

#include "local_heights.h"

#include <algorithm>
#include <utility>

namespace orthopoly {

namespace {

constexpr Index PLACES = 8;

// Rings of vertices of a place, and of those in it that are inner ones: where nothing reaches that
// structures of seven rings and smoothing make of the cut.
constexpr int RINGS = 32;
constexpr int INNER_RINGS = 20;

constexpr std::uint8_t AROUND = 1;
constexpr std::uint8_t INNER = 2;

} // namespace

std::vector<double> MeshPart::values_of(const std::vector<double>& values) const
{
	std::vector<double> own;
	if (values.empty())
		return own;
	own.reserve(indices.size());
	for (const Index i : indices)
		own.push_back(values[at(i)]);
	return own;
}

MeshPart cut_out_places(const Workspace& workspace)
{
	const TriangleMesh& mesh = workspace.mesh;
	std::vector<std::uint8_t> states(mesh.positions.size(), 0);
	VertexRings rings(workspace);
	for (const Index seed : sample_vertices(workspace, mesh.positions, PLACES)) {
		for (const auto& [count, state] :
			 {std::pair(RINGS, AROUND), std::pair(INNER_RINGS, INNER)}) {
			rings.collect(seed, count);
			for (const Index i : rings.vertices())
				states[at(i)] = std::max(states[at(i)], state);
		}
	}
	MeshPart part;
	std::vector<Index> numbers(mesh.positions.size(), -1);
	for (Index i = 0; i < mesh.vertex_count(); ++i) {
		if (states[at(i)] == 0)
			continue;
		numbers[at(i)] = part.mesh.vertex_count();
		part.indices.push_back(i);
		part.inner.push_back(states[at(i)] == INNER ? 1 : 0);
		part.mesh.positions.push_back(mesh.positions[at(i)]);
		if (!mesh.fixed.empty())
			part.mesh.fixed.push_back(mesh.fixed[at(i)]);
	}
	for (const Face& face : mesh.faces) {
		const Face inside = {numbers[at(face[0])], numbers[at(face[1])], numbers[at(face[2])]};
		if (std::min({inside[0], inside[1], inside[2]}) >= 0)
			part.mesh.faces.push_back(inside);
	}
	return part;
}

} // namespace orthopoly
