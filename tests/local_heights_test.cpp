// SPDX-License-Identifier: GPL-3.0-or-later
#include "local_heights.h"

#include "method_support.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

constexpr int SQUARES = 30;
constexpr Index CENTER = (SQUARES / 2) * (SQUARES + 1) + SQUARES / 2;

} // namespace

TEST_CASE("A cubic surface leaves nothing", "[local_heights]")
{
	TriangleMesh mesh = make_flat_grid(SQUARES);
	for (Point& p : mesh.positions)
		p.z() = 0.3 * p.x() * p.x() * p.x() - p.x() * p.y() * p.y() + 0.5 * p.x() * p.y() - p.y();
	const StepFixture f(mesh);
	// The plane the heights stand on, so that they are a cubic over it.
	const std::vector<Point> flat = make_flat_grid(SQUARES).positions;
	LocalHeights heights(f.workspace, mesh.positions, flat);
	for (const int rings : {2, 3, 6}) {
		REQUIRE(heights.fit(CENTER, rings));
		CHECK(heights.variance() < 1e-24);
	}
}

TEST_CASE("The residual variance is that of the noise", "[local_heights]")
{
	const TriangleMesh flat = make_flat_grid(SQUARES);
	const double sigma = 0.2;
	const TriangleMesh mesh = noisy(flat, sigma);
	const StepFixture f(mesh);
	LocalHeights heights(f.workspace, mesh.positions, flat.positions);
	const double edge = mean_edge_length(flat.positions, flat.faces);
	REQUIRE(heights.fit(CENTER, 10));
	// All vertices of ten rings but for the terms: enough to know a variance to a fifth.
	CHECK(heights.free() > 300);
	CHECK(std::sqrt(heights.variance()) == Approx(sigma * edge).epsilon(0.1));
}

TEST_CASE("Residuals go together where the noise does", "[local_heights]")
{
	const TriangleMesh flat = make_flat_grid(SQUARES);
	const auto mean_correlation = [&](const TriangleMesh& mesh) {
		const StepFixture f(mesh);
		LocalHeights heights(f.workspace, mesh.positions, flat.positions);
		double sum = 0;
		int count = 0;
		for (Index i = 0; i < mesh.vertex_count(); i += 7) {
			if (!heights.fit(i, 5))
				continue;
			sum += heights.edge_correlation();
			++count;
		}
		REQUIRE(count > 100);
		return sum / count;
	};
	CHECK(std::abs(mean_correlation(noisy(flat, 0.2))) < 0.03);
	CHECK(mean_correlation(with_correlated_noise(flat, 0.2)) > 0.25);
}

TEST_CASE("Where there is nothing to fit there is no fit", "[local_heights]")
{
	const TriangleMesh square = unit_square();
	const StepFixture few(square);
	CHECK_FALSE(LocalHeights(few.workspace, square.positions, square.positions).fit(0, 4));

	// All vertices on a line: no normal, no plane.
	TriangleMesh line = make_flat_grid(10);
	for (Point& p : line.positions)
		p.y() = 0;
	const StepFixture degenerate(line);
	CHECK_FALSE(LocalHeights(degenerate.workspace, line.positions, line.positions).fit(60, 3));
}
