// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace orthopoly {

/// Index of a vertex, a face or a corner of one. 32 bits: the neighbour lists are half as large,
/// and more than seven hundred million faces are out of reach anyway.
using Index = std::int32_t;

/// An index as the standard containers want it.
constexpr std::size_t at(Index index)
{
	return static_cast<std::size_t>(index);
}

using Point = Eigen::Vector3d;
using Face = std::array<Index, 3>;

/// A triangle mesh as flat arrays: what every algorithm here works on.
struct TriangleMesh {
	/// #V positions, in the caller's length unit.
	std::vector<Point> positions;
	/// #F triples of vertex indices.
	std::vector<Face> faces;
	/// #V flags, or empty. A vertex whose flag is not zero keeps its position bit for bit.
	std::vector<std::uint8_t> fixed;

	Index vertex_count() const { return static_cast<Index>(positions.size()); }
	Index face_count() const { return static_cast<Index>(faces.size()); }
	bool is_fixed(Index vertex) const
	{
		return !fixed.empty() && fixed[static_cast<std::size_t>(vertex)] != 0;
	}
};

/// Normal, centroid and area of every face, in one array a quantity (#F each).
struct FaceGeometry {
	/// Unit normals by the order of the vertices; zero where the face has no area.
	std::vector<Point> normals;
	std::vector<Point> centroids;
	std::vector<double> areas;

	FaceGeometry() = default;
	explicit FaceGeometry(std::size_t face_count);
	/// Fills in face `i`.
	void
	measure(const std::vector<Point>& positions, const std::vector<Face>& faces, std::size_t i);
};

/// Throws InvalidMesh where a face names a vertex that is not there or a coordinate is not
/// finite or beyond 1e60, where there are more vertices or corners of faces than an Index counts,
/// or where `fixed` is neither empty nor #V long. Faces without area,
/// repeated faces, unreferenced vertices and non-manifold parts are fine.
void validate(const TriangleMesh& mesh);

/// Twice the area times the unit normal of a face.
inline Point face_cross_product(const std::vector<Point>& positions, const Face& face)
{
	const auto corner = [&](std::size_t k) -> const Point& {
		return positions[static_cast<std::size_t>(face[k])];
	};
	return (corner(1) - corner(0)).cross(corner(2) - corner(0));
}

/// An order of points, by x, then y, then z.
inline bool comes_before(const Point& a, const Point& b)
{
	return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

/// False where a face names a vertex twice.
inline bool has_three_vertices(const Face& face)
{
	return face[0] != face[1] && face[1] != face[2] && face[2] != face[0];
}

/// Mean of the corners of a face; reckoned from the first of them, since the sum of three corners
/// far off would lose digits.
inline Point face_centroid(const std::vector<Point>& positions, const Face& face)
{
	const Point& a = positions[at(face[0])];
	return a + ((positions[at(face[1])] - a) + (positions[at(face[2])] - a)) / 3.0;
}

/// True where a face names a vertex twice or its area is too small for its normal to mean
/// anything: below 1e-14 of its longest edge squared.
bool is_degenerate(const std::vector<Point>& positions, const Face& face);

/// Normals, centroids and areas of all faces, computed in one pass. #F each.
FaceGeometry face_geometry(const std::vector<Point>& positions, const std::vector<Face>& faces);

/// Square of the length of a face's longest edge.
double longest_edge_squared(const std::vector<Point>& positions, const Face& face);

/// Sum of the squares of the lengths of a face's edges.
double edge_squares(const std::vector<Point>& positions, const Face& face);

/// Sum of the lengths of a face's edges.
double perimeter(const std::vector<Point>& positions, const Face& face);

/// Mean length of the edges, every edge of every face counted (an inner edge twice); zero for a
/// mesh without faces. The unit of noise levels is that of the surface below the noise, which
/// lengthens edges.
double mean_edge_length(const std::vector<Point>& positions, const std::vector<Face>& faces);

/// Length of the diagonal of the axis-aligned box around the vertices; zero for none.
double bounding_box_diagonal(const std::vector<Point>& positions);

} // namespace orthopoly
