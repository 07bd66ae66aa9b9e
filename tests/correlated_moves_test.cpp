// SPDX-License-Identifier: GPL-3.0-or-later
#include "correlated_moves.h"

#include "measures.h"
#include "method_support.h"
#include "moves.h"
#include "recipes.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <vector>

using namespace orthopoly;

namespace {

// A hill some ten edges wide on a torus.
TriangleMesh with_hill(TriangleMesh mesh, double edges)
{
	const double edge = mean_edge_length(mesh.positions, mesh.faces);
	const StepFixture f(mesh);
	const Moves away = moves_along_normals(f.workspace, edge, mesh.positions);
	const Point top = mesh.positions.front();
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		const double square = (mesh.positions[i] - top).squaredNorm() / (edge * edge);
		mesh.positions[i] += edges * edge * std::exp(-square / 30) * away.crosses[i].normalized();
	}
	return mesh;
}

CorrelatedMoves moves(const TriangleMesh& from, const TriangleMesh& to, int threads = 1)
{
	const StepFixture f(from, threads);
	return measure_correlated_moves(f.workspace, to.positions);
}

} // namespace

TEST_CASE("What is taken from noise is alike everywhere", "[correlated_moves]")
{
	const TriangleMesh truth = make_torus(12000);
	for (const double sigma : {0.02, 0.2}) {
		CAPTURE(sigma);
		const CorrelatedMoves white = moves(noisy(truth, sigma), truth);
		CHECK(std::abs(white.edge_correlation) < 0.03);
		CHECK(white.spread < 1.12);
		CHECK(white.far_spread < 1.18);
		CHECK(white.are_alike() > 0.9);
		for (const int steps : {1, 2, 4}) {
			CAPTURE(steps);
			const CorrelatedMoves found = moves(with_correlated_noise(truth, sigma, steps), truth);
			CHECK(found.edge_correlation > (steps == 1 ? 0.3 : 0.55));
			CHECK(found.spread > white.spread);
			CHECK(found.are_alike() > 0.7);
		}
	}
}

TEST_CASE("What is taken from detail is not", "[correlated_moves]")
{
	const TriangleMesh truth = make_torus(12000);
	CHECK(moves(truth, truth).spread == 0);
	CHECK(moves(truth, truth).are_alike() == 0);
	// Noise, and features on a third of the surface.
	TriangleMesh mesh = with_correlated_noise(truth, 0.1, 1);
	const double of_noise = moves(mesh, truth).edge_correlation;
	const std::vector<Point> features = with_correlated_noise(truth, 0.4, 2).positions;
	for (std::size_t i = 0; i < features.size(); ++i) {
		if (truth.positions[i].x() > 0.5)
			mesh.positions[i] += features[i] - truth.positions[i];
	}
	const CorrelatedMoves found = moves(mesh, truth);
	CHECK(found.spread > 2);
	CHECK(found.are_alike() == 0);
	// Where less was taken it is the noise.
	CHECK(found.edge_correlation == Approx(of_noise).margin(0.06));
}

TEST_CASE("Only vertices that are asked for count", "[correlated_moves]")
{
	const TriangleMesh truth = make_torus(12000);
	TriangleMesh mesh = with_correlated_noise(truth, 0.1, 1);
	std::vector<std::uint8_t> inner(truth.positions.size(), 1);
	for (std::size_t i = 0; i < inner.size(); ++i) {
		if (truth.positions[i].x() > 0.5) {
			mesh.positions[i] = truth.positions[i] + 5 * (mesh.positions[i] - truth.positions[i]);
			inner[i] = 0;
		}
	}
	const StepFixture f(mesh);
	CHECK(measure_correlated_moves(f.workspace, truth.positions).are_alike() == 0);
	// But for those beside them, which have neighbours among the others.
	for (std::size_t i = 0; i < inner.size(); ++i)
		inner[i] = truth.positions[i].x() > -0.2 ? 0 : 1;
	CHECK(measure_correlated_moves(f.workspace, truth.positions, inner).are_alike() > 0.7);
}

TEST_CASE("Far more than noise is given back, noise is not", "[correlated_moves]")
{
	const TriangleMesh plain = make_torus(12000);
	const TriangleMesh truth = with_hill(plain, 3);
	TriangleMesh mesh = truth;
	const std::vector<Point> noise = with_correlated_noise(plain, 0.1, 2).positions;
	for (std::size_t i = 0; i < noise.size(); ++i)
		mesh.positions[i] += noise[i] - plain.positions[i];
	const StepFixture f(mesh, 2);
	const auto given_back = [&](double most) {
		std::vector<Point> positions = plain.positions;
		give_back_uneven(f.workspace, most, positions);
		return positions;
	};
	CHECK(given_back(0) == plain.positions);
	const std::vector<Point> positions = given_back(1);
	const double lost = measure(plain, truth).vertex_error;
	const double left = measure(with_positions(truth, positions), truth).vertex_error;
	CAPTURE(lost, left);
	CHECK(left < 0.25 * lost);
	// Away from the hill all of the noise stays off.
	std::size_t same = 0;
	for (std::size_t i = 0; i < positions.size(); ++i)
		same += positions[i] == plain.positions[i] ? 1 : 0;
	CHECK(same > 0.8 * positions.size());
	// Noise alone.
	const StepFixture noisy_torus(with_correlated_noise(plain, 0.1, 2));
	std::vector<Point> kept = plain.positions;
	give_back_uneven(noisy_torus.workspace, 1, kept);
	CHECK(kept == plain.positions);
	// Fixed vertices stay.
	TriangleMesh held = mesh;
	held.fixed.assign(held.positions.size(), 1);
	const StepFixture fixed(held);
	std::vector<Point> unmoved = plain.positions;
	give_back_uneven(fixed.workspace, 1, unmoved);
	CHECK(unmoved == plain.positions);
}

TEST_CASE("What was taken is the same on any number of threads", "[correlated_moves][parallel]")
{
	const TriangleMesh truth = make_torus(8000);
	const TriangleMesh mesh = with_correlated_noise(with_hill(truth, 3), 0.1, 1);
	const CorrelatedMoves one = moves(mesh, truth, 1);
	const CorrelatedMoves four = moves(mesh, truth, 4);
	CHECK(one.spread == four.spread);
	CHECK(one.far_spread == four.far_spread);
	CHECK(one.edge_correlation == four.edge_correlation);
	const auto given_back = [&](int threads) {
		const StepFixture f(mesh, threads);
		std::vector<Point> positions = truth.positions;
		give_back_uneven(f.workspace, 0.8, positions);
		return positions;
	};
	CHECK(given_back(1) == given_back(4));
}
