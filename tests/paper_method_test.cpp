// SPDX-License-Identifier: GPL-3.0-or-later
#include "paper_method.h"

#include "adjacency.h"
#include "errors.h"
#include "measures.h"
#include "method_support.h"
#include "recipes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>

using namespace orthopoly;

namespace {

DenoiseOptions paper_options()
{
	DenoiseOptions options;
	options.method = Method::Paper;
	options.threads = 1;
	return options;
}

DenoiseResult paper(const TriangleMesh& mesh, const DenoiseOptions& options = paper_options())
{
	return denoised(mesh, options);
}

} // namespace

TEST_CASE("The paper's method leaves a plane where it is", "[paper_method]")
{
	for (const double scale : {1e-6, 1.0, 1e6}) {
		for (const double distance : {0.0, 1e3}) {
			TriangleMesh mesh = make_flat_grid(10);
			const Eigen::Matrix3d rotation = some_rotation();
			mesh.positions = each(mesh.positions, [&](const Point& p) {
				return Point(scale * (rotation * p + Point::Constant(distance)));
			});
			const double rounding = 1e-15 * scale * (1 + distance);
			CHECK(largest_distance(paper(mesh).positions, mesh.positions) < 200 * rounding);
		}
	}
}

TEST_CASE("The paper's method flattens a noisy plane", "[paper_method]")
{
	const TriangleMesh mesh = noisy(make_flat_grid(30), 0.2);
	const auto roughness = [](const std::vector<Point>& positions) {
		double sum = 0;
		for (const Point& p : positions)
			sum += p.z() * p.z();
		return sum;
	};
	CHECK(roughness(paper(mesh).positions) < 0.1 * roughness(mesh.positions));
}

TEST_CASE("The paper's method keeps the edges of a cube sharp", "[paper_method]")
{
	for (const NoiseDirection direction : {NoiseDirection::Normal, NoiseDirection::Random}) {
		const TriangleMesh cube = make_cube(3000);
		const TriangleMesh mesh = noisy(cube, 0.15, direction);
		const TriangleMesh result = with_positions(mesh, paper(mesh).positions);
		const ErrorMeasures before = measure(mesh, cube);
		const ErrorMeasures after = measure(result, cube);
		CHECK(before.mean_angle > 7);
		CHECK(after.mean_angle < 1);
		CHECK(after.vertex_error < 0.4 * before.vertex_error);
		// Rounded edges would show as many faces some tens of degrees off.
		const auto off = std::count_if(
			after.face_angles.begin(), after.face_angles.end(), [](double a) { return a > 15; });
		CHECK(off <= 3);
	}
}

TEST_CASE("The paper's method turns, moves and grows with the mesh", "[paper_method]")
{
	const TriangleMesh mesh = noisy(make_torus(3000), 0.2, NoiseDirection::Random);
	const std::vector<Point> expected = paper(mesh).positions;
	const Eigen::Matrix3d rotation = some_rotation();
	const auto check = [&](double scale, double distance, double tolerance) {
		INFO("scale " << scale << ", distance " << distance);
		const auto there = [&](const Point& p) {
			return Point(scale * (rotation * p + Point::Constant(distance)));
		};
		const TriangleMesh moved = with_positions(mesh, each(mesh.positions, there));
		CHECK(largest_distance(paper(moved).positions, each(expected, there)) < scale * tolerance);
	};
	check(1, 0, 1e-10);
	check(1e-6, 0, 1e-10);
	check(1e6, 0, 1e-10);
	check(1, 1e3, 1e-7);
}

TEST_CASE("A power of two as scale changes no bit", "[paper_method]")
{
	const TriangleMesh mesh = noisy(make_torus(3000), 0.2);
	for (const double scale : {std::ldexp(1.0, -20), std::ldexp(1.0, 20)}) {
		const auto scaled = [&](const Point& p) { return Point(scale * p); };
		CHECK(same_bits(
			paper(with_positions(mesh, each(mesh.positions, scaled))).positions,
			each(paper(mesh).positions, scaled)));
	}
}

