// SPDX-License-Identifier: GPL-3.0-or-later
#include "vertex_update.h"

#include "step_fixture.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

// Two triangles side by side, the second twice as large as the first; vertices 1 and 2 are shared.
TriangleMesh make_two_triangles()
{
	TriangleMesh mesh;
	mesh.positions = {Point(0, 0, 0), Point(2, 0, 0), Point(0, 2, 0), Point(4, 2, 1)};
	mesh.faces = {{0, 1, 2}, {2, 1, 3}};
	return mesh;
}

std::vector<Point>
updated(const StepFixture& f, const std::vector<Point>& normals, VertexUpdateOptions options = {})
{
	std::vector<Point> positions = f.mesh.positions;
	update_vertices(f.workspace, normals, options, positions);
	return positions;
}

double root_mean_square_height(const std::vector<Point>& positions)
{
	double sum = 0;
	for (const Point& p : positions)
		sum += p.z() * p.z();
	return std::sqrt(sum / static_cast<double>(positions.size()));
}

} // namespace

TEST_CASE("One step is eq. 12 by hand", "[vertex_update]")
{
	const StepFixture f(make_two_triangles());
	const std::vector<Point> normals = {Point(0, 0.6, 0.8), Point(-2.0 / 3, 1.0 / 3, 2.0 / 3)};
	VertexUpdateOptions options;
	options.iterations = 1;
	const Point c0 = Point(2, 2, 0) / 3;
	const Point c1 = Point(6, 4, 1) / 3;
	const auto towards = [](const Point& x, const Point& n, const Point& c) {
		return Point(n * n.dot(c - x));
	};

	const std::vector<Point>& x = f.mesh.positions;
	const std::vector<Point> equal = updated(f, normals, options);
	CHECK((equal[0] - x[0] - towards(x[0], normals[0], c0)).norm() < 1e-15);
	CHECK((equal[3] - x[3] - towards(x[3], normals[1], c1)).norm() < 1e-15);
	const Point both = towards(x[1], normals[0], c0) + towards(x[1], normals[1], c1);
	CHECK((equal[1] - x[1] - both / 2).norm() < 1e-15);

	options.area_weights = true;
	const double a0 = f.geometry.areas[0];
	const double a1 = f.geometry.areas[1];
	REQUIRE(a1 > 1.5 * a0);
	const std::vector<Point> weighted = updated(f, normals, options);
	const Point sum = a0 * towards(x[1], normals[0], c0) + a1 * towards(x[1], normals[1], c1);
	CHECK((weighted[1] - x[1] - sum / (a0 + a1)).norm() < 1e-15);
	CHECK((weighted[1] - equal[1]).norm() > 1e-3);
}

TEST_CASE("A mesh whose faces already have the normals of a plane stays put", "[vertex_update]")
{
	for (const double scale : {1e-6, 1.0, 1e6}) {
		for (const double distance : {0.0, 1e3}) {
			TriangleMesh mesh = make_flat_grid(10);
			const Eigen::Matrix3d rotation = some_rotation();
			mesh.positions = each(mesh.positions, [&](const Point& p) {
				return Point(scale * (rotation * p + Point::Constant(distance)));
			});
			const StepFixture f(mesh);
			const double rounding = 1e-15 * scale * (1 + distance);
			CHECK(largest_distance(updated(f, f.geometry.normals), mesh.positions) < 40 * rounding);
		}
	}
}

TEST_CASE("Normals of a plane flatten a bumpy one, and nothing else", "[vertex_update]")
{
	const StepFixture f(noisy(make_flat_grid(20), 0.3));
	const std::vector<Point> up(f.mesh.faces.size(), Point(0, 0, 1));
	double before = root_mean_square_height(f.mesh.positions);
	REQUIRE(before > 0.01);
	for (const int steps : {1, 3, 10, 40}) {
		VertexUpdateOptions options;
		options.iterations = steps;
		const std::vector<Point> positions = updated(f, up, options);
		const double after = root_mean_square_height(positions);
		CHECK(after < 0.8 * before);
		before = after;
		double sideways = 0;
		for (std::size_t i = 0; i < positions.size(); ++i)
			sideways += (positions[i] - f.mesh.positions[i]).head<2>().lpNorm<Eigen::Infinity>();
		CHECK(sideways == 0);
	}
}

TEST_CASE("Accelerated steps do as much as twice as many plain ones", "[vertex_update]")
{
	const StepFixture f(noisy(make_flat_grid(40), 0.3));
	const std::vector<Point> up(f.mesh.faces.size(), Point(0, 0, 1));
	const auto height_after = [&](int steps, bool accelerated) {
		VertexUpdateOptions options;
		options.iterations = steps;
		options.area_weights = true;
		options.accelerated = accelerated;
		return root_mean_square_height(updated(f, up, options));
	};
	CHECK(height_after(1, true) == Approx(height_after(1, false)).epsilon(0.01));
	for (const int steps : {8, 10, 20}) {
		CAPTURE(steps);
		CHECK(height_after(steps, true) < height_after(2 * steps, false));
		CHECK(height_after(steps, true) > 0.5 * height_after(4 * steps, false));
	}
}

