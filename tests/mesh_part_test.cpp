// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_part.h"

#include "method_support.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace orthopoly;

namespace {

MeshPart places_of(const TriangleMesh& mesh)
{
	return cut_out_places(StepFixture(mesh).workspace);
}

std::size_t inner_count(const MeshPart& part)
{
	return static_cast<std::size_t>(std::count(part.inner.begin(), part.inner.end(), 1));
}

} // namespace

TEST_CASE("Places are parts of the mesh, their inner vertices far from the cut", "[mesh_part]")
{
	const TriangleMesh mesh = noisy(make_torus(200000), 0.1);
	const MeshPart part = places_of(mesh);
	CHECK_NOTHROW(validate(part.mesh));
	CHECK(part.mesh.face_count() > 10000);
	CHECK(part.mesh.face_count() < 120000);
	CHECK(inner_count(part) > 2000);
	CHECK(inner_count(part) < part.mesh.positions.size() / 2);
	// The torus is closed: all boundary vertices are on the cut.
	const StepFixture f(part.mesh);
	std::vector<double> from_cut(part.mesh.positions.size(), 0);
	for (Index i = 0; i < part.mesh.vertex_count(); ++i)
		from_cut[at(i)] = f.workspace.edges.irregular[at(i)] != 0 ? 0 : 12;
	for (int ring = 0; ring < 11; ++ring) {
		const std::vector<double> before = from_cut;
		for (const Face& face : part.mesh.faces) {
			for (const Index a : face) {
				for (const Index b : face)
					from_cut[at(a)] = std::min(from_cut[at(a)], before[at(b)] + 1);
			}
		}
	}
	for (std::size_t i = 0; i < part.inner.size(); ++i) {
		if (part.inner[i] != 0)
			REQUIRE(from_cut[i] > 10);
	}
	// All of a small mesh, nothing of which is cut.
	const TriangleMesh small = noisy(make_sphere(500), 0.1);
	CHECK(places_of(small).mesh.faces.size() == small.faces.size());
	CHECK(inner_count(places_of(small)) == small.positions.size());
}

TEST_CASE("Places are the same ones however a mesh is numbered", "[mesh_part]")
{
	const auto with_fixed = [](TriangleMesh mesh) {
		for (const Point& position : mesh.positions)
			mesh.fixed.push_back(position.x() > 0.5 ? 1 : 0);
		return mesh;
	};
	const TriangleMesh mesh = noisy(make_torus(120000), 0.1);
	const MeshPart here = places_of(with_fixed(mesh));
	MeshPart there = places_of(with_fixed(Renumbered(mesh).mesh));
	CHECK(here.mesh.faces.size() == there.mesh.faces.size());
	CHECK(inner_count(here) == inner_count(there));
	std::vector<Point> positions = here.mesh.positions;
	std::sort(positions.begin(), positions.end(), comes_before);
	std::sort(there.mesh.positions.begin(), there.mesh.positions.end(), comes_before);
	CHECK(positions == there.mesh.positions);
	CHECK(here.mesh.fixed.size() == here.mesh.positions.size());
	for (std::size_t i = 0; i < here.mesh.fixed.size(); ++i)
		REQUIRE((here.mesh.fixed[i] != 0) == (here.mesh.positions[i].x() > 0.5));
	// Values at the vertices go along.
	std::vector<double> heights;
	for (const Point& position : mesh.positions)
		heights.push_back(position.z());
	const std::vector<double> own = here.values_of(heights);
	REQUIRE(own.size() == here.mesh.positions.size());
	for (std::size_t i = 0; i < own.size(); ++i)
		REQUIRE(own[i] == here.mesh.positions[i].z());
	CHECK(here.values_of({}).empty());
}
