// SPDX-License-Identifier: GPL-3.0-or-later
#include "workspace.h"

namespace orthopoly {

Workspace::Workspace(const TriangleMesh& given_mesh, Execution& given_execution) :
		mesh(given_mesh), execution(given_execution),
		vertex_faces(orthopoly::vertex_faces(given_mesh.vertex_count(), given_mesh.faces)),
		face_neighbors(orthopoly::face_neighbors(given_mesh.faces, vertex_faces)),
		boundary(boundary_vertices(given_mesh.vertex_count(), given_mesh.faces)),
		mean_edge_length(orthopoly::mean_edge_length(given_mesh.positions, given_mesh.faces))
{
}

Index count_folded_faces(const std::vector<Point>& positions, const Workspace& workspace)
{
	Index count = 0;
	for (Index i = 0; i < workspace.mesh.face_count(); ++i) {
		const auto cross = [&](Index face) {
			return face_cross_product(
				positions, workspace.mesh.faces[static_cast<std::size_t>(face)]);
		};
		Point around = Point::Zero();
		for (const Index* it = workspace.face_neighbors.begin(i);
			 it != workspace.face_neighbors.end(i);
			 ++it)
			around += cross(*it);
		if (cross(i).dot(around) < 0)
			++count;
	}
	return count;
}

} // namespace orthopoly
