// SPDX-License-Identifier: GPL-3.0-or-later
#include "anisotropy.h"

#include "recipes.h"
#include "shapes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <vector>

using namespace orthopoly;

namespace {

// A flat grid of n by n squares, so many times as long as wide.
TriangleMesh long_grid(int n, double aspect)
{
	TriangleMesh mesh = make_flat_grid(n);
	for (Point& p : mesh.positions)
		p.x() *= aspect;
	return mesh;
}

Anisotropy anisotropy_of(const TriangleMesh& mesh, int threads = 1)
{
	const StepFixture f(mesh, threads);
	return find_anisotropy(f.workspace, mesh.positions);
}

double mean(const std::vector<double>& values)
{
	return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

} // namespace

TEST_CASE("Steady edges are what noise turns triangles by", "[anisotropy]")
{
	// Two right triangles with sides of a and 1 around each corner of a square.
	for (const double a : {1.0, 3.0, 10.0}) {
		TriangleMesh mesh = unit_square();
		for (Point& p : mesh.positions)
			p.x() *= a;
		const StepFixture f(mesh);
		for (Index i = 0; i < mesh.vertex_count(); ++i)
			CHECK(
				steady_edge_square_around(f.workspace, mesh.positions, i) ==
				Approx(4 * a * a / (2 * (a * a + 1))));
	}
}

TEST_CASE("The steady edge of equilateral triangles is their edge", "[anisotropy]")
{
	TriangleMesh mesh;
	const double height = std::sqrt(0.75);
	mesh.positions = {Point(0, 0, 0), Point(1, 0, 0), Point(0.5, height, 0), Point(9, 9, 9)};
	mesh.faces = {{0, 1, 2}};
	const StepFixture f(mesh);
	CHECK(steady_edge_square_around(f.workspace, mesh.positions, 0) == Approx(1));
	CHECK(steady_edge_square_around(f.workspace, mesh.positions, 3) == 0);
}

TEST_CASE("Triangles about as long as wide are nothing special", "[anisotropy]")
{
	for (const char* const name : {"cube", "sphere", "torus", "thin_plate"}) {
		CAPTURE(name);
		const TriangleMesh mesh = find_recipe(name).make(2000);
		for (const double sigma : {0.0, 0.1, 0.3}) {
			CAPTURE(sigma);
			const Anisotropy found = anisotropy_of(noisy(mesh, sigma));
			if (sigma == 0)
				CHECK(found.shares.empty());
			else if (!found.shares.empty())
				CHECK(mean(found.shares) < 0.02);
			CHECK(found.crowding < 1.1);
		}
	}
}

TEST_CASE("Long thin triangles are found, noisy ones too", "[anisotropy]")
{
	for (const double sigma : {0.0, 0.1, 0.3}) {
		CAPTURE(sigma);
		const TriangleMesh mesh = noisy(find_recipe("scan_lines").make(4000), sigma);
		const Anisotropy found = anisotropy_of(mesh);
		REQUIRE(found.shares.size() == mesh.positions.size());
		CHECK(mean(found.shares) > 0.9);
		CHECK(found.crowding > 2);
		CHECK(*std::min_element(found.shares.begin(), found.shares.end()) >= 0);
		CHECK(*std::max_element(found.shares.begin(), found.shares.end()) <= 1);
	}
}

TEST_CASE("A place has the vertices along the short edges", "[anisotropy]")
{
	const int n = 30;
	const TriangleMesh mesh = long_grid(n, 10);
	const Anisotropy found = anisotropy_of(mesh);
	REQUIRE(found.shares.size() == mesh.positions.size());
	// In the middle, mean edge lengths are (10 + 1 + sqrt(101)) / 3 widths of a square: half of
	// that is three widths and a half.
	const double width = 1.0 / n;
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		const Point& here = mesh.positions[i];
		const bool in_the_middle = std::abs(here.y() - 0.5) < 0.3 && std::abs(here.x() - 5) < 3;
		if (!in_the_middle)
			continue;
		const std::vector<Index> place = list(found.nearby, static_cast<Index>(i));
		REQUIRE(place.size() == 6);
		CHECK(std::is_sorted(place.begin(), place.end()));
		for (const Index other : place) {
			const Point way = mesh.positions[at(other)] - here;
			CHECK(std::abs(way.x()) < 0.5 * width);
			CHECK(std::abs(way.y()) < 3.5 * width);
			CHECK(std::abs(way.y()) > 0.5 * width);
		}
	}
}

TEST_CASE("What is long and thin does not depend on size or threads", "[anisotropy]")
{
	const TriangleMesh mesh = noisy(find_recipe("scan_lines").make(2000), 0.1);
	const Anisotropy found = anisotropy_of(mesh);
	const Anisotropy on_four = anisotropy_of(mesh, 4);
	CHECK(on_four.shares == found.shares);
	CHECK(on_four.nearby.values == found.nearby.values);
	CHECK(on_four.nearby.offsets == found.nearby.offsets);
	CHECK(same_bits(on_four.smoothed, found.smoothed));

	const Anisotropy larger = anisotropy_of(placed(mesh, 1024));
	CHECK(larger.shares == found.shares);
	CHECK(larger.nearby.values == found.nearby.values);
}

TEST_CASE("Coincident vertices and empty meshes have places too", "[anisotropy]")
{
	CHECK(anisotropy_of(TriangleMesh()).shares.empty());
	TriangleMesh mesh = long_grid(10, 10);
	// All in one place, but for a row.
	for (Point& p : mesh.positions) {
		if (p.y() < 0.95)
			p = Point::Zero();
	}
	const Anisotropy found = anisotropy_of(mesh);
	for (const double share : found.shares)
		CHECK((share >= 0 && share <= 1));
	CHECK(all_finite(found.smoothed));
}
