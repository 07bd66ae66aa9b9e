// SPDX-License-Identifier: GPL-3.0-or-later
#include "normal_filter.h"

#include "shapes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <random>

using namespace orthopoly;

namespace {

NormalField field_of(const FaceGeometry& geometry)
{
	return {geometry.normals, geometry.normals, geometry.areas, geometry.centroids};
}

NormalFilterOptions rings(int smallest, int largest)
{
	NormalFilterOptions options;
	options.smallest_ring = smallest;
	options.largest_ring = largest;
	return options;
}

bool all_unit(const std::vector<Point>& normals)
{
	return std::all_of(normals.begin(), normals.end(), [](const Point& n) {
		return std::abs(n.norm() - 1) < 1e-12;
	});
}

// Each normal turned by some degrees, any way.
std::vector<Point> scattered(std::vector<Point> normals, double degrees)
{
	std::mt19937 generator(4);
	for (Point& n : normals) {
		Point off;
		for (int c = 0; c < 3; ++c)
			off[c] = static_cast<double>(generator()) * 0x1p-31 - 1;
		n = (n + degrees * DEGREE * off).normalized();
	}
	return normals;
}

// Mean angle of the filtered normals of a flat grid to what they were before the noise, degrees.
double angle_to_up(const Workspace& workspace, const NormalField& field)
{
	return mean_angle(
		filter_normals(workspace, field, rings(2, 4)), [](std::size_t) { return Point(0, 0, 1); });
}

// A flat grid bent along its middle: two halves at 40 degrees to each other.
TriangleMesh make_roof(int n)
{
	TriangleMesh mesh = make_flat_grid(n);
	for (Point& p : mesh.positions) {
		const double x = p.x() - 0.5;
		if (x > 1e-9)
			p = Point(0.5 + x * std::cos(40 * DEGREE), p.y(), -x * std::sin(40 * DEGREE));
	}
	return mesh;
}

} // namespace

TEST_CASE("Normals of a plane come back exactly", "[normal_filter]")
{
	const StepFixture f(make_flat_grid(12));
	for (const int largest : {1, 3, 5}) {
		const std::vector<Point> found =
			filter_normals(f.workspace, field_of(f.geometry), rings(1, largest));
		for (const Point& n : found)
			CHECK((n - Point(0, 0, 1)).norm() < 1e-14);
	}
}

TEST_CASE("A wider structure averages more noise away", "[normal_filter]")
{
	const StepFixture f(make_flat_grid(40));
	NormalField field = field_of(f.geometry);
	field.data = scattered(field.data, 10);
	const auto up = [](std::size_t) { return Point(0, 0, 1); };
	double before = mean_angle(field.data, up);
	REQUIRE(before > 4);
	for (const int ring : {1, 2, 3, 5}) {
		const std::vector<Point> found = filter_normals(f.workspace, field, rings(ring, ring));
		CHECK(all_unit(found));
		const double now = mean_angle(found, up);
		CAPTURE(ring);
		CHECK(now < 0.8 * before);
		before = now;
	}
	// Noise of so many faces: what is left is the constant's, and little of anything else.
	CHECK(before < 0.5);
}

TEST_CASE("Normals of a sphere stay radial", "[normal_filter]")
{
	const StepFixture f(make_sphere(8000));
	const auto radial = [&](std::size_t i) { return f.geometry.centroids[i].normalized(); };
	const NormalField clean = field_of(f.geometry);
	// A structure of three rings reaches 10 degrees: its middle alone would be off by half of that
	// at its rim.
	CHECK(mean_angle(filter_normals(f.workspace, clean, rings(2, 4)), radial) < 0.1);

	NormalField field = clean;
	field.data = scattered(field.data, 15);
	const double noise = mean_angle(field.data, radial);
	REQUIRE(noise > 6);
	CHECK(mean_angle(filter_normals(f.workspace, field, rings(2, 4)), radial) < 0.2 * noise);
}

TEST_CASE("Both sides of a sharp edge keep to themselves", "[normal_filter]")
{
	const StepFixture f(make_box({10, 10, 10}, Point(1, 1, 1)));
	const auto truth = [&](std::size_t i) { return f.geometry.normals[i]; };
	const NormalField clean = field_of(f.geometry);
	const std::vector<Point> same = filter_normals(f.workspace, clean, rings(2, 4));
	for (std::size_t i = 0; i < same.size(); ++i)
		REQUIRE((same[i] - truth(i)).norm() < 1e-13);

	NormalField field = clean;
	field.data = scattered(field.data, 20);
	const std::vector<Point> found = filter_normals(f.workspace, field, rings(2, 4));
	CHECK(mean_angle(field.data, truth) > 8);
	double worst = 0;
	for (std::size_t i = 0; i < found.size(); ++i)
		worst = std::max(worst, angle_between(found[i], truth(i)) / DEGREE);
	CHECK(worst < 8);
	CHECK(mean_angle(found, truth) < 2);
}

