// SPDX-License-Identifier: GPL-3.0-or-later
#include "numbering.h"

#include "shapes.h"
#include "step_fixture.h"
#include "test_support.h"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cstdlib>
#include <map>
#include <numeric>
#include <random>
#include <vector>

using namespace orthopoly;

namespace {

bool is_permutation(std::vector<Index> numbers, Index count)
{
	std::sort(numbers.begin(), numbers.end());
	std::vector<Index> expected(static_cast<std::size_t>(count));
	std::iota(expected.begin(), expected.end(), Index(0));
	return numbers == expected;
}

Numbering numbered(const TriangleMesh& mesh, int threads = 1)
{
	Progress silent;
	Execution execution(threads, silent);
	return number_by_place(mesh, execution);
}

// The same mesh with its faces and vertices in another order.
TriangleMesh shuffled(const TriangleMesh& mesh)
{
	Numbering numbering = same_numbering(mesh);
	std::mt19937 generator(3);
	std::shuffle(numbering.faces.begin(), numbering.faces.end(), generator);
	std::shuffle(numbering.vertices.begin(), numbering.vertices.end(), generator);
	return renumbered(mesh, numbering, Point::Zero());
}

} // namespace

TEST_CASE("The Hilbert curve goes through every cell, one step at a time", "[numbering]")
{
	for (const int bits : {1, 2, 3, 4}) {
		CAPTURE(bits);
		const auto side = static_cast<std::uint32_t>(1 << bits);
		std::map<std::uint64_t, std::array<std::uint32_t, 3>> cells;
		for (std::uint32_t x = 0; x < side; ++x) {
			for (std::uint32_t y = 0; y < side; ++y) {
				for (std::uint32_t z = 0; z < side; ++z)
					cells[hilbert_index({x, y, z}, bits)] = {x, y, z};
			}
		}
		REQUIRE(cells.size() == side * side * side);
		CHECK(cells.begin()->first == 0);
		CHECK(cells.rbegin()->first == cells.size() - 1);
		for (std::uint64_t i = 1; i < cells.size(); ++i) {
			int steps = 0;
			for (std::size_t axis = 0; axis < 3; ++axis)
				steps += std::abs(int(cells[i][axis]) - int(cells[i - 1][axis]));
			REQUIRE(steps == 1);
		}
	}
}

TEST_CASE("A mesh numbered by place is the same mesh", "[numbering]")
{
	TriangleMesh mesh = shuffled(make_part(3000));
	mesh.fixed.assign(mesh.positions.size(), 0);
	mesh.fixed[17] = 1;
	// A vertex without a face.
	mesh.positions.emplace_back(0.1, 0.2, 0.3);
	mesh.fixed.push_back(1);
	const Numbering numbering = numbered(mesh);
	REQUIRE(is_permutation(numbering.faces, mesh.face_count()));
	REQUIRE(is_permutation(numbering.vertices, mesh.vertex_count()));
	CHECK(numbering.vertices.back() == mesh.vertex_count() - 1);
	const Point origin(1, 2, 3);
	const TriangleMesh found = renumbered(mesh, numbering, origin);
	REQUIRE(found.face_count() == mesh.face_count());
	for (std::size_t i = 0; i < found.positions.size(); ++i) {
		const auto before = static_cast<std::size_t>(numbering.vertices[i]);
		REQUIRE(found.positions[i] == mesh.positions[before] - origin);
		REQUIRE(found.fixed[i] == mesh.fixed[before]);
	}
	for (std::size_t i = 0; i < found.faces.size(); ++i) {
		for (std::size_t k = 0; k < 3; ++k)
			REQUIRE(
				numbering.vertices[static_cast<std::size_t>(found.faces[i][k])] ==
				mesh.faces[static_cast<std::size_t>(numbering.faces[i])][k]);
	}
}

TEST_CASE("The numbering does not depend on the one before, nor on the threads", "[numbering]")
{
	const TriangleMesh mesh = make_torus(30000);
	const TriangleMesh other = shuffled(mesh);
	const auto first_corners = [](const TriangleMesh& given) {
		std::vector<Point> corners;
		for (const Index i : numbered(given).faces)
			corners.push_back(given.positions[static_cast<std::size_t>(
				given.faces[static_cast<std::size_t>(i)][0])]);
		return corners;
	};
	CHECK(same_bits(first_corners(mesh), first_corners(other)));
	const Numbering numbering = numbered(mesh);
	for (const int threads : {2, 3}) {
		const Numbering found = numbered(mesh, threads);
		CHECK(found.faces == numbering.faces);
		CHECK(found.vertices == numbering.vertices);
	}
}

TEST_CASE("Neighbours are numbered close to each other", "[numbering]")
{
	const TriangleMesh mesh = shuffled(make_torus(20000));
	const TriangleMesh found = renumbered(mesh, numbered(mesh), Point::Zero());
	const auto spread = [](const TriangleMesh& given) {
		double sum = 0;
		for (const Face& face : given.faces) {
			const auto [low, high] = std::minmax_element(face.begin(), face.end());
			sum += *high - *low;
		}
		return sum / static_cast<double>(given.faces.size());
	};
	CHECK(spread(mesh) > 3000);
	CHECK(spread(found) < 300);
}

TEST_CASE("Meshes of one place or without faces have a numbering", "[numbering]")
{
	TriangleMesh point;
	point.positions.assign(3, Point(1, 1, 1));
	point.faces = {{0, 1, 2}};
	CHECK(is_permutation(numbered(point).faces, 1));
	CHECK(is_permutation(numbered(point).vertices, 3));
	point.faces.clear();
	CHECK(numbered(point).faces.empty());
	CHECK(is_permutation(numbered(point).vertices, 3));
}
