// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "adjacency.h"
#include "triangle_mesh.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <utility>
#include <vector>

namespace orthopoly {

constexpr double PI = 3.14159265358979323846;
constexpr double DEGREE = PI / 180;

/// The angle between two vectors of any length, in radians.
inline double angle_between(const Point& a, const Point& b)
{
	return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// Mean angle in degrees between the normals and `expected(i)` for the i-th of them.
template<class Expected>
double mean_angle(const std::vector<Point>& normals, Expected expected)
{
	double sum = 0;
	for (std::size_t i = 0; i < normals.size(); ++i)
		sum += angle_between(normals[i], expected(i)) / DEGREE;
	return sum / static_cast<double>(normals.size());
}

/// One of the lists, to compare with.
inline std::vector<Index> list(const IndexLists& lists, Index index)
{
	return {lists.begin(index), lists.end(index)};
}

/// The mesh with other positions.
inline TriangleMesh with_positions(TriangleMesh mesh, std::vector<Point> positions)
{
	mesh.positions = std::move(positions);
	return mesh;
}

/// The mesh made larger about the origin, then moved.
inline TriangleMesh placed(TriangleMesh mesh, double scale, const Point& offset = Point::Zero())
{
	for (Point& point : mesh.positions)
		point = scale * point + offset;
	return mesh;
}

/// Equal to the last bit, signs of zeros and numbers that are none included.
inline bool same_bits(const std::vector<Point>& a, const std::vector<Point>& b)
{
	return a.size() == b.size() &&
		   (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(Point)) == 0);
}

inline bool all_finite(const std::vector<Point>& points)
{
	return std::all_of(
		points.begin(), points.end(), [](const Point& point) { return point.allFinite(); });
}

/// The largest distance between points of the same index.
inline double largest_distance(const std::vector<Point>& a, const std::vector<Point>& b)
{
	double largest = 0;
	for (std::size_t i = 0; i < a.size(); ++i)
		largest = std::max(largest, (a[i] - b[i]).norm());
	return largest;
}

inline EdgeDefects edge_defects(const TriangleMesh& mesh)
{
	Progress silent;
	Execution execution(1, silent);
	return find_edge_defects(mesh.faces, vertex_faces(mesh.vertex_count(), mesh.faces), execution);
}

/// A square of side 1 in the plane z = 0, looking up, its corners in order.
inline TriangleMesh unit_square()
{
	TriangleMesh mesh;
	mesh.positions = {Point(0, 0, 0), Point(1, 0, 0), Point(1, 1, 0), Point(0, 1, 0)};
	mesh.faces = {{0, 1, 2}, {0, 2, 3}};
	return mesh;
}

/// A tetrahedron with three edges of length 1 along the axes.
inline TriangleMesh tetrahedron()
{
	TriangleMesh mesh;
	mesh.positions = {Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0), Point(0, 0, 1)};
	mesh.faces = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
	return mesh;
}

} // namespace orthopoly
