// SPDX-License-Identifier: GPL-3.0-or-later
#include "triangle_mesh.h"

#include "errors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

namespace orthopoly {

namespace {

const Point& corner(const std::vector<Point>& positions, const Face& face, std::size_t k)
{
	return positions[static_cast<std::size_t>(face[k])];
}

// Twice the area over the longest edge squared: below this the direction of the cross product is
// mostly rounding of coordinates that a host may keep in single precision.
constexpr double DEGENERATE_RATIO = 1e-14;

// Squares of areas still fit into a number then.
constexpr double LARGEST_COORDINATE = 1e60;

// Every vertex and every corner of a face has an index.
constexpr std::size_t MOST_VERTICES = std::numeric_limits<Index>::max();
constexpr std::size_t MOST_FACES = MOST_VERTICES / 3;

} // namespace

void validate(const TriangleMesh& mesh)
{
	if (mesh.positions.size() > MOST_VERTICES || mesh.faces.size() > MOST_FACES)
		throw InvalidMesh(
			"the mesh has " + std::to_string(mesh.positions.size()) + " vertices and " +
			std::to_string(mesh.faces.size()) + " faces; at most " + std::to_string(MOST_VERTICES) +
			" and " + std::to_string(MOST_FACES) +
			" can be counted: simplify it or cut it into parts");
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		if (!mesh.positions[i].allFinite())
			throw InvalidMesh(
				"vertex " + std::to_string(i) +
				" has a coordinate that is not a finite number; remove or repair that vertex first");
		if (mesh.positions[i].cwiseAbs().maxCoeff() > LARGEST_COORDINATE)
			throw InvalidMesh(
				"vertex " + std::to_string(i) +
				" has a coordinate beyond 1e60; scale the mesh down or remove that vertex first");
	}
	for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
		for (const Index vertex : mesh.faces[i]) {
			if (vertex < 0 || vertex >= mesh.vertex_count())
				throw InvalidMesh(
					"face " + std::to_string(i) + " has vertex index " + std::to_string(vertex) +
					", the mesh has " + std::to_string(mesh.vertex_count()) +
					" vertices; repair the face list first");
		}
	}
	if (!mesh.fixed.empty() && mesh.fixed.size() != mesh.positions.size())
		throw InvalidMesh(
			"there are " + std::to_string(mesh.fixed.size()) + " fixed flags for " +
			std::to_string(mesh.positions.size()) + " vertices; give one a vertex, or none at all");
}

bool is_degenerate(const std::vector<Point>& positions, const Face& face)
{
	// Negated, so that the answer is also true where the lengths are not numbers.
	return !(
		face_cross_product(positions, face).norm() >
		DEGENERATE_RATIO * longest_edge_squared(positions, face));
}

FaceGeometry::FaceGeometry(std::size_t face_count) :
		normals(face_count), centroids(face_count), areas(face_count)
{
}

void FaceGeometry::measure(
	const std::vector<Point>& positions, const std::vector<Face>& faces, std::size_t i)
{
	const Face& face = faces[i];
	const Point cross = face_cross_product(positions, face);
	const double length = cross.norm();
	areas[i] = 0.5 * length;
	centroids[i] = face_centroid(positions, face);
	normals[i] = is_degenerate(positions, face) ? Point(Point::Zero()) : Point(cross / length);
}

FaceGeometry face_geometry(const std::vector<Point>& positions, const std::vector<Face>& faces)
{
	FaceGeometry geometry(faces.size());
	for (std::size_t i = 0; i < faces.size(); ++i)
		geometry.measure(positions, faces, i);
	return geometry;
}

double longest_edge_squared(const std::vector<Point>& positions, const Face& face)
{
	const Point& a = corner(positions, face, 0);
	const Point& b = corner(positions, face, 1);
	const Point& c = corner(positions, face, 2);
	return std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
}

double edge_squares(const std::vector<Point>& positions, const Face& face)
{
	double sum = 0;
	for (std::size_t k = 0; k < 3; ++k)
		sum += (corner(positions, face, (k + 1) % 3) - corner(positions, face, k)).squaredNorm();
	return sum;
}

double perimeter(const std::vector<Point>& positions, const Face& face)
{
	double sum = 0;
	for (std::size_t k = 0; k < 3; ++k)
		sum += (corner(positions, face, (k + 1) % 3) - corner(positions, face, k)).norm();
	return sum;
}

double mean_edge_length(const std::vector<Point>& positions, const std::vector<Face>& faces)
{
	if (faces.empty())
		return 0;
	double sum = 0;
	for (const Face& face : faces)
		sum += perimeter(positions, face);
	return sum / (3.0 * static_cast<double>(faces.size()));
}

double bounding_box_diagonal(const std::vector<Point>& positions)
{
	if (positions.empty())
		return 0;
	Point low = positions.front();
	Point high = positions.front();
	for (const Point& point : positions) {
		low = low.cwiseMin(point);
		high = high.cwiseMax(point);
	}
	return (high - low).norm();
}

} // namespace orthopoly
