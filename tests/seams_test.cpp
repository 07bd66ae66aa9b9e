// SPDX-License-Identifier: GPL-3.0-or-later
#include "seams.h"

#include "defects.h"
#include "method_support.h"
#include "shapes.h"
#include "test_support.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstdint>
#include <functional>
#include <map>
#include <vector>

using namespace orthopoly;

namespace {

// The mesh with vertices of its own for each of its charts, by the chart of a face.
TriangleMesh in_charts(const TriangleMesh& mesh, const std::function<int(const Face&)>& chart_of)
{
	TriangleMesh split = mesh;
	std::vector<int> charts(mesh.positions.size(), -1);
	std::map<std::pair<Index, int>, Index> copies;
	for (Face& face : split.faces) {
		const int chart = chart_of(face);
		for (Index& vertex : face) {
			if (charts[at(vertex)] < 0)
				charts[at(vertex)] = chart;
			if (charts[at(vertex)] == chart)
				continue;
			const auto [copy, is_new] =
				copies.emplace(std::make_pair(vertex, chart), split.vertex_count());
			if (is_new)
				split.positions.push_back(mesh.positions[at(vertex)]);
			vertex = copy->second;
		}
	}
	return split;
}

// Eight charts, which meet in corners.
TriangleMesh in_octants(const TriangleMesh& mesh)
{
	return in_charts(mesh, [&](const Face& face) {
		const Point centroid = face_centroid(mesh.positions, face);
		return (centroid.x() > 0 ? 1 : 0) + (centroid.y() > 0 ? 2 : 0) + (centroid.z() > 0 ? 4 : 0);
	});
}

// The mesh and its back: the same faces turned over, with vertices of their own.
TriangleMesh with_back(const TriangleMesh& mesh)
{
	TriangleMesh both = mesh;
	both.positions.insert(both.positions.end(), mesh.positions.begin(), mesh.positions.end());
	for (const Face& face : mesh.faces) {
		const Index first = mesh.vertex_count();
		both.faces.push_back({first + face[0], first + face[2], first + face[1]});
	}
	return both;
}

} // namespace

TEST_CASE("where two charts meet, their vertices are the same", "[seams]")
{
	// The square of two triangles, torn along its diagonal.
	const TriangleMesh torn = in_charts(unit_square(), [](const Face& face) { return face[1]; });
	REQUIRE(torn.vertex_count() == 6);
	const Seams seams = find_seams(torn);
	CHECK(seams.repeated == 2);
	CHECK(seams.vertices == std::vector<Index> {0, 1, 2, 3, 0, 2});
	const TriangleMesh sewn = sew(torn, seams);
	CHECK(same_bits(sewn.positions, unit_square().positions));
	CHECK(sewn.faces == unit_square().faces);
}

TEST_CASE("loose triangles become one surface", "[seams]")
{
	const TriangleMesh loose = make_loose_triangles();
	const TriangleMesh sewn = sew(loose, find_seams(loose));
	const EdgeDefects edges = edge_defects(sewn);
	CHECK(sewn.vertex_count() == sewn.face_count() / 2 + 2);
	CHECK(edges.non_manifold == 0);
	CHECK(std::count(edges.boundary.begin(), edges.boundary.end(), 1) == 0);
}

TEST_CASE("what has no seam stays as it is", "[seams]")
{
	for (const TriangleMesh& mesh :
		 {make_part(600), make_height_field(600), make_thin_plate(600)}) {
		const Seams seams = find_seams(mesh);
		CHECK(seams.repeated == 0);
		CHECK(seams.vertices.empty());
		const TriangleMesh sewn = sew(mesh, seams);
		CHECK(same_bits(sewn.positions, mesh.positions));
		CHECK(sewn.faces == mesh.faces);
	}
}

TEST_CASE("vertices at one place that no open edge joins stay apart", "[seams]")
{
	SECTION("two triangles that touch in a corner")
	{
		TriangleMesh mesh;
		mesh.positions = {
			Point(0, 0, 0),
			Point(1, 0, 0),
			Point(0, 1, 0),
			Point(0, 0, 0),
			Point(-1, 0, 0),
			Point(0, -1, 0)};
		mesh.faces = {{0, 1, 2}, {3, 4, 5}};
		CHECK(find_seams(mesh).repeated == 0);
	}
	SECTION("two closed bodies that share a side")
	{
		TriangleMesh mesh = tetrahedron();
		const TriangleMesh other = tetrahedron();
		for (const Point& point : other.positions)
			mesh.positions.emplace_back(point.x(), point.y(), -point.z());
		for (const Face& face : other.faces)
			mesh.faces.push_back({face[0] + 4, face[2] + 4, face[1] + 4});
		CHECK(find_seams(mesh).repeated == 0);
	}
	SECTION("the two sides of a sheet")
	{
		CHECK(find_seams(with_back(make_flat_grid(4))).repeated == 0);
	}
	SECTION("the ends of an edge without length")
	{
		TriangleMesh mesh = unit_square();
		mesh.positions[1] = mesh.positions[0];
		CHECK(find_seams(mesh).repeated == 0);
	}
}

TEST_CASE("edges of more than two charts are one edge", "[seams]")
{
	// A fin along the seam of two charts: three open edges at one place.
	TriangleMesh mesh = in_charts(unit_square(), [](const Face& face) { return face[1]; });
	mesh.positions.insert(
		mesh.positions.end(), {Point(0, 0, 0), Point(1, 1, 0), Point(0.5, 0.5, 1)});
	mesh.faces.push_back({6, 7, 8});
	const Seams seams = find_seams(mesh);
	CHECK(seams.repeated == 4);
	CHECK(edge_defects(sew(mesh, seams)).non_manifold == 1);
}

TEST_CASE("a seam is fixed where one of its vertices is", "[seams]")
{
	TriangleMesh mesh = in_charts(unit_square(), [](const Face& face) { return face[1]; });
	mesh.fixed = {0, 0, 0, 0, 0, 1};
	CHECK(sew(mesh, find_seams(mesh)).fixed == std::vector<std::uint8_t> {0, 0, 1, 0});
}

TEST_CASE("a mesh in charts is denoised as if it were whole", "[seams][denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh whole = noisy(make_part(4000), 0.2);
	const TriangleMesh split = in_octants(whole);
	REQUIRE(split.vertex_count() > whole.vertex_count() + 50);
	DenoiseOptions options;
	options.method = method;
	// Seams are no boundary.
	options.keep_boundary = true;
	const DenoiseResult expected = denoised(whole, options);
	const DenoiseResult result = denoised(split, options);
	CHECK(expected.seam_vertices == 0);
	CHECK(result.seam_vertices == split.vertex_count() - whole.vertex_count());
	REQUIRE(result.positions.size() == split.positions.size());
	for (std::size_t i = 0; i < whole.faces.size(); ++i) {
		for (std::size_t k = 0; k < 3; ++k)
			REQUIRE(same_bits(
				result.positions[at(split.faces[i][k])],
				expected.positions[at(whole.faces[i][k])]));
	}
}

TEST_CASE("the sides of a sheet do not hold each other", "[seams][denoise]")
{
	const TriangleMesh sheet = noisy(make_flat_grid(40), 0.2);
	const DenoiseResult alone = denoised(sheet, {});
	const DenoiseResult both = denoised(with_back(sheet), {});
	const std::vector<Point> front(
		both.positions.begin(),
		both.positions.begin() + static_cast<std::ptrdiff_t>(sheet.positions.size()));
	CHECK(
		largest_distance(front, alone.positions) <
		0.01 * mean_edge_length(sheet.positions, sheet.faces));
}
