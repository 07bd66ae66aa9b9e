// SPDX-License-Identifier: GPL-3.0-or-later
#include "final_smoothing.h"

#include "measures.h"
#include "method_support.h"
#include "moves.h"
#include "recipes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <utility>

using namespace orthopoly;

namespace {

constexpr double SIGMA = 0.2;

/// A method that goes so far of the way from the measured mesh to what it should be, so that it
/// follows the rest of the noise.
struct Halfway {
	Halfway(const TriangleMesh& truth_given, double way, int threads = 1) :
			Halfway(truth_given, noisy(truth_given, SIGMA), {}, way, threads)
	{
	}

	/// @param noisy_mesh    the truth with noise
	/// @param factors_given of the noise at the vertices, or none
	Halfway(
		const TriangleMesh& truth_given,
		const TriangleMesh& noisy_mesh,
		const std::vector<double>& factors_given,
		double way,
		int threads = 1) :
			truth(truth_given),
			factors(factors_given), f(noisy_mesh, threads), positions(f.mesh.positions),
			probe(
				f.workspace,
				{SIGMA * mean_edge_length(truth.positions, truth.faces), factors},
				truth.positions),
			responses(probe.normals())
	{
		for (std::size_t i = 0; i < positions.size(); ++i) {
			positions[i] += way * (truth.positions[i] - positions[i]);
			responses[i] *= (1 - way) * probe.noise_at(i);
		}
	}

	/// Averages over neighbours, so that what is left of the noise is broad.
	void make_broad()
	{
		for (std::vector<Point>* field : {&positions, &responses})
			low_pass(f.workspace, 10, *field, -TAUBIN_SHRINK);
	}

	FinalSmoothing choice() const
	{
		return choose_smoothing(f.workspace, probe, responses, positions);
	}

	std::vector<Point> smoothed() const
	{
		std::vector<Point> result = positions;
		smooth_finally(f.workspace, choice(), result);
		return result;
	}

	ErrorMeasures errors(const std::vector<Point>& its_positions) const
	{
		return measure(with_positions(truth, its_positions), truth);
	}

	/// Checks that smoothing leaves less than these times of both errors.
	void check_smoothed(double angle, double vertex_error) const
	{
		const ErrorMeasures before = errors(positions);
		const ErrorMeasures after = errors(smoothed());
		CHECK(after.mean_angle < angle * before.mean_angle);
		CHECK(after.vertex_error < vertex_error * before.vertex_error);
	}

	TriangleMesh truth;
	std::vector<double> factors;
	StepFixture f;
	std::vector<Point> positions;
	Probe probe;
	std::vector<Point> responses;
};

/// The share that leaves the least, by the mesh as it should be.
double best_share(const Halfway& method, int pairs)
{
	std::vector<Point> away = method.positions;
	low_pass(method.f.workspace, pairs, away, -TAUBIN_SHRINK);
	double products = 0;
	double squares = 0;
	for (const Face& face : method.truth.faces) {
		const auto along_normal = [&](std::size_t k, const std::vector<Point>& to) {
			const std::size_t i = at(face[k % 3]);
			return (to[i] - method.positions[i]).dot(method.probe.normals()[i]);
		};
		for (std::size_t k = 0; k < 3; ++k) {
			const double smoothing = along_normal(k, away) - along_normal(k + 1, away);
			const double error = along_normal(k, method.truth.positions) -
								 along_normal(k + 1, method.truth.positions);
			products += smoothing * error;
			squares += smoothing * smoothing;
		}
	}
	return products / squares;
}

/// Half as much again: a method has it easier with its own result, which this one does not.
double expected_share(const Halfway& method, int pairs)
{
	return std::min(1.0, 1.5 * best_share(method, pairs));
}

} // namespace

TEST_CASE("What a method left rough is smoothed in the end", "[final_smoothing]")
{
	for (const double way : {0.2, 0.5, 0.8}) {
		CAPTURE(way);
		const Halfway method(make_sphere(8000), way);
		CHECK(method.choice().share > 0.9);
		method.check_smoothed(0.5, 0.8);
	}
}

TEST_CASE("The share of the final smoothing is that which leaves the least", "[final_smoothing]")
{
	// Bumps that the filter takes some of.
	for (const double height : {1.0, 1.5, 2.0}) {
		CAPTURE(height);
		const Halfway method(bumpy_sphere(12000, 6, height), 0.5);
		const FinalSmoothing choice = method.choice();
		REQUIRE(choice.share > 0.05);
		CHECK(choice.share == Approx(expected_share(method, choice.pairs)).margin(0.15));
		CHECK(
			method.errors(method.smoothed()).mean_angle <
			method.errors(method.positions).mean_angle);
	}
}

TEST_CASE("What is left broad is smoothed by many pairs", "[final_smoothing]")
{
	for (const double way : {0.5, 0.8}) {
		CAPTURE(way);
		Halfway method(make_sphere(20000), way);
		method.make_broad();
		CHECK(method.choice().pairs > 20);
		method.check_smoothed(0.4, 0.8);
	}
}

