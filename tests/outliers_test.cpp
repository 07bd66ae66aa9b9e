// SPDX-License-Identifier: GPL-3.0-or-later
#include "outliers.h"

#include "adaptive_plan.h"
#include "adaptive_run.h"
#include "inspection.h"
#include "measures.h"
#include "method_support.h"
#include "noise_level.h"
#include "recipes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <string>

using namespace orthopoly;

namespace {

TriangleMesh impulsive(TriangleMesh mesh, double sigma, double share)
{
	NoiseOptions options;
	options.sigma = sigma;
	options.impulsive_share = share;
	options.direction = NoiseDirection::Isotropic;
	options.seed = 7;
	mesh.positions = add_noise(mesh, options);
	return mesh;
}

Outliers put_back(const TriangleMesh& mesh, int threads = 1)
{
	const StepFixture f(mesh, threads);
	return put_back_outliers(
		f.workspace, mesh.positions, estimate_noise_levels(f.workspace, mesh.positions).ordinary);
}

} // namespace

TEST_CASE("Outliers are found and put back", "[outliers]")
{
	const std::string name = GENERATE("cube", "sphere", "torus", "height_field");
	const double share = GENERATE(0.1, 0.3);
	CAPTURE(name, share);
	const TriangleMesh truth = find_recipe(name).make(8000);
	const TriangleMesh mesh = impulsive(truth, 0.4, share);
	const Outliers found = put_back(mesh);
	Index right = 0;
	Index moved = 0;
	for (std::size_t i = 0; i < truth.positions.size(); ++i) {
		const bool is_outlier = mesh.positions[i] != truth.positions[i];
		moved += is_outlier;
		right += is_outlier && found.flags[i] != 0;
		if (found.flags[i] == 0)
			CHECK(same_bits(found.positions[i], mesh.positions[i]));
	}
	CHECK(found.count == std::count(found.flags.begin(), found.flags.end(), 1));
	// The others are too near to tell or on edges; hardly any is taken that was not moved.
	CHECK(right > 0.4 * moved);
	CHECK(right > 0.9 * found.count);
	const double before = measure(mesh, truth).mean_angle;
	CHECK(measure(with_positions(mesh, found.positions), truth).mean_angle < 0.6 * before);
}

TEST_CASE("Noise of all vertices has no outliers worth the name", "[outliers][slow]")
{
	const std::string name = GENERATE("cube", "sphere", "part", "height_field");
	const auto direction =
		GENERATE(NoiseDirection::Normal, NoiseDirection::Random, NoiseDirection::Isotropic);
	for (const double sigma : {0.05, 0.2, 0.5}) {
		CAPTURE(name, static_cast<int>(direction), sigma);
		const TriangleMesh mesh = noisy(find_recipe(name).make(4000), sigma, direction);
		const Outliers found = put_back(mesh);
		CHECK(found.count < 0.03 * static_cast<double>(mesh.vertex_count()));
		// Features that are taken for some do not explain the noise.
		const StepFixture f(mesh);
		CHECK(
			estimate_noise_levels(f.workspace, found.positions).ordinary >
			0.85 * estimate_noise_levels(f.workspace, mesh.positions).ordinary);
	}
}

TEST_CASE("Faces that outliers folded open where these were not found", "[outliers]")
{
	const TriangleMesh mesh = impulsive(make_sphere(4000), 0.8, 0.05);
	const StepFixture f(mesh);
	AdaptivePlan plan = plan_for({}, 0.05, {});
	const auto folds_left = [&](double factor) {
		plan.fold_factor = factor;
		std::vector<Point> positions = mesh.positions;
		run_adaptively(f.workspace, plan, {}, positions);
		return count_folded_faces(positions, f.workspace);
	};
	const Index by_level = folds_left(1);
	CHECK(by_level > 10);
	CHECK(folds_left(8) < 0.3 * by_level);
}

TEST_CASE("Outliers explain impulsive noise, detail or not, and no other", "[outliers][slow]")
{
	const auto repaired = [](const TriangleMesh& mesh) {
		const StepFixture f(mesh);
		return repair_outliers(f.workspace, estimate_noise_levels(f.workspace, mesh.positions));
	};
	const TriangleMesh smooth = make_sphere(8000);
	const TriangleMesh rough = with_correlated_noise(make_sphere(8000), 0.2, 2);
	for (const TriangleMesh& truth : {smooth, rough}) {
		const TriangleMesh mesh = impulsive(truth, 0.4, 0.2);
		const OutlierRepair outliers = repaired(mesh);
		CHECK(outliers.share == 1);
		CHECK(outliers.left < 0.3 * outliers.level);
		CHECK(outliers.found > 0.04);
		CHECK(outliers.found < 0.2);
		const double before = measure(mesh, truth).mean_angle;
		CHECK(measure(with_positions(mesh, outliers.positions), truth).mean_angle < 0.6 * before);
		for (const TriangleMesh& other : {truth, noisy(truth, 0.2)}) {
			CHECK(repaired(other).share == 0);
			CHECK(repaired(other).positions.empty());
		}
	}
}

TEST_CASE("Fixed vertices stay, outliers or not", "[outliers]")
{
	TriangleMesh mesh = impulsive(make_sphere(4000), 0.4, 0.2);
	mesh.fixed.assign(mesh.positions.size(), 1);
	CHECK(same_bits(put_back(mesh).positions, mesh.positions));
}

TEST_CASE("Outliers are the same wherever the mesh is and however it is numbered", "[outliers]")
{
	const TriangleMesh mesh = impulsive(make_torus(4000), 0.4, 0.2);
	const double edge = mean_edge_length(mesh.positions, mesh.faces);
	const Outliers here = put_back(mesh);
	const Eigen::Matrix3d rotation = some_rotation();
	const auto there = [&](const Point& p) { return Point(1e3 * (rotation * p)); };
	const Outliers turned = put_back(with_positions(mesh, each(mesh.positions, there)));
	CHECK((turned.flags == here.flags));
	CHECK(largest_distance(turned.positions, each(here.positions, there)) < 1e-8 * 1e3 * edge);
	const Renumbered renumbered(mesh);
	const Outliers found = put_back(renumbered.mesh);
	CHECK(found.count == here.count);
	CHECK(
		largest_distance(renumbered.in_given_order(found.positions), here.positions) < 1e-8 * edge);
}

TEST_CASE("Outliers are put back within reason on anything", "[outliers][slow]")
{
	for (const Recipe& recipe : recipes()) {
		if (!recipe.can_be_denoised)
			continue;
		CAPTURE(recipe.name);
		const TriangleMesh mesh = impulsive(recipe.make_default(), 0.3, 0.2);
		const Outliers found = put_back(mesh);
		CHECK(all_finite(found.positions));
		const double edge = mean_edge_length(mesh.positions, mesh.faces);
		CHECK(largest_distance(found.positions, mesh.positions) < 5 * edge);
	}
}

TEST_CASE("Outliers are the same on any number of threads", "[outliers][parallel]")
{
	const TriangleMesh mesh = impulsive(make_part(8000), 0.4, 0.3);
	const Outliers one = put_back(mesh, 1);
	for (const int threads : {2, 4}) {
		const Outliers many = put_back(mesh, threads);
		CHECK((many.flags == one.flags));
		CHECK(same_bits(many.positions, one.positions));
	}
}
