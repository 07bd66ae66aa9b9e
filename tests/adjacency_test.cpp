// SPDX-License-Identifier: GPL-3.0-or-later
#include "adjacency.h"

#include "defects.h"
#include "recipes.h"
#include "shapes.h"
#include "test_support.h"

#include <algorithm>
#include <cstdint>
#include <set>
#include <vector>

using namespace orthopoly;

namespace {

std::vector<Index> list(const IndexSpan& span)
{
	return {span.begin(), span.end()};
}

bool share_vertex(const Face& a, const Face& b)
{
	return std::any_of(a.begin(), a.end(), [&](Index vertex) {
		return std::find(b.begin(), b.end(), vertex) != b.end();
	});
}

// A mesh of vertices that lie nowhere in particular.
TriangleMesh with_faces(std::size_t vertex_count, const std::vector<Face>& faces)
{
	TriangleMesh mesh;
	mesh.positions.resize(vertex_count, Point::Zero());
	mesh.faces = faces;
	return mesh;
}

} // namespace

TEST_CASE("faces around the vertices of a square", "[adjacency]")
{
	const TriangleMesh mesh = unit_square();
	const IndexLists around = vertex_faces(mesh.vertex_count(), mesh.faces);
	CHECK(list(around, 0) == std::vector<Index> {0, 1});
	CHECK(list(around, 1) == std::vector<Index> {0});
	CHECK(list(around, 2) == std::vector<Index> {0, 1});
	CHECK(list(around, 3) == std::vector<Index> {1});
	CHECK(around.size(3) == 1);
}

TEST_CASE("a face that names a vertex twice is around it once", "[adjacency]")
{
	const std::vector<Face> faces = {{0, 0, 1}, {0, 1, 0}, {1, 0, 0}, {1, 1, 1}};
	const IndexLists around = vertex_faces(3, faces);
	CHECK(list(around, 0) == std::vector<Index> {0, 1, 2});
	CHECK(list(around, 1) == std::vector<Index> {0, 1, 2, 3});
	CHECK(around.size(2) == 0);
}

TEST_CASE("the first ring is the faces that share a vertex", "[adjacency]")
{
	for (const Recipe& recipe : recipes()) {
		CAPTURE(recipe.name);
		const TriangleMesh mesh = recipe.make(300);
		if (mesh.face_count() > 1000)
			continue;
		const IndexLists around = vertex_faces(mesh.vertex_count(), mesh.faces);
		RingCollector rings(mesh.faces, around);
		for (Index i = 0; i < mesh.face_count(); ++i) {
			std::set<Index> expected = {i};
			for (Index j = 0; j < mesh.face_count(); ++j) {
				if (share_vertex(
						mesh.faces[static_cast<std::size_t>(i)],
						mesh.faces[static_cast<std::size_t>(j)]))
					expected.insert(j);
			}
			rings.collect(i, 1);
			REQUIRE(std::set<Index>(rings.faces().begin(), rings.faces().end()) == expected);
			REQUIRE(rings.faces().size() == expected.size());
		}
	}
}

TEST_CASE("rings around a vertex where very many faces meet are no burden", "[adjacency]")
{
	// Neighbour lists of such a fan would have as many entries as faces squared: 10^10.
	constexpr Index FACES = 100000;
	std::vector<Face> fan;
	for (Index i = 0; i < FACES; ++i)
		fan.push_back({0, 1 + i, 1 + (i + 1) % FACES});
	const IndexLists around = vertex_faces(FACES + 1, fan);
	RingCollector rings(fan, around);
	rings.collect(17, 3);
	CHECK(rings.faces().size() == fan.size());
	CHECK(rings.count_within(1) == fan.size());
}

