// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice.h"

#include "method_support.h"
#include "volume_support.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

double step_of(const TriangleMesh& mesh, int threads = 1)
{
	const StepFixture f(mesh, threads);
	return lattice_step(f.workspace, mesh.positions);
}

// Inside or outside of an egg, as a segmented volume has it.
double segmented(const Point& p)
{
	return Point(p.x(), 1.2 * p.y(), 1.5 * p.z() + 0.1).norm() < 0.7 ? -0.5 : 0.5;
}

} // namespace

TEST_CASE("Rounded coordinates lie on a lattice, whichever way it is turned", "[lattice]")
{
	for (const double step : {0.1, 0.3, 0.6, 1.0}) {
		CAPTURE(step);
		for (const TriangleMesh& truth : {make_sphere(4000), noisy(make_part(6000), 0.1)}) {
			const TriangleMesh mesh = rounded(truth, step);
			const double length = mean_edge_length(truth.positions, truth.faces);
			const double expected = step * length / mean_edge_length(mesh.positions, mesh.faces);
			CHECK(step_of(mesh) == Approx(expected).epsilon(1e-6));
			CHECK(step_of(mesh, 2) == step_of(mesh));
			CHECK(step_of(Renumbered(mesh).mesh) == Approx(expected).epsilon(1e-6));
			const Eigen::Matrix3d rotation = some_rotation();
			for (const double scale : {1e-3, 1e3}) {
				// As a file in single precision has it.
				const auto there = [&](const Point& p) {
					const Point moved = scale * (rotation * p) + scale * Point(2, -1, 0.5);
					return Point(moved.cast<float>().cast<double>());
				};
				const TriangleMesh turned = with_positions(mesh, each(mesh.positions, there));
				CHECK(step_of(turned) == Approx(expected).epsilon(1e-3));
			}
		}
	}
}

TEST_CASE("Surfaces of segmented volumes lie on a lattice", "[lattice]")
{
	const TriangleMesh mesh = surface_of(segmented, 40, 0);
	// Values in the middles of 41 cubes.
	const double half_diagonal = 2.0 / 41 / std::sqrt(2);
	CHECK(
		step_of(mesh) * mean_edge_length(mesh.positions, mesh.faces) ==
		Approx(half_diagonal).epsilon(1e-6));
	// Slices three cubes apart: nothing that rounding would leave.
	const auto stretch = [](const Point& p) { return Point(p.x(), p.y(), 3 * p.z()); };
	CHECK(step_of(with_positions(mesh, each(mesh.positions, stretch))) == 0);
}

TEST_CASE("What was measured lies on no lattice, nor does what was rounded finely", "[lattice]")
{
	for (const TriangleMesh& truth :
		 {make_sphere(4000), make_torus(4000), make_part(6000), make_height_field(6000)}) {
		CHECK(step_of(truth) == 0);
		CHECK(step_of(noisy(truth, 0.2)) == 0);
		CHECK(step_of(rounded(truth, 0.05)) == 0);
	}
	CHECK(step_of(surface_of([](const Point& p) { return p.norm() - 0.7; }, 40, 0.2)) == 0);
	CHECK(step_of({}) == 0);
	// All in one place.
	CHECK(step_of(with_positions(make_box({1, 1, 1}, Point::Ones()), {8, Point(1, 2, 3)})) == 0);
}