TEST_CASE("Many pairs are not bought with the shape", "[final_smoothing]")
{
	// Bumps about as wide as the filter, which cost distances more than angles.
	for (const auto& [edges, height] : {std::pair(26.0, 1.0), {26.0, 2.0}, {30.0, 2.0}}) {
		CAPTURE(edges, height);
		Halfway method(bumpy_sphere(20000, edges, height), 0.8);
		method.make_broad();
		method.check_smoothed(0.8, 1);
	}
}

TEST_CASE("The share of the final smoothing goes by the noise of each vertex", "[final_smoothing]")
{
	const auto half = [](const Point& p) { return p.x() > 0 ? 1.4 : 0.2; };
	for (const double height : {1.0, 1.5}) {
		CAPTURE(height);
		const TriangleMesh truth = bumpy_sphere(12000, 6, height);
		const Halfway method(
			truth, unevenly_noisy(truth, SIGMA, half), share_at_vertices(truth, half), 0.5);
		const FinalSmoothing choice = method.choice();
		REQUIRE(choice.share > 0.05);
		CHECK(choice.share == Approx(expected_share(method, choice.pairs)).margin(0.15));
	}
}

TEST_CASE("What a method made rough itself is smoothed in the end", "[final_smoothing]")
{
	// It follows none of the noise, so that the probe does not tell.
	Halfway method(make_sphere(20000), 1);
	NoiseOptions facets;
	facets.sigma = 0.05;
	facets.direction = NoiseDirection::Normal;
	facets.seed = 8;
	method.positions = add_noise(method.truth, facets);
	CHECK(method.choice().share == 1);
	const ErrorMeasures before = method.errors(method.positions);
	CHECK(method.errors(method.smoothed()).mean_angle < 0.5 * before.mean_angle);
	method.positions = method.truth.positions;
	CHECK(method.choice().share == 0);
}

TEST_CASE("Edges that a method found are not smoothed", "[final_smoothing]")
{
	for (const char* name : {"cube", "part"}) {
		CAPTURE(name);
		const Halfway method(find_recipe(name).make(12000), 1);
		CHECK(method.choice().share == 0);
		CHECK(same_bits(method.smoothed(), method.positions));
	}
}

TEST_CASE(
	"The final smoothing does not depend on threads and numbers, nor moves what is fixed",
	"[final_smoothing]")
{
	const TriangleMesh truth = bumpy_sphere(6000, 6, 0.5);
	const Halfway here(truth, 0.5);
	const std::vector<Point> expected = here.smoothed();
	CHECK_FALSE(same_bits(expected, here.positions));
	CHECK(same_bits(Halfway(truth, 0.5, 2).smoothed(), expected));

	TriangleMesh fixed = here.f.mesh;
	fixed.fixed.assign(fixed.positions.size(), 0);
	for (std::size_t i = 0; i < fixed.fixed.size(); i += 3)
		fixed.fixed[i] = 1;
	const StepFixture f(fixed);
	const Probe probe(f.workspace, SIGMA * f.workspace.mean_edge_length, here.positions);
	std::vector<Point> positions = here.positions;
	smooth_finally(f.workspace, here.choice(), positions);
	for (std::size_t i = 0; i < fixed.fixed.size(); i += 3) {
		REQUIRE(probe.draws()[i] == 0);
		REQUIRE(positions[i] == here.positions[i]);
	}

	const Renumbered other(here.f.mesh);
	const StepFixture g(other.mesh);
	const auto there = [&](const auto& values) {
		auto result = values;
		for (std::size_t i = 0; i < values.size(); ++i)
			result[other.places[i]] = values[i];
		return result;
	};
	std::vector<Point> renumbered = there(here.positions);
	const Probe its_probe(g.workspace, here.probe.noise(), there(truth.positions));
	const FinalSmoothing choice =
		choose_smoothing(g.workspace, its_probe, there(here.responses), renumbered);
	CHECK(choice.pairs == here.choice().pairs);
	CHECK(choice.share == Approx(here.choice().share).epsilon(1e-9));
	smooth_finally(g.workspace, choice, renumbered);
	CHECK(
		largest_distance(other.in_given_order(renumbered), expected) <
		1e-9 * f.workspace.mean_edge_length);
}

TEST_CASE("The final smoothing turns no face over", "[final_smoothing]")
{
	// Bumps of a few faces each, which the filter flattens beyond what these can follow.
	const TriangleMesh mesh = noisy(bumpy_sphere(3000, 3, 2), 0.4);
	const StepFixture f(mesh);
	std::vector<Point> positions = mesh.positions;
	smooth_finally(f.workspace, {20, 1}, positions);
	std::size_t turned = 0;
	for (const Face& face : mesh.faces) {
		const Point before = face_cross_product(mesh.positions, face);
		if (before.dot(face_cross_product(positions, face)) < 0)
			++turned;
	}
	CHECK(turned == 0);
	CHECK_FALSE(same_bits(positions, mesh.positions));
}