TEST_CASE("The paper's method gets through every kind of mesh", "[paper_method]")
{
	for (const Recipe& recipe : recipes()) {
		if (!recipe.can_be_denoised)
			continue;
		INFO(recipe.name);
		const TriangleMesh clean = recipe.make(2000);
		for (const double sigma : {0.0, 0.2}) {
			const TriangleMesh mesh = sigma > 0 ? noisy(clean, sigma) : clean;
			const DenoiseResult result = paper(mesh);
			CHECK(result.status == DenoiseResult::Status::Done);
			CHECK(result.iterations_done == 5);
			REQUIRE(result.positions.size() == mesh.positions.size());
			const double diagonal = bounding_box_diagonal(mesh.positions);
			bool near = true;
			for (std::size_t i = 0; i < result.positions.size(); ++i)
				near = near && result.positions[i].allFinite() &&
					   (result.positions[i] - mesh.positions[i]).norm() < 0.1 * diagonal;
			CHECK(near);
		}
	}
}

TEST_CASE("The paper's method leaves fixed vertices alone", "[paper_method]")
{
	TriangleMesh mesh = noisy(make_height_field(2000), 0.2);
	mesh.fixed.assign(mesh.positions.size(), 0);
	for (std::size_t i = 0; i < mesh.fixed.size(); i += 3)
		mesh.fixed[i] = 1;
	DenoiseOptions options = paper_options();
	options.keep_boundary = true;
	const std::vector<std::uint8_t> boundary = edge_defects(mesh).boundary;
	REQUIRE(std::count(boundary.begin(), boundary.end(), 1) > 50);
	const DenoiseResult result = paper(mesh, options);
	Index moved = 0;
	bool kept = true;
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		const bool same = same_bits(result.positions[i], mesh.positions[i]);
		kept = kept && (same || (mesh.fixed[i] == 0 && boundary[i] == 0));
		moved += same ? 0 : 1;
	}
	CHECK(kept);
	CHECK(moved > mesh.vertex_count() / 2);
	CHECK(moved == result.moved_vertices);
}

TEST_CASE("What the paper's method chose is in the result", "[paper_method]")
{
	const DenoiseOptions resolved = paper(noisy(make_sphere(500), 0.1)).resolved;
	CHECK(resolved.iterations == 5);
	CHECK(resolved.vertex_iterations == 10);
	CHECK(resolved.cos_threshold == 0.65);
	CHECK(resolved.cos_threshold_increment == 0.05);
	CHECK(resolved.structure_ring == resolved.guide_ring + 1);
	CHECK(resolved.threads == 1);

	// The same again with what was chosen spelt out.
	const TriangleMesh mesh = noisy(make_torus(1000), 0.2);
	const DenoiseResult automatic = paper(mesh);
	CHECK(same_bits(paper(mesh, automatic.resolved).positions, automatic.positions));

	DenoiseOptions wide = paper_options();
	wide.guide_ring = 4;
	CHECK(paper(mesh, wide).resolved.structure_ring == 5);
}

TEST_CASE("Every parameter of the paper's method changes the result", "[paper_method]")
{
	const TriangleMesh mesh = noisy(make_torus(1500), 0.2, NoiseDirection::Random);
	const std::vector<Point> expected = paper(mesh).positions;
	using Change = std::function<void(DenoiseOptions&)>;
	const std::vector<std::pair<std::string, Change>> changes = {
		{"iterations", [](DenoiseOptions& o) { o.iterations = 4; }},
		{"vertex_iterations", [](DenoiseOptions& o) { o.vertex_iterations = 9; }},
		{"guide_ring",
		 [](DenoiseOptions& o) {
			 o.guide_ring = 2;
			 o.structure_ring = 2;
		 }},
		{"structure_ring", [](DenoiseOptions& o) { o.structure_ring = 3; }},
		{"sigma_theta", [](DenoiseOptions& o) { o.sigma_theta = 20; }},
		{"cos_threshold", [](DenoiseOptions& o) { o.cos_threshold = 0.75; }},
		{"cos_threshold_increment", [](DenoiseOptions& o) { o.cos_threshold_increment = 0.08; }},
		{"order_x", [](DenoiseOptions& o) { o.order_x = 1; }},
		{"order_y", [](DenoiseOptions& o) { o.order_y = 1; }},
	};
	for (const auto& [name, change] : changes) {
		INFO(name);
		DenoiseOptions options = paper_options();
		change(options);
		CHECK(largest_distance(paper(mesh, options).positions, expected) > 1e-5);
	}
}

