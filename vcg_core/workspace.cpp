// SPDX-License-Identifier: GPL-3.0-or-later
#include "workspace.h"

#include <numeric>

namespace orthopoly {

namespace {

constexpr Index GRAIN = 2048;

} // namespace

Workspace::Workspace(const TriangleMesh& given_mesh, Execution& given_execution) :
		mesh(given_mesh), execution(given_execution),
		vertex_faces(orthopoly::vertex_faces(given_mesh.vertex_count(), given_mesh.faces)),
		boundary(boundary_vertices(given_mesh.vertex_count(), given_mesh.faces)),
		mean_edge_length(orthopoly::mean_edge_length(given_mesh.positions, given_mesh.faces))
{
}

Index count_folded_faces(const std::vector<Point>& positions, const Workspace& workspace)
{
	std::vector<RingCollector> rings = workspace.ring_collectors();
	std::vector<Index> counts(rings.size(), 0);
	workspace.execution.parallel_for(
		workspace.mesh.face_count(), GRAIN, [&](Index begin, Index end, int worker) {
			const auto cross = [&](Index face) {
				return face_cross_product(
					positions, workspace.mesh.faces[static_cast<std::size_t>(face)]);
			};
			RingCollector& ring = rings[static_cast<std::size_t>(worker)];
			for (Index i = begin; i < end; ++i) {
				ring.collect(i, 1);
				// The face itself comes first.
				Point around = Point::Zero();
				for (std::size_t k = 1; k < ring.faces().size(); ++k)
					around += cross(ring.faces()[k]);
				if (cross(i).dot(around) < 0)
					++counts[static_cast<std::size_t>(worker)];
			}
		});
	return std::accumulate(counts.begin(), counts.end(), Index(0));
}

} // namespace orthopoly