TEST_CASE("the boundary of an open mesh", "[adjacency]")
{
	CHECK(edge_defects(unit_square()).boundary == std::vector<std::uint8_t> {1, 1, 1, 1});
	CHECK(edge_defects(tetrahedron()).boundary == std::vector<std::uint8_t> {0, 0, 0, 0});
	// Four squares around an inner vertex.
	const std::vector<Face> grid = {
		{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {3, 4, 7}, {3, 7, 6}, {4, 5, 8}, {4, 8, 7}};
	CHECK(
		edge_defects(with_faces(9, grid)).boundary ==
		std::vector<std::uint8_t> {1, 1, 1, 1, 0, 1, 1, 1, 1});
}

TEST_CASE("an edge of three faces is no boundary, but as irregular as one", "[adjacency]")
{
	const EdgeDefects defects = edge_defects(make_non_manifold_edge());
	// Seven vertices along the foot of the fin, seven along its top, the ends of both on the
	// boundary.
	CHECK(std::count(defects.irregular.begin(), defects.irregular.end(), 1) == 14);
	CHECK(std::count(defects.boundary.begin(), defects.boundary.end(), 1) == 9);
	TriangleMesh twice = tetrahedron();
	twice.faces.insert(twice.faces.end(), twice.faces.begin(), twice.faces.end());
	CHECK(edge_defects(twice).boundary == std::vector<std::uint8_t> {0, 0, 0, 0});
	CHECK(edge_defects(twice).irregular == std::vector<std::uint8_t> {1, 1, 1, 1});
}

TEST_CASE("a face that names a vertex twice makes no edge irregular", "[adjacency]")
{
	TriangleMesh mesh = tetrahedron();
	mesh.faces.push_back({0, 0, 1});
	mesh.faces.push_back({2, 3, 2});
	mesh.faces.push_back({1, 1, 1});
	const EdgeDefects defects = edge_defects(mesh);
	CHECK(defects.non_manifold == 0);
	CHECK(defects.boundary == std::vector<std::uint8_t> {0, 0, 0, 0});
	CHECK(defects.irregular == std::vector<std::uint8_t> {0, 0, 0, 0});
}

TEST_CASE("non-manifold edges are counted", "[adjacency]")
{
	CHECK(edge_defects(make_part(2000)).non_manifold == 0);
	CHECK(edge_defects(unit_square()).non_manifold == 0);
	CHECK(edge_defects(make_non_manifold_edge()).non_manifold == 6);
	// Two faces that run along their common edge the same way.
	CHECK(edge_defects(with_faces(4, {{0, 1, 2}, {0, 1, 3}})).non_manifold == 1);
	CHECK(edge_defects(with_faces(4, {{0, 1, 2}, {1, 0, 3}})).non_manifold == 0);
	CHECK(edge_defects({}).non_manifold == 0);
}

TEST_CASE("rings grow one step at a time around a face", "[adjacency]")
{
	const TriangleMesh mesh = make_torus(2000);
	const IndexLists around = vertex_faces(mesh.vertex_count(), mesh.faces);
	RingCollector rings(mesh.faces, around);
	for (const Index seed : {0, 17, 1200}) {
		rings.collect(seed, 3);
		// Every inner face of a grid of valence six has twelve neighbours.
		CHECK(rings.count_within(0) == 1);
		CHECK(rings.count_within(1) == 13);
		CHECK(rings.count_within(2) == 37);
		CHECK(rings.count_within(3) == 73);
		REQUIRE(rings.faces().size() == 73);
		CHECK(rings.faces().front() == seed);
		const std::set<Index> different(rings.faces().begin(), rings.faces().end());
		CHECK(different.size() == 73);
		// A face of ring k touches one of ring k - 1.
		for (std::size_t ring = 1; ring <= 3; ++ring) {
			for (std::size_t i = rings.count_within(static_cast<int>(ring) - 1);
				 i < rings.count_within(static_cast<int>(ring));
				 ++i) {
				const auto inner_end =
					rings.faces().begin() +
					static_cast<std::ptrdiff_t>(rings.count_within(static_cast<int>(ring) - 1));
				CHECK(std::any_of(rings.faces().begin(), inner_end, [&](Index inner) {
					return share_vertex(
						mesh.faces[static_cast<std::size_t>(inner)],
						mesh.faces[static_cast<std::size_t>(rings.faces()[i])]);
				}));
			}
		}
	}
}

TEST_CASE("growing a ring is collecting one more", "[adjacency]")
{
	const TriangleMesh mesh = make_height_field(500);
	const IndexLists around = vertex_faces(mesh.vertex_count(), mesh.faces);
	RingCollector grown(mesh.faces, around);
	RingCollector collected(mesh.faces, around);
	grown.collect(100, 0);
	CHECK(list(grown.faces()) == std::vector<Index> {100});
	for (int ring = 1; ring < 6; ++ring) {
		grown.grow();
		collected.collect(100, ring);
		CHECK(list(grown.faces()) == list(collected.faces()));
	}
}

TEST_CASE("rings stop at the end of a component", "[adjacency]")
{
	const TriangleMesh mesh = make_isolated_face();
	const IndexLists around = vertex_faces(mesh.vertex_count(), mesh.faces);
	RingCollector rings(mesh.faces, around);
	rings.collect(mesh.face_count() - 1, 4);
	REQUIRE(rings.faces().size() == 1);
	CHECK(rings.faces().front() == mesh.face_count() - 1);
	CHECK(rings.count_within(4) == 1);
	rings.collect(0, 50);
	CHECK(static_cast<Index>(rings.faces().size()) == mesh.face_count() - 1);
}

TEST_CASE("components are numbered by their first faces", "[adjacency]")
{
	// Two triangles that share a vertex, one by itself, and a vertex without a face.
	const std::vector<Face> faces = {{4, 5, 6}, {0, 1, 2}, {2, 3, 8}};
	const Components components = number_components(faces, vertex_faces(9, faces));
	CHECK(components.count == 2);
	CHECK(components.numbers == std::vector<Index> {1, 1, 1, 1, 0, 0, 0, -1, 1});
	CHECK(number_components({}, vertex_faces(2, {})).numbers == std::vector<Index> {-1, -1});
}