TEST_CASE("What lies across an edge changes no bit", "[normal_filter]")
{
	const StepFixture f(make_box({10, 10, 10}, Point(1, 1, 1)));
	NormalField field = field_of(f.geometry);
	field.data = scattered(field.data, 10);
	NormalFilterOptions options = rings(2, 2);
	// Every coefficient stays, so that the floor, which all share, is out of the question.
	options.selection = 0;
	const std::vector<Point> expected = filter_normals(f.workspace, field, options);
	const auto is_top = [&](std::size_t i) { return f.geometry.normals[i].z() > 0.5; };
	for (std::size_t i = 0; i < field.data.size(); ++i) {
		if (is_top(i))
			field.data[i] = (field.data[i] + Point(0.1, 0, 0)).normalized();
	}
	const std::vector<Point> found = filter_normals(f.workspace, field, options);
	for (std::size_t i = 0; i < found.size(); ++i)
		CHECK(same_bits(found[i], expected[i]) == !is_top(i));
}

TEST_CASE("A bend beyond the threshold is kept, one within is taken along", "[normal_filter]")
{
	const StepFixture f(make_roof(20));
	const auto largest_change = [&](double cosine) {
		NormalFilterOptions options = rings(3, 3);
		options.cos_threshold = cosine;
		const std::vector<Point> found = filter_normals(f.workspace, field_of(f.geometry), options);
		double worst = 0;
		for (std::size_t i = 0; i < found.size(); ++i)
			worst = std::max(worst, angle_between(found[i], f.geometry.normals[i]) / DEGREE);
		return worst;
	};
	CHECK(largest_change(std::cos(38 * DEGREE)) < 1e-6);
	CHECK(largest_change(std::cos(42 * DEGREE)) > 2);
}

TEST_CASE(
	"A looser structure is taken where the surface bends, and not across an edge",
	"[normal_filter]")
{
	NormalFilterOptions strict = rings(3, 3);
	strict.cos_threshold = std::cos(12 * DEGREE);
	NormalFilterOptions loose = strict;
	loose.loosening = strict.cos_threshold - std::cos(50 * DEGREE);
	const auto angle = [](const StepFixture& f, const NormalFilterOptions& options) {
		NormalField field = field_of(f.geometry);
		field.data = scattered(field.data, 8);
		return mean_angle(filter_normals(f.workspace, field, options), [&](std::size_t i) {
			return f.geometry.normals[i];
		});
	};
	const StepFixture sphere(make_sphere(600));
	CHECK(angle(sphere, loose) < 0.8 * angle(sphere, strict));
	const StepFixture edge(make_roof(24));
	CHECK(angle(edge, loose) < 1.1 * angle(edge, strict));
}

TEST_CASE("Faces that noise scatters more are not taken for features", "[normal_filter]")
{
	// Half of the faces scatter five times as much, as small ones do. What stands out of the floor
	// that the others give is not curvature there.
	const StepFixture f(make_flat_grid(40));
	NormalField field = field_of(f.geometry);
	const std::vector<Point> little = scattered(field.data, 2);
	const std::vector<Point> much = scattered(field.data, 10);
	std::vector<double> scatters(field.data.size());
	for (std::size_t i = 0; i < scatters.size(); ++i) {
		const bool is_small = field.nodes[i].x() > 0.5;
		scatters[i] = is_small ? 25 : 1;
		field.data[i] = is_small ? much[i] : little[i];
	}
	const double alike = angle_to_up(f.workspace, field);
	field.scatters = scatters;
	CHECK(angle_to_up(f.workspace, field) < 0.9 * alike);
}

TEST_CASE("The noise is told by the faces that have some", "[normal_filter]")
{
	// By all of them there would be next to none.
	const StepFixture f(make_flat_grid(40));
	NormalField field = field_of(f.geometry);
	const std::vector<Point> scattered_all = scattered(field.data, 10);
	std::vector<std::uint8_t> noisy(field.data.size());
	field.scatters.resize(field.data.size());
	for (std::size_t i = 0; i < noisy.size(); ++i) {
		noisy[i] = field.nodes[i].x() > 0.5 ? 1 : 0;
		field.scatters[i] = noisy[i] != 0 ? 1 : 0.01;
		if (noisy[i] != 0)
			field.data[i] = scattered_all[i];
	}
	const double by_all = angle_to_up(f.workspace, field);
	field.noisy = noisy;
	CHECK(angle_to_up(f.workspace, field) < 0.8 * by_all);
}

TEST_CASE("Faces without a guide or a weight take no part", "[normal_filter]")
{
	const StepFixture f(make_flat_grid(12));
	NormalField field = field_of(f.geometry);
	field.data = scattered(field.data, 10);
	const std::size_t guideless = 100;
	const std::size_t weightless = 180;
	field.guides[guideless] = Point::Zero();
	field.weights[weightless] = 0;
	const std::vector<Point> expected = filter_normals(f.workspace, field, rings(2, 3));
	CHECK(same_bits(expected[guideless], field.data[guideless]));
	CHECK(same_bits(expected[weightless], field.data[weightless]));
	// Whatever they say, nobody hears.
	field.data[guideless] = Point(1, 0, 0);
	field.data[weightless] = Point(0, 1, 0);
	const std::vector<Point> found = filter_normals(f.workspace, field, rings(2, 3));
	for (std::size_t i = 0; i < found.size(); ++i)
		CHECK(same_bits(found[i], expected[i]) == (i != guideless && i != weightless));
}

