// SPDX-License-Identifier: GPL-3.0-or-later
#include "similar_structures.h"

#include "guide_direction.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <map>

using namespace orthopoly;

namespace {

// A strip of triangles along x: face i shares vertices with faces i - 2 to i + 2 only.
TriangleMesh make_strip(int faces)
{
	TriangleMesh mesh;
	for (int i = 0; i < faces + 2; ++i)
		mesh.positions.emplace_back(i, i % 2, 0.0);
	for (int i = 0; i < faces; ++i) {
		if (i % 2 == 0)
			mesh.faces.push_back({i, i + 2, i + 1});
		else
			mesh.faces.push_back({i, i + 1, i + 2});
	}
	return mesh;
}

Point tilted_to_x(double degrees)
{
	return Point(std::sin(degrees * DEGREE), 0, std::cos(degrees * DEGREE));
}

} // namespace

TEST_CASE("Isotropic structures by hand", "[similar_structures]")
{
	const StepFixture f(make_strip(7));
	std::vector<Point> normals(7, tilted_to_x(0));
	normals[2] = tilted_to_x(50);
	normals[3] = tilted_to_x(30);
	normals[4] = Point::Zero();
	std::vector<Point> guides(7, tilted_to_x(0));
	guides[4] = Point::Zero();
	guides[6] = tilted_to_x(40);
	SimilarStructureOptions options;
	options.cos_threshold = std::cos(45 * std::acos(-1.0) / 180);
	const IndexLists found = isotropic_structures(f.workspace, normals, guides, options);
	CHECK(list(found, 0) == std::vector<Index> {0, 1}); // 2 is 50 degrees away
	CHECK(list(found, 1) == std::vector<Index> {1, 0, 3});
	CHECK(list(found, 2) == std::vector<Index> {0, 1, 3}); // not itself
	CHECK(list(found, 3) == std::vector<Index> {3, 1, 5}); // neither 2 nor 4
	CHECK(list(found, 4).empty());                         // no guide
	CHECK(list(found, 5) == std::vector<Index> {5, 3, 6});
	CHECK(list(found, 6) == std::vector<Index> {6, 5});

	SECTION("a wider ring takes in more, the nearest first")
	{
		options.local_ring = 2;
		const IndexLists wider = isotropic_structures(f.workspace, normals, guides, options);
		CHECK(list(wider, 1) == std::vector<Index> {1, 0, 3, 5});
	}
	SECTION("a threshold below zero lets in all but faces without a normal")
	{
		options.cos_threshold = -0.5;
		const IndexLists all = isotropic_structures(f.workspace, normals, guides, options);
		CHECK(list(all, 3) == std::vector<Index> {3, 1, 2, 5});
		CHECK(list(all, 4).empty());
	}
	SECTION("the cosine has to be above the threshold, not at it")
	{
		options.cos_threshold = 1;
		const IndexLists none = isotropic_structures(
			f.workspace,
			std::vector<Point>(7, tilted_to_x(0)),
			std::vector<Point>(7, tilted_to_x(0)),
			options);
		CHECK(none.values.empty());
	}
}

TEST_CASE("Non-local structures by hand", "[similar_structures]")
{
	const StepFixture f(make_strip(7));
	const std::vector<Point> normals(7, tilted_to_x(0));
	std::vector<Point> guides = {
		tilted_to_x(5),
		tilted_to_x(10),
		tilted_to_x(0),
		tilted_to_x(2),
		tilted_to_x(60),
		tilted_to_x(0),
		tilted_to_x(0)};
	SimilarStructureOptions options;
	options.cos_threshold = std::cos(45 * std::acos(-1.0) / 180);
	const IndexLists isotropic = isotropic_structures(f.workspace, normals, guides, options);
	REQUIRE(list(isotropic, 4).empty());

	SimilarStructures structures(f.workspace, guides, isotropic, options);
	structures.collect(2);
	// Within two rings of face 2 are all seven. By similarity: 2, 5 and 6 (equal, so by index), 3,
	// 0, 1; not 4, 60 degrees away.
	const std::vector<Index> order = {2, 5, 6, 3, 0, 1};
	std::vector<Index> expected;
	for (const Index l : order) {
		const std::vector<Index> members = list(isotropic, l);
		expected.insert(expected.end(), members.begin(), members.end());
	}
	CHECK(structures.faces() == expected);
	CHECK(std::count(expected.begin(), expected.end(), 2) > 1);

	SECTION("a narrower ring")
	{
		options.search_ring = 1;
		SimilarStructures narrow(f.workspace, guides, isotropic, options);
		narrow.collect(6);
		// Faces 4, 5, 6; 5 and 6 are similar.
		std::vector<Index> both = list(isotropic, 5);
		const std::vector<Index> sixth = list(isotropic, 6);
		both.insert(both.end(), sixth.begin(), sixth.end());
		CHECK(narrow.faces() == both);
	}
	SECTION("a face without a guide direction has none")
	{
		guides[3] = Point::Zero();
		SimilarStructures without(f.workspace, guides, isotropic, options);
		without.collect(3);
		CHECK(without.faces().empty());
	}
}

