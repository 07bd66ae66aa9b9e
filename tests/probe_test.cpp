// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe.h"

#include "recipes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>

using namespace orthopoly;

namespace {

std::vector<double> draws_for(const StepFixture& f, double edge_correlation)
{
	return Probe(f.workspace, 1.0, f.mesh.positions, edge_correlation).draws();
}

double mean_square(const std::vector<double>& values)
{
	double sum = 0;
	for (const double value : values)
		sum += value * value;
	return sum / static_cast<double>(values.size());
}

double edge_correlation(const TriangleMesh& mesh, const std::vector<double>& values)
{
	double products = 0;
	double squares = 0;
	for (const Face& face : mesh.faces) {
		for (std::size_t k = 0; k < 3; ++k) {
			const double a = values[at(face[k])];
			const double b = values[at(face[(k + 1) % 3])];
			products += a * b;
			squares += (a * a + b * b) / 2;
		}
	}
	return products / squares;
}

} // namespace

TEST_CASE("A white probe is signs", "[probe]")
{
	const StepFixture f(noisy(make_part(4000), 0.1));
	const std::vector<double> draws = draws_for(f, 0);
	CHECK(std::all_of(
		draws.begin(), draws.end(), [](double draw) { return draw == 1 || draw == -1; }));
	CHECK(edge_correlation(f.mesh, draws) == Approx(0).margin(0.05));
	CHECK(Probe(f.workspace, 1.0, f.mesh.positions).is_white());
}

TEST_CASE("A probe goes together over edges as far as it should", "[probe]")
{
	for (const char* name : {"sphere", "part", "thin_plate"}) {
		const StepFixture f(noisy(find_recipe(name).make(4000), 0.1));
		for (const double wanted : {0.2, 0.5, 0.8}) {
			CAPTURE(name, wanted);
			const std::vector<double> draws = draws_for(f, wanted);
			CHECK(edge_correlation(f.mesh, draws) == Approx(wanted).margin(0.06));
			CHECK(mean_square(draws) == Approx(1));
		}
		CHECK_FALSE(Probe(f.workspace, 1.0, f.mesh.positions, 0.5).is_white());
	}
}

TEST_CASE("More than averages can make go together is as much as they can", "[probe]")
{
	const StepFixture f(make_sphere(500));
	const std::vector<double> draws = draws_for(f, 2);
	CHECK(edge_correlation(f.mesh, draws) > 0.9);
	CHECK(mean_square(draws) == Approx(1));
}

TEST_CASE("A probe does not depend on threads, nor move what is fixed", "[probe]")
{
	TriangleMesh mesh = make_sphere(2000);
	mesh.fixed.assign(mesh.positions.size(), 0);
	for (std::size_t i = 0; i < mesh.fixed.size(); i += 3)
		mesh.fixed[i] = 1;
	const StepFixture f(mesh);
	const StepFixture g(mesh, 2);
	for (const double wanted : {0.0, 0.5}) {
		CAPTURE(wanted);
		const std::vector<double> draws = draws_for(f, wanted);
		CHECK(draws == draws_for(g, wanted));
		const Probe probe(f.workspace, 1.0, mesh.positions, wanted);
		const std::vector<Point> probed = probe.with_probe(mesh.positions);
		for (std::size_t i = 0; i < mesh.fixed.size(); ++i) {
			REQUIRE((draws[i] == 0) == (mesh.fixed[i] != 0));
			REQUIRE((probed[i] == mesh.positions[i]) == (mesh.fixed[i] != 0));
		}
	}
}