TEST_CASE("A face alone keeps its data", "[normal_filter]")
{
	const StepFixture f(tetrahedron());
	const NormalField field = field_of(f.geometry);
	const std::vector<Point> found = filter_normals(f.workspace, field, rings(1, 3));
	for (std::size_t i = 0; i < found.size(); ++i)
		CHECK((found[i] - field.data[i]).norm() < 1e-14);
}

TEST_CASE("Strict selection drops what is noise", "[normal_filter]")
{
	const StepFixture f(make_flat_grid(40));
	NormalField field = field_of(f.geometry);
	field.data = scattered(field.data, 10);
	const auto up = [](std::size_t) { return Point(0, 0, 1); };
	NormalFilterOptions options = rings(3, 3);
	options.selection = 0;
	const double all = mean_angle(filter_normals(f.workspace, field, options), up);
	options.selection = 9;
	CHECK(mean_angle(filter_normals(f.workspace, field, options), up) < 0.75 * all);
	// And keeps what is not: dropping that costs, most of all at the ends of the surface.
	const auto bent = [&](std::size_t i) {
		const double angle = 0.8 * (f.geometry.centroids[i].x() - 0.5);
		return Point(std::sin(angle), 0, std::cos(angle));
	};
	for (std::size_t i = 0; i < field.data.size(); ++i)
		field.data[i] = bent(i);
	field.data = scattered(field.data, 2);
	options = rings(4, 4);
	const double kept = mean_angle(filter_normals(f.workspace, field, options), bent);
	options.selection = 1e9;
	CHECK(kept < 0.7 * mean_angle(filter_normals(f.workspace, field, options), bent));
}

TEST_CASE("Filtered normals turn and grow with the mesh", "[normal_filter]")
{
	const TriangleMesh mesh = noisy(make_part(4000), 0.15);
	const StepFixture f(mesh);
	const std::vector<Point> expected =
		filter_normals(f.workspace, field_of(f.geometry), rings(2, 4));
	const Eigen::Matrix3d rotation = some_rotation();
	for (const double scale : {1e-3, 1.0, 1e3}) {
		TriangleMesh there = mesh;
		there.positions =
			each(mesh.positions, [&](const Point& p) { return Point(scale * (rotation * p)); });
		const StepFixture moved(there);
		const std::vector<Point> found =
			filter_normals(moved.workspace, field_of(moved.geometry), rings(2, 4));
		// A choice that hangs by a hair may fall the other way; hardly any does.
		std::size_t differing = 0;
		for (std::size_t i = 0; i < found.size(); ++i)
			differing += (found[i] - rotation * expected[i]).norm() > 1e-9 ? 1U : 0U;
		CHECK(differing < found.size() / 50);
	}
}

TEST_CASE("Filtered normals are the same on any number of threads", "[normal_filter][parallel]")
{
	const TriangleMesh mesh = noisy(make_part(8000), 0.2);
	const StepFixture one(mesh, 1);
	const std::vector<Point> expected =
		filter_normals(one.workspace, field_of(one.geometry), rings(2, 4));
	CHECK(all_unit(expected));
	for (const int threads : {2, 4}) {
		const StepFixture several(mesh, threads);
		CHECK(same_bits(
			filter_normals(several.workspace, field_of(several.geometry), rings(2, 4)), expected));
	}
}

TEST_CASE("Wide lanes give the same bits for normals", "[normal_filter]")
{
	if (!has_wide_lanes()) {
		WARN("this processor has no wide lanes; nothing to compare");
		return;
	}
	const StepFixture f(noisy(make_part(4000), 0.2));
	for (const int largest : {2, 6}) {
		NormalFilterOptions options = rings(2, largest);
		options.loosening = 0.25;
		const auto found = [&](bool wide) {
			options.wide_lanes = wide;
			return filter_normals(f.workspace, field_of(f.geometry), options);
		};
		CHECK(same_bits(found(true), found(false)));
	}
}

TEST_CASE("The normal filter can be stopped", "[normal_filter]")
{
	const TriangleMesh mesh = make_flat_grid(10);
	bool go_on = true;
	Progress progress([&](int, const std::string&) { return go_on; });
	Execution execution(1, progress);
	const Workspace workspace(mesh, execution);
	go_on = false;
	progress.report(1, "stop");
	const FaceGeometry geometry = face_geometry(mesh.positions, mesh.faces);
	CHECK_THROWS_AS(filter_normals(workspace, field_of(geometry), {}), Cancelled);
}