TEST_CASE("On a plane every structure of the ring is repeated in full", "[similar_structures]")
{
	const StepFixture f(make_flat_grid(12));
	const SimilarStructureOptions options;
	const IndexLists isotropic =
		isotropic_structures(f.workspace, f.geometry.normals, f.geometry.normals, options);
	SimilarStructures structures(f.workspace, f.geometry.normals, isotropic, options);
	const Index middle = 2 * (6 * 12 + 6);
	structures.collect(middle);
	// A face of this grid has 13 faces in its 1-ring and 37 in its 2-ring.
	CHECK(isotropic.size(middle) == 13);
	CHECK(structures.faces().size() == 481); // 37 times 13
	std::map<Index, int> repetitions;
	for (const Index face : structures.faces())
		++repetitions[face];
	CHECK(repetitions.size() == 73);
	CHECK(repetitions[middle] == 13);
}

TEST_CASE("Structures do not reach across the edges of a cube", "[similar_structures]")
{
	const StepFixture f(make_cube(3000));
	const std::vector<Point>& normals = f.geometry.normals;
	const std::vector<Point> guides = guide_directions(f.workspace, f.geometry, {});
	const SimilarStructureOptions options;
	const IndexLists isotropic = isotropic_structures(f.workspace, normals, guides, options);
	SimilarStructures structures(f.workspace, guides, isotropic, options);
	std::size_t strangers = 0;
	for (Index i = 0; i < f.mesh.face_count(); ++i) {
		structures.collect(i);
		REQUIRE(structures.faces().size() >= static_cast<std::size_t>(isotropic.size(i)));
		for (const Index j : structures.faces()) {
			const double cosine =
				normals[static_cast<std::size_t>(i)].dot(normals[static_cast<std::size_t>(j)]);
			strangers += cosine > 0.999 ? 0U : 1U;
		}
	}
	CHECK(strangers == 0);
}

TEST_CASE("A vertex with a thousand faces does not make endless structures", "[similar_structures]")
{
	constexpr int COUNT = 1000;
	TriangleMesh fan;
	fan.positions.emplace_back(0, 0, 0);
	for (int i = 0; i < COUNT; ++i) {
		const double angle = 2 * std::acos(-1.0) * i / COUNT;
		fan.positions.emplace_back(std::cos(angle), std::sin(angle), 0);
	}
	for (int i = 0; i < COUNT; ++i)
		fan.faces.push_back({0, 1 + i, 1 + (i + 1) % COUNT});
	const StepFixture f(fan);
	const SimilarStructureOptions options;
	const IndexLists isotropic =
		isotropic_structures(f.workspace, f.geometry.normals, f.geometry.normals, options);
	REQUIRE(isotropic.size(0) == COUNT);
	SimilarStructures structures(f.workspace, f.geometry.normals, isotropic, options);
	structures.collect(17);
	CHECK(structures.faces().size() >= SimilarStructures::MAX_ROWS);
	CHECK(structures.faces().size() < SimilarStructures::MAX_ROWS + COUNT);
	CHECK(structures.faces().size() % COUNT == 0);
}

TEST_CASE("Structures are the same on any number of threads", "[similar_structures][parallel]")
{
	const TriangleMesh mesh = noisy(make_torus(5000), 0.2);
	const StepFixture one(mesh, 1);
	const SimilarStructureOptions options;
	const IndexLists expected =
		isotropic_structures(one.workspace, one.geometry.normals, one.geometry.normals, options);
	for (const int threads : {2, 4}) {
		const StepFixture several(mesh, threads);
		const IndexLists found = isotropic_structures(
			several.workspace, several.geometry.normals, several.geometry.normals, options);
		CHECK(found.offsets == expected.offsets);
		CHECK(found.values == expected.values);
	}
}
