// SPDX-License-Identifier: GPL-3.0-or-later
#include "workspace.h"

#include <algorithm>

namespace orthopoly {

Workspace::Workspace(const TriangleMesh& given_mesh, Execution& given_execution) :
		mesh(given_mesh), execution(given_execution),
		vertex_faces(orthopoly::vertex_faces(given_mesh.vertex_count(), given_mesh.faces)),
		edges(find_edge_defects(given_mesh.faces, vertex_faces, given_execution)),
		mean_edge_length(orthopoly::mean_edge_length(*this, given_mesh.positions))
{
}

Point cross_product_around(
	const Workspace& workspace, const std::vector<Point>& positions, Index vertex)
{
	Point sum = Point::Zero();
	const Index* const last = workspace.vertex_faces.end(vertex);
	for (const Index* face = workspace.vertex_faces.begin(vertex); face != last; ++face)
		sum += face_cross_product(positions, workspace.mesh.faces[at(*face)]);
	return sum;
}

std::vector<Point>
cross_products_around(const Workspace& workspace, const std::vector<Point>& positions)
{
	std::vector<Point> sums(positions.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		sums[i] = cross_product_around(workspace, positions, static_cast<Index>(i));
	});
	return sums;
}

std::vector<Point> vertex_normals(const Workspace& workspace, const std::vector<Point>& positions)
{
	std::vector<Point> normals = cross_products_around(workspace, positions);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const double length = normals[i].norm();
		normals[i] = length > 0 ? Point(normals[i] / length) : Point::Zero();
	});
	return normals;
}

double mean_edge_square_around(
	const Workspace& workspace, const std::vector<Point>& positions, Index vertex)
{
	const Index* const end = workspace.vertex_faces.end(vertex);
	double sum = 0;
	for (const Index* it = workspace.vertex_faces.begin(vertex); it != end; ++it)
		sum += edge_squares(positions, workspace.mesh.faces[at(*it)]);
	const Index edges = 3 * workspace.vertex_faces.size(vertex);
	return edges > 0 ? sum / static_cast<double>(edges) : 0;
}

FaceGeometry face_geometry(const Workspace& workspace, const std::vector<Point>& positions)
{
	FaceGeometry geometry(workspace.mesh.faces.size());
	workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
		geometry.measure(positions, workspace.mesh.faces, i);
	});
	return geometry;
}

double mean_edge_length(const Workspace& workspace, const std::vector<Point>& positions)
{
	const std::vector<Face>& faces = workspace.mesh.faces;
	if (faces.empty())
		return 0;
	const double sum = workspace.execution.sum(workspace.mesh.face_count(), [&](Index i) {
		return perimeter(positions, faces[static_cast<std::size_t>(i)]);
	});
	return sum / (3.0 * static_cast<double>(faces.size()));
}

std::vector<std::uint8_t>
folded_faces(const std::vector<Point>& positions, const Workspace& workspace)
{
	const std::vector<Face>& faces = workspace.mesh.faces;
	std::vector<std::uint8_t> flags(faces.size(), 0);
	workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
		const Face& face = faces[i];
		Point around = Point::Zero();
		for (auto corner = face.begin(); corner != face.end(); ++corner) {
			const Index* const end = workspace.vertex_faces.end(*corner);
			for (const Index* it = workspace.vertex_faces.begin(*corner); it != end; ++it) {
				const Face& other = faces[at(*it)];
				// Each once: those at an earlier corner have been counted there.
				if (at(*it) != i &&
					std::find_first_of(face.begin(), corner, other.begin(), other.end()) == corner)
					around += face_cross_product(positions, other);
			}
		}
		flags[i] = face_cross_product(positions, face).dot(around) < 0 ? 1 : 0;
	});
	return flags;
}

Index count_folded_faces(const std::vector<Point>& positions, const Workspace& workspace)
{
	const std::vector<std::uint8_t> flags = folded_faces(positions, workspace);
	return static_cast<Index>(std::count(flags.begin(), flags.end(), 1));
}

} // namespace orthopoly
