// SPDX-License-Identifier: GPL-3.0-or-later
#include "ambiguity.h"

#include "shapes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

constexpr double DEGREE = 3.14159265358979323846 / 180;

// A sheet of 2n by n squares of side 1, bent by an angle along the middle (x = 0).
TriangleMesh bent_sheet(int n, double angle)
{
	TriangleMesh mesh = make_flat_grid(2 * n);
	mesh.positions = each(mesh.positions, [&](const Point& p) {
		const double x = 2 * n * p.x() - n;
		const Point flat(x, 2 * n * p.y(), 0);
		return x <= 0 ? flat : Point(x * std::cos(angle), flat.y(), -x * std::sin(angle));
	});
	return mesh;
}

std::vector<LocalAmbiguity> measured(const StepFixture& f)
{
	return measure_ambiguity(f.workspace, f.geometry.normals, f.geometry.areas);
}

double largest(const std::vector<LocalAmbiguity>& all)
{
	double result = 0;
	for (const LocalAmbiguity& local : all)
		result = std::max(result, local.ambiguity);
	return result;
}

} // namespace

TEST_CASE("Nothing is ambiguous on a plane or at a sharp edge", "[ambiguity]")
{
	CHECK(largest(measured(StepFixture(make_flat_grid(10)))) == 0);
	CHECK(largest(measured(StepFixture(make_box({8, 8, 8}, Point(1, 1, 1))))) < 1e-12);
	for (const double angle : {60.1, 75.0, 90.0, 120.0}) {
		CAPTURE(angle);
		CHECK(largest(measured(StepFixture(bent_sheet(6, angle * DEGREE)))) < 0.02);
	}
}

TEST_CASE("A bend between flat and sharp is ambiguous, and only near it", "[ambiguity]")
{
	const StepFixture f(bent_sheet(6, 45 * DEGREE));
	const std::vector<LocalAmbiguity> found = measured(f);
	for (std::size_t i = 0; i < found.size(); ++i) {
		double nearest = 1e9;
		bool inside = true;
		for (const Index corner : f.mesh.faces[i]) {
			const Point& p = f.mesh.positions[static_cast<std::size_t>(corner)];
			nearest = std::min(nearest, std::abs(p.x()));
			inside = inside && p.y() > 1.5 && p.y() < 10.5;
		}
		CAPTURE(i, nearest);
		// Along the bend nearly half of those around are on the other side, two rows away none.
		if (nearest < 1e-9 && inside)
			CHECK(found[i].ambiguity > 0.3);
		if (nearest > 1.5)
			CHECK(found[i].ambiguity < 1e-12);
	}
}

TEST_CASE("The bend halfway in the cosine is the most ambiguous", "[ambiguity]")
{
	double before = 0;
	for (const double angle : {5.0, 15.0, 25.0, 35.0, std::acos(0.75) / DEGREE}) {
		const double now = largest(measured(StepFixture(bent_sheet(6, angle * DEGREE))));
		CHECK(now > 1.05 * before);
		before = now;
	}
	for (const double angle : {48.0, 54.0, 58.0, 60.0}) {
		const double now = largest(measured(StepFixture(bent_sheet(6, angle * DEGREE))));
		CHECK(now < 0.97 * before);
		before = now;
	}
	// A gentle bend of three degrees is a curved surface, not a feature.
	CHECK(largest(measured(StepFixture(bent_sheet(6, 3 * DEGREE)))) < 0.01);
}

TEST_CASE("It is the doubt of each pair, averaged over the 2-ring", "[ambiguity]")
{
	// All faces of a box of twelve triangles are within two rings of each other.
	const StepFixture f(make_box({1, 1, 1}, Point(1, 1, 1)));
	std::vector<Point> normals(12, Point(0, 0, 1));
	normals[5] = Point(0, std::sqrt(1 - 0.75 * 0.75), 0.75);
	normals[8] = Point(1, 0, 0);
	std::vector<double> areas(12, 1.0);
	areas[3] = 13;
	const std::vector<LocalAmbiguity> found = measure_ambiguity(f.workspace, normals, areas);
	CHECK(found[0].ambiguity == Approx(1.0 / 12));
	CHECK(found[5].ambiguity == Approx(10.0 / 12));
	CHECK(found[8].ambiguity == Approx(0).margin(1e-15));
	for (const LocalAmbiguity& local : found) {
		CHECK(local.mean_area == Approx(2));
		CHECK(local.ambiguity >= 0);
		CHECK(local.ambiguity <= 1);
	}
}

TEST_CASE("The mean area is that of the faces around", "[ambiguity]")
{
	for (const double scale : {1e-3, 1.0, 1e3}) {
		const StepFixture f(placed(make_flat_grid(10), scale));
		for (const LocalAmbiguity& local : measured(f))
			CHECK(local.mean_area == Approx(scale * scale / 200));
	}
}

TEST_CASE("Ambiguity is the same on any number of threads", "[ambiguity][parallel]")
{
	const TriangleMesh mesh = noisy(make_part(8000), 0.2);
	const StepFixture one(mesh, 1);
	const std::vector<LocalAmbiguity> expected = measured(one);
	for (const int threads : {2, 4}) {
		const StepFixture several(mesh, threads);
		const std::vector<LocalAmbiguity> found = measured(several);
		bool same = true;
		for (std::size_t i = 0; i < found.size(); ++i)
			same = same && found[i].ambiguity == expected[i].ambiguity &&
				   found[i].mean_area == expected[i].mean_area;
		CHECK(same);
	}
}