TEST_CASE("A threshold that would pass 1 stops below it", "[paper_method]")
{
	// So nearly flat that its faces are similar to each other even there.
	const TriangleMesh mesh = noisy(make_flat_grid(20), 2e-4);
	DenoiseOptions options = paper_options();
	options.cos_threshold = 1;
	options.cos_threshold_increment = 1;
	const std::vector<Point> strict = paper(mesh, options).positions;
	options.cos_threshold = 1 - 1e-6;
	options.cos_threshold_increment = 0;
	CHECK(same_bits(paper(mesh, options).positions, strict));
	options.cos_threshold = 0.9;
	options.cos_threshold_increment = 0.09;
	const std::vector<Point> loose = paper(mesh, options).positions;
	CHECK(largest_distance(loose, strict) < 0.1 * largest_distance(loose, mesh.positions));
}

TEST_CASE("A guide ring wider than the structure ring is refused", "[paper_method]")
{
	DenoiseOptions options = paper_options();
	options.guide_ring = 3;
	options.structure_ring = 2;
	CHECK_THROWS_AS(paper(make_flat_grid(3), options), InvalidParameter);
}

TEST_CASE("Progress of the paper's method is told in words", "[paper_method]")
{
	int last = 0;
	bool monotone = true;
	std::vector<std::string> words;
	Progress progress([&](int percent, const std::string& said) {
		monotone = monotone && percent >= last;
		last = percent;
		if (words.empty() || words.back() != said)
			words.push_back(said);
		return true;
	});
	DenoiseOptions options = paper_options();
	options.iterations = 3;
	denoise(noisy(make_torus(1000), 0.2), options, progress);
	CHECK(monotone);
	CHECK(last == 100);
	for (const std::string iteration : {"1", "2", "3"}) {
		for (const std::string step : {"guide directions", "fitting normals", "moving vertices"}) {
			std::string expected = "iteration ";
			expected.append(iteration).append(" of 3: ").append(step);
			INFO(expected);
			CHECK(std::count(words.begin(), words.end(), expected) == 1);
		}
	}
}

TEST_CASE("The paper's method can be stopped at any time", "[paper_method]")
{
	const TriangleMesh mesh = noisy(make_torus(4000), 0.2);
	for (const std::string where :
		 {"reading the mesh",
		  "iteration 1 of 5: guide directions",
		  "iteration 3 of 5: fitting normals",
		  "iteration 5 of 5: moving vertices"}) {
		INFO(where);
		bool stopped = false;
		int reports_afterwards = 0;
		Progress progress([&](int, const std::string& words) {
			reports_afterwards += stopped ? 1 : 0;
			stopped = stopped || words == where;
			return !stopped;
		});
		const DenoiseResult result = denoise(mesh, paper_options(), progress);
		CHECK(stopped);
		CHECK(reports_afterwards == 0);
		CHECK(result.status == DenoiseResult::Status::Cancelled);
		CHECK(same_bits(result.positions, mesh.positions));
	}
}

TEST_CASE("The paper's method gives the same on any number of threads", "[paper_method][parallel]")
{
	const TriangleMesh mesh = noisy(make_part(8000), 0.2, NoiseDirection::Random);
	DenoiseOptions options = paper_options();
	options.iterations = 2;
	const std::vector<Point> expected = paper(mesh, options).positions;
	for (const int threads : {2, 4}) {
		options.threads = threads;
		CHECK(same_bits(paper(mesh, options).positions, expected));
	}
}