TEST_CASE("A vertex takes its own share of a step", "[vertex_update]")
{
	const StepFixture f(noisy(make_flat_grid(20), 0.2));
	const std::vector<Point> normals(f.mesh.faces.size(), Point(0, 0, 1));
	VertexUpdateOptions options;
	options.iterations = 1;
	const std::vector<Point> whole = updated(f, normals, options);
	std::vector<double> paces(f.mesh.positions.size(), 1);
	for (std::size_t i = 0; i < paces.size(); i += 2)
		paces[i] = 0.25;
	options.paces = &paces;
	const std::vector<Point> found = updated(f, normals, options);
	for (std::size_t i = 0; i < paces.size(); ++i) {
		const Point& from = f.mesh.positions[i];
		CHECK((found[i] - from - paces[i] * (whole[i] - from)).norm() < 1e-15);
	}
}

TEST_CASE("A vertex is pulled to its rest only where its normals leave it free", "[vertex_update]")
{
	const StepFixture f(noisy(make_flat_grid(20), 0.2));
	VertexUpdateOptions options;
	options.area_weights = true;
	std::vector<Point> rest = f.mesh.positions;
	// Where all normals agree with the surface nothing is pulled, not even along it.
	{
		const StepFixture flat(make_flat_grid(20));
		const std::vector<Point> aside =
			each(flat.mesh.positions, [](const Point& p) { return Point(p + Point(0.1, 0, 0)); });
		options.rest = &aside;
		const std::vector<Point> up(flat.mesh.faces.size(), Point(0, 0, 1));
		CHECK(largest_distance(updated(flat, up, options), flat.mesh.positions) < 1e-14);
	}
	// Along normals that all agree nothing is pulled, however far off the surface is.
	const std::vector<Point> up(f.mesh.faces.size(), Point(0, 0, 1));
	for (Point& p : rest)
		p.z() += 1;
	options.rest = nullptr;
	const std::vector<Point> free = updated(f, up, options);
	options.rest = &rest;
	CHECK(largest_distance(updated(f, up, options), free) < 1e-14);

	// Normals that do not agree with each other let vertices slide; a rest holds them.
	std::vector<Point> wild;
	for (std::size_t i = 0; i < f.mesh.faces.size(); ++i) {
		const double angle = 2.4 * static_cast<double>(i);
		wild.push_back(Point(0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.8));
	}
	options.iterations = 100;
	options.rest = &f.mesh.positions;
	const auto mean_move = [&](const std::vector<Point>& positions) {
		double sum = 0;
		for (std::size_t i = 0; i < positions.size(); ++i)
			sum += (positions[i] - f.mesh.positions[i]).head<2>().norm();
		return sum / static_cast<double>(positions.size());
	};
	const double held = mean_move(updated(f, wild, options));
	options.rest = nullptr;
	CHECK(held < 0.8 * mean_move(updated(f, wild, options)));
}

TEST_CASE("Vertices that may not or cannot move keep every bit", "[vertex_update]")
{
	TriangleMesh mesh = noisy(make_flat_grid(6), 0.3);
	mesh.positions.emplace_back(0.1, 0.2, 0.3); // no face
	mesh.fixed.assign(mesh.positions.size(), 0);
	mesh.fixed[10] = mesh.fixed[24] = 1;
	const StepFixture f(mesh);
	std::vector<Point> normals(mesh.faces.size(), Point(0, 0, 1));
	normals[0] = normals[1] = Point::Zero(); // all faces of vertex 0
	const std::vector<Point> positions = updated(f, normals);
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const bool stays = i == 0 || i == 10 || i == 24 || i + 1 == positions.size();
		INFO("vertex " << i);
		CHECK(same_bits(positions[i], mesh.positions[i]) == stays);
	}
}

TEST_CASE("A face without a normal is left out of the mean", "[vertex_update]")
{
	const StepFixture f(make_two_triangles());
	const std::vector<Point> normals = {Point(0, 0.6, 0.8), Point::Zero()};
	VertexUpdateOptions options;
	options.iterations = 1;
	const Point& x = f.mesh.positions[1];
	const Point expected = x + normals[0] * normals[0].dot(Point(2, 2, 0) / 3 - x);
	CHECK((updated(f, normals, options)[1] - expected).norm() < 1e-15);
}

TEST_CASE("No step leaves the mesh as it is", "[vertex_update]")
{
	const StepFixture f(noisy(make_flat_grid(4), 0.3));
	VertexUpdateOptions options;
	options.iterations = 0;
	CHECK(same_bits(updated(f, f.geometry.normals, options), f.mesh.positions));
}

TEST_CASE("Vertices move the same on any number of threads", "[vertex_update][parallel]")
{
	const TriangleMesh mesh = noisy(make_torus(20000), 0.2);
	const StepFixture one(mesh, 1);
	for (const bool adaptive : {false, true}) {
		VertexUpdateOptions options;
		options.area_weights = adaptive;
		options.accelerated = adaptive;
		options.rest = adaptive ? &mesh.positions : nullptr;
		const std::vector<Point> expected = updated(one, one.geometry.normals, options);
		for (const int threads : {2, 4}) {
			const StepFixture several(mesh, threads);
			CHECK(same_bits(updated(several, several.geometry.normals, options), expected));
		}
	}
}

TEST_CASE("The vertex update can be stopped", "[vertex_update]")
{
	const TriangleMesh mesh = make_flat_grid(4);
	bool go_on = true;
	Progress progress([&](int, const std::string&) { return go_on; });
	Execution execution(1, progress);
	const Workspace workspace(mesh, execution);
	go_on = false;
	progress.report(1, "stop");
	std::vector<Point> positions = mesh.positions;
	const std::vector<Point> normals(mesh.faces.size(), Point(0, 0, 1));
	CHECK_THROWS_AS(update_vertices(workspace, normals, {}, positions), Cancelled);
}
