// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects.h"

#include "shapes.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace orthopoly {

namespace {

constexpr int SQUARES = 6;

TriangleMesh box()
{
	return make_box({SQUARES, SQUARES, SQUARES}, Point::Constant(1));
}

Index find_vertex(const TriangleMesh& mesh, const Point& point)
{
	Index nearest = 0;
	for (Index i = 1; i < mesh.vertex_count(); ++i) {
		if ((mesh.positions[static_cast<std::size_t>(i)] - point).squaredNorm() <
			(mesh.positions[static_cast<std::size_t>(nearest)] - point).squaredNorm())
			nearest = i;
	}
	return nearest;
}

Index add_vertex(TriangleMesh& mesh, const Point& point)
{
	mesh.positions.push_back(point);
	return mesh.vertex_count() - 1;
}

void add_mesh(TriangleMesh& mesh, const TriangleMesh& other, const Point& offset)
{
	const Index first = mesh.vertex_count();
	for (const Point& point : other.positions)
		mesh.positions.emplace_back(point + offset);
	for (const Face& face : other.faces)
		mesh.faces.push_back({face[0] + first, face[1] + first, face[2] + first});
}

} // namespace

TriangleMesh make_non_manifold_edge()
{
	TriangleMesh mesh = box();
	std::array<Index, SQUARES + 1> foot {};
	std::array<Index, SQUARES + 1> top {};
	for (std::size_t i = 0; i <= SQUARES; ++i) {
		const double x = static_cast<double>(i) / SQUARES - 0.5;
		foot[i] = find_vertex(mesh, Point(x, 0.5, 0.5));
		top[i] = add_vertex(mesh, Point(x, 0.7, 0.7));
	}
	for (std::size_t i = 0; i < SQUARES; ++i) {
		mesh.faces.push_back({foot[i], foot[i + 1], top[i]});
		mesh.faces.push_back({foot[i + 1], top[i + 1], top[i]});
	}
	return mesh;
}

TriangleMesh make_non_manifold_vertex()
{
	TriangleMesh mesh = box();
	const Index shared = find_vertex(mesh, Point::Constant(0.5));
	const Index first = mesh.vertex_count();
	add_mesh(mesh, box(), Point::Constant(1));
	const Index twin = first + find_vertex(box(), Point::Constant(-0.5));
	for (Face& face : mesh.faces) {
		for (Index& vertex : face) {
			if (vertex == twin)
				vertex = shared;
			// The last vertex takes the number of the one that is no longer used.
			else if (vertex == mesh.vertex_count() - 1)
				vertex = twin;
		}
	}
	mesh.positions[static_cast<std::size_t>(twin)] = mesh.positions.back();
	mesh.positions.pop_back();
	return mesh;
}

TriangleMesh make_degenerate_face()
{
	TriangleMesh mesh = box();
	// An edge of the first face is split in its middle; the face that fills the gap is a line.
	const Face split = mesh.faces[0];
	const Point middle = 0.5 * (mesh.positions[static_cast<std::size_t>(split[0])] +
								mesh.positions[static_cast<std::size_t>(split[1])]);
	const Index between = add_vertex(mesh, middle);
	mesh.faces[0] = {between, split[1], split[2]};
	mesh.faces.push_back({split[0], between, split[2]});
	mesh.faces.push_back({split[0], split[1], between});
	mesh.faces.push_back({split[0], split[0], split[1]});
	return mesh;
}

TriangleMesh make_duplicate_vertex()
{
	TriangleMesh mesh = box();
	const Index corner = find_vertex(mesh, Point::Constant(0.5));
	const Index twin = add_vertex(mesh, mesh.positions[static_cast<std::size_t>(corner)]);
	bool use_twin = false;
	for (Face& face : mesh.faces) {
		for (Index& vertex : face) {
			if (vertex == corner) {
				vertex = use_twin ? twin : corner;
				use_twin = !use_twin;
			}
		}
	}
	return mesh;
}

TriangleMesh make_seam()
{
	TriangleMesh mesh = box();
	std::map<Index, Index> twins;
	for (Face& face : mesh.faces) {
		const bool is_upper = face_centroid(mesh.positions, face).z() > 0;
		for (Index& vertex : face) {
			const Point point = mesh.positions[at(vertex)];
			if (!is_upper || std::abs(point.z()) > 0.01)
				continue;
			if (twins.count(vertex) == 0)
				twins[vertex] = add_vertex(mesh, point);
			vertex = twins[vertex];
		}
	}
	return mesh;
}

TriangleMesh make_loose_triangles()
{
	const TriangleMesh whole = box();
	TriangleMesh mesh;
	for (const Face& face : whole.faces) {
		const Index first = mesh.vertex_count();
		for (const Index vertex : face)
			mesh.positions.push_back(whole.positions[at(vertex)]);
		mesh.faces.push_back({first, first + 1, first + 2});
	}
	return mesh;
}

TriangleMesh make_duplicate_face()
{
	TriangleMesh mesh = box();
	const Face face = mesh.faces[10];
	mesh.faces.push_back(face);
	mesh.faces.push_back({face[0], face[2], face[1]});
	return mesh;
}

TriangleMesh make_unreferenced_vertex()
{
	TriangleMesh mesh = box();
	add_vertex(mesh, Point(3, 0, 0));
	return mesh;
}

TriangleMesh make_isolated_face()
{
	TriangleMesh mesh = box();
	const Index a = add_vertex(mesh, Point(1, 0, 0));
	const Index b = add_vertex(mesh, Point(1.2, 0, 0));
	const Index c = add_vertex(mesh, Point(1.1, 0.2, 0));
	mesh.faces.push_back({a, b, c});
	return mesh;
}

TriangleMesh make_mixed_orientation()
{
	TriangleMesh mesh = box();
	for (std::size_t i = 0; i < mesh.faces.size(); i += 5)
		std::swap(mesh.faces[i][1], mesh.faces[i][2]);
	return mesh;
}

TriangleMesh make_two_components()
{
	TriangleMesh mesh = box();
	add_mesh(mesh, box(), Point(2, 0.3, 0.1));
	return mesh;
}

TriangleMesh make_empty()
{
	return {};
}

TriangleMesh make_points_only()
{
	TriangleMesh mesh = box();
	mesh.faces.clear();
	return mesh;
}

TriangleMesh make_nan_coordinate()
{
	TriangleMesh mesh = box();
	mesh.positions[7].y() = std::numeric_limits<double>::quiet_NaN();
	return mesh;
}

} // namespace orthopoly
