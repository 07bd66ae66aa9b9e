// SPDX-License-Identifier: GPL-3.0-or-later
#include "spikes.h"

#include "denoise.h"
#include "measures.h"
#include "method_support.h"
#include "recipes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

using namespace orthopoly;

namespace {

constexpr double NOISE_BESIDE = 0.05;

TriangleMesh spiky(TriangleMesh mesh, double share, double height = 2)
{
	NoiseOptions options;
	options.sigma = height;
	options.direction = NoiseDirection::Normal;
	options.impulsive_share = share;
	options.seed = 5;
	mesh.positions = add_noise(mesh, options);
	return mesh;
}

Spikes spikes_of(const TriangleMesh& mesh, int threads = 1)
{
	return find_spikes(StepFixture(mesh, threads).workspace, NOISE_BESIDE);
}

double distance(const Point& a, const Point& b, double edge)
{
	return (a - b).norm() / edge;
}

} // namespace

TEST_CASE("Lone vertices far out are found and put back", "[spikes]")
{
	const std::string name = GENERATE("sphere", "torus", "part", "height_field");
	const double height = GENERATE(1.0, 4.0);
	CAPTURE(name, height);
	const TriangleMesh truth = noisy(find_recipe(name).make(12000), NOISE_BESIDE);
	const TriangleMesh mesh = spiky(truth, 0.01, height);
	const double edge = mean_edge_length(truth.positions, truth.faces);
	const Spikes spikes = spikes_of(mesh);
	REQUIRE(spikes.positions.size() == mesh.positions.size());
	Index far = 0;
	Index found = 0;
	Index wrong = 0;
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		const bool is_far = distance(mesh.positions[i], truth.positions[i], edge) > 0.6;
		const bool is_found = std::binary_search(
			spikes.vertices.begin(), spikes.vertices.end(), static_cast<Index>(i));
		far += is_far;
		found += is_far && is_found;
		wrong += is_found && mesh.positions[i] == truth.positions[i];
		if (!is_found)
			REQUIRE(same_bits(spikes.positions[i], mesh.positions[i]));
		else if (is_far)
			CHECK(distance(spikes.positions[i], truth.positions[i], edge) < 0.8);
	}
	// The others are beside an edge or each other.
	CHECK(found > 0.5 * far);
	CHECK(wrong <= 1);
}

TEST_CASE("Shapes and noise of all vertices have no spikes", "[spikes]")
{
	for (const Recipe& recipe : recipes()) {
		if (!recipe.can_be_denoised)
			continue;
		CAPTURE(recipe.name);
		const TriangleMesh mesh = recipe.make_default();
		CHECK(spikes_of(mesh).vertices.empty());
		CHECK(spikes_of(mesh).positions.empty());
		const StepFixture f(noisy(mesh, 0.3));
		CHECK(find_spikes(f.workspace, 0.3).vertices.empty());
	}
}

TEST_CASE("A few spikes may be there on purpose", "[spikes]")
{
	const TriangleMesh mesh = spiky(make_sphere(8000), 0.001);
	CHECK(spikes_of(mesh).vertices.empty());
}

TEST_CASE("Fixed spikes stay", "[spikes]")
{
	TriangleMesh mesh = spiky(make_sphere(8000), 0.01);
	const Spikes all = spikes_of(mesh);
	REQUIRE(all.vertices.size() > 20);
	mesh.fixed.assign(mesh.positions.size(), 0);
	mesh.fixed[at(all.vertices.front())] = 1;
	const Spikes others = spikes_of(mesh);
	CHECK(others.vertices.size() + 1 == all.vertices.size());
	CHECK(others.vertices.front() != all.vertices.front());
}

TEST_CASE("Spikes put back fold no face", "[spikes]")
{
	TriangleMesh truth = make_sphere(8000);
	TriangleMesh mesh = truth;
	NoiseOptions options;
	options.sigma = 2;
	options.impulsive_share = 0.01;
	mesh.positions = add_noise(mesh, options);
	const Spikes spikes = spikes_of(mesh);
	REQUIRE(spikes.vertices.size() > 10);
	const StepFixture f(mesh);
	const std::vector<std::uint8_t> folded = folded_faces(spikes.positions, f.workspace);
	for (const Index vertex : spikes.vertices) {
		const IndexLists& around = f.workspace.vertex_faces;
		CHECK(std::none_of(around.begin(vertex), around.end(vertex), [&](Index face) {
			return folded[at(face)] != 0;
		}));
	}
}

TEST_CASE("Spikes are the same wherever the mesh is and however it is numbered", "[spikes]")
{
	const TriangleMesh mesh = spiky(noisy(make_torus(8000), NOISE_BESIDE), 0.01);
	const double edge = mean_edge_length(mesh.positions, mesh.faces);
	const Spikes here = spikes_of(mesh);
	REQUIRE(here.vertices.size() > 20);
	const Eigen::Matrix3d rotation = some_rotation();
	const auto there = [&](const Point& p) { return Point(1e3 * (rotation * p)); };
	const Spikes turned = spikes_of(with_positions(mesh, each(mesh.positions, there)));
	CHECK(turned.vertices == here.vertices);
	CHECK(largest_distance(turned.positions, each(here.positions, there)) < 1e-8 * 1e3 * edge);
	const Renumbered renumbered(mesh);
	const Spikes found = spikes_of(renumbered.mesh);
	CHECK(found.vertices.size() == here.vertices.size());
	CHECK(
		largest_distance(renumbered.in_given_order(found.positions), here.positions) < 1e-8 * edge);
}

TEST_CASE("Spikes are the same on any number of threads", "[spikes][parallel]")
{
	const TriangleMesh mesh = spiky(noisy(make_torus(8000), NOISE_BESIDE), 0.01);
	const Spikes one = spikes_of(mesh, 1);
	for (const int threads : {2, 4}) {
		const Spikes many = spikes_of(mesh, threads);
		CHECK(many.vertices == one.vertices);
		CHECK(same_bits(many.positions, one.positions));
	}
}

TEST_CASE("Spikes go, with the noise or by themselves", "[spikes][denoise]")
{
	const TriangleMesh truth = make_sphere(8000);
	SECTION("alone")
	{
		const TriangleMesh mesh = spiky(truth, 0.01);
		const DenoiseResult result = denoised(mesh, {});
		CHECK(result.status == DenoiseResult::Status::Done);
		CHECK(result.spikes > 20);
		CHECK(result.moved_vertices == result.spikes);
		CHECK(result.iterations_done == 0);
	}
	SECTION("in noise")
	{
		const TriangleMesh mesh = spiky(noisy(truth, 0.1), 0.01);
		const DenoiseResult result = denoised(mesh, {});
		CHECK(result.spikes > 20);
		CHECK(result.estimated_noise == Approx(0.1).epsilon(0.15));
		const ErrorMeasures without =
			measure(with_positions(mesh, denoised(noisy(truth, 0.1), {}).positions), truth);
		const ErrorMeasures after = measure(with_positions(mesh, result.positions), truth);
		CHECK(after.mean_angle < 1.5 * without.mean_angle);
		CHECK(after.vertex_error < 2 * without.vertex_error);
	}
	SECTION("not where nothing is to be removed")
	{
		DenoiseOptions options;
		options.noise_level = 0;
		CHECK(denoised(spiky(truth, 0.01), options).status == DenoiseResult::Status::NothingToDo);
	}
}
