// SPDX-License-Identifier: GPL-3.0-or-later
#include "patch.h"

#include "anisotropy.h"
#include "recipes.h"
#include "shapes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <vector>

using namespace orthopoly;

namespace {

// The mesh's numbers of what lies within a ring.
std::set<Index> within(const IndexSpan& faces, std::size_t count, const std::vector<Index>& numbers)
{
	std::set<Index> result;
	for (std::size_t k = 0; k < count; ++k)
		result.insert(numbers.empty() ? faces[k] : numbers[at(faces[k])]);
	return result;
}

void check_rings(const Workspace& workspace, int rings)
{
	RingCollector expected = workspace.ring_collector();
	Patch patch;
	Index own = 0;
	for (Index number = 0; number < Patch::count(workspace); ++number) {
		patch.build(workspace, number, rings);
		CAPTURE(number);
		for (std::size_t i = 0; i < patch.faces().size(); ++i) {
			for (std::size_t k = 0; k < 3; ++k)
				REQUIRE(
					patch.mesh_vertices()[at(patch.faces()[i][k])] ==
					workspace.mesh.faces[at(patch.mesh_faces()[i])][k]);
		}
		for (Index face = 0; face < patch.own_faces(); ++face, ++own) {
			REQUIRE(patch.mesh_faces()[at(face)] == own);
			// Every other time twice, since the first leaves its marks.
			for (int time = 0; time <= face % 2; ++time)
				patch.collect(face, rings);
			expected.collect(own, rings);
			for (int ring = 0; ring <= rings; ++ring) {
				REQUIRE(patch.count_within(ring) == expected.count_within(ring));
				REQUIRE(
					within(patch.collected(), patch.count_within(ring), patch.mesh_faces()) ==
					within(expected.faces(), expected.count_within(ring), {}));
			}
		}
	}
	CHECK(own == workspace.mesh.face_count());
}

// The same where vertices are one place with others.
void check_rings_of_places(const Workspace& workspace, const IndexLists& nearby, int rings)
{
	Patch patch;
	Index own = 0;
	for (Index number = 0; number < Patch::count(workspace); ++number) {
		patch.build(workspace, number, rings, &nearby);
		CAPTURE(number);
		for (Index face = 0; face < patch.own_faces(); ++face, ++own) {
			patch.collect(face, rings);
			std::set<Index> expected = {own};
			for (int ring = 0; ring <= rings; ++ring) {
				REQUIRE(
					within(patch.collected(), patch.count_within(ring), patch.mesh_faces()) ==
					expected);
				std::set<Index> next = expected;
				const auto add_faces_around = [&](Index vertex) {
					for (const Index other : list(workspace.vertex_faces, vertex))
						next.insert(other);
				};
				for (const Index member : expected) {
					for (const Index vertex : workspace.mesh.faces[at(member)]) {
						add_faces_around(vertex);
						for (const Index other : list(nearby, vertex))
							add_faces_around(other);
					}
				}
				expected = next;
			}
		}
	}
	CHECK(own == workspace.mesh.face_count());
}

// The vertices of the faces collected, each where the first face has it.
void check_vertices(const Workspace& workspace, int rings)
{
	Patch patch;
	for (Index number = 0; number < Patch::count(workspace); ++number) {
		patch.build(workspace, number, rings);
		CAPTURE(number);
		for (Index face = 0; face < patch.own_faces(); face += 7) {
			patch.collect(face, rings);
			std::vector<Index> expected;
			std::vector<std::size_t> ends;
			for (int ring = 0; ring <= rings; ++ring) {
				for (std::size_t k = ring > 0 ? patch.count_within(ring - 1) : 0;
					 k < patch.count_within(ring);
					 ++k) {
					for (const Index vertex : patch.faces()[at(patch.collected()[k])]) {
						if (std::find(expected.begin(), expected.end(), vertex) == expected.end())
							expected.push_back(vertex);
					}
				}
				ends.push_back(expected.size());
			}
			const IndexSpan found = patch.collect_vertices();
			REQUIRE(std::vector<Index>(found.begin(), found.end()) == expected);
			for (int ring = 0; ring <= rings; ++ring)
				REQUIRE(patch.vertex_count_within(ring) == ends[at(ring)]);
		}
	}
}

template<class Check>
void on_small_meshes(Check check)
{
	for (const Recipe& recipe : recipes()) {
		CAPTURE(recipe.name);
		const TriangleMesh mesh = recipe.make(1200);
		if (mesh.face_count() > 3000)
			continue;
		check(StepFixture(mesh).workspace);
	}
}

} // namespace

TEST_CASE("Rings inside a patch are those of the mesh", "[patch]")
{
	on_small_meshes([](const Workspace& workspace) { check_rings(workspace, 3); });
}

TEST_CASE("The vertices of a collection are those of its faces", "[patch]")
{
	on_small_meshes([](const Workspace& workspace) {
		for (const int rings : {0, 3})
			check_vertices(workspace, rings);
	});
}

TEST_CASE("Patches of a mesh that is cut up keep their surroundings", "[patch]")
{
	const StepFixture f(make_torus(3 * Patch::OWN_FACES));
	CHECK(Patch::count(f.workspace) > 2);
	check_rings(f.workspace, 2);
}

TEST_CASE("A ring has the faces around all vertices of a place", "[patch]")
{
	for (const char* const name : {"scan_lines", "part"}) {
		CAPTURE(name);
		// More than a patch, so that places reach from one into the next.
		const StepFixture f(find_recipe(name).make(Patch::OWN_FACES + 900));
		const Anisotropy found = find_anisotropy(f.workspace, f.mesh.positions);
		REQUIRE_FALSE(found.shares.empty());
		check_rings_of_places(f.workspace, found.nearby, 2);
	}
}

TEST_CASE("More faces may meet in a vertex than a patch takes at once", "[patch]")
{
	TriangleMesh fan;
	fan.positions.emplace_back(0, 0, 1);
	const Index rim = 37;
	for (Index i = 0; i < rim; ++i) {
		fan.positions.emplace_back(std::cos(i), std::sin(i), 0);
		fan.faces.push_back({0, 1 + i, 1 + (i + 1) % rim});
	}
	const StepFixture f(fan);
	check_rings(f.workspace, 2);
}
