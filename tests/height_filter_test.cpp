// SPDX-License-Identifier: GPL-3.0-or-later
#include "height_filter.h"

#include "shapes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

HeightFilterOptions options_of(double sigma, int smallest, int largest)
{
	HeightFilterOptions options;
	options.sigma = sigma;
	options.smallest_ring = smallest;
	options.largest_ring = largest;
	return options;
}

// The height of a cubic surface over [0, 1]^2, gentle enough for one guide.
double cubic(double x, double y)
{
	return 0.1 * x - 0.2 * y + 0.15 * x * x - 0.1 * x * y + 0.05 * y * y + 0.1 * x * x * x -
		   0.12 * x * x * y + 0.07 * x * y * y - 0.06 * y * y * y;
}

Point cubic_normal(double x, double y)
{
	return Point(
			   -(0.1 + 0.3 * x - 0.1 * y + 0.3 * x * x - 0.24 * x * y + 0.07 * y * y),
			   -(-0.2 - 0.1 * x + 0.1 * y - 0.12 * x * x + 0.14 * x * y - 0.18 * y * y),
			   1)
		.normalized();
}

std::vector<Point> filtered_normals(
	const Workspace& workspace, const HeightField& field, const HeightFilterOptions& options)
{
	return normals_from_heights(workspace, field, options).normals;
}

} // namespace

TEST_CASE("Vertices on a plane give its normal, whatever the guides", "[height_filter]")
{
	const Eigen::Matrix3d rotation = some_rotation();
	TriangleMesh mesh = noisy(make_flat_grid(15), 0.2, NoiseDirection::Isotropic);
	for (Point& p : mesh.positions)
		p = rotation * Point(p.x(), p.y(), 0);
	const StepFixture f(mesh);
	std::vector<Point> guides;
	for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
		const double turn = double(i);
		guides.push_back(
			rotation * Point(0.1 * std::cos(turn), 0.1 * std::sin(turn), 1).normalized());
	}
	const double sigma = 0.01 * f.workspace.mean_edge_length;
	const std::vector<Point> found = filtered_normals(
		f.workspace, {guides, f.geometry.centroids, mesh.positions}, options_of(sigma, 1, 4));
	for (const Point& n : found)
		CHECK((n - rotation * Point(0, 0, 1)).norm() < 1e-11);
}

TEST_CASE("A cubic surface comes back exactly", "[height_filter]")
{
	TriangleMesh mesh = noisy(make_flat_grid(15), 0.15, NoiseDirection::Isotropic);
	for (Point& p : mesh.positions)
		p.z() = cubic(p.x(), p.y());
	const Eigen::Matrix3d rotation = some_rotation();
	TriangleMesh turned = mesh;
	turned.positions =
		each(mesh.positions, [&](const Point& p) { return Point(1e-3 * (rotation * p)); });
	const StepFixture f(turned);
	const std::vector<Point> guides(mesh.faces.size(), rotation * Point(0, 0, 1));
	// Without noise every coefficient counts.
	const std::vector<Point> found = filtered_normals(
		f.workspace, {guides, f.geometry.centroids, turned.positions}, options_of(0, 4, 4));
	const FaceGeometry geometry = face_geometry(mesh.positions, mesh.faces);
	for (std::size_t i = 0; i < found.size(); ++i) {
		const Point expected = cubic_normal(geometry.centroids[i].x(), geometry.centroids[i].y());
		CHECK((found[i] - rotation * expected).norm() < 1e-9);
	}
}

TEST_CASE("A wider structure sees through more noise", "[height_filter]")
{
	const StepFixture f(noisy(make_flat_grid(40), 0.3));
	const double sigma = 0.3 * make_flat_grid(40).positions[1].x();
	const std::vector<Point> guides(f.mesh.faces.size(), Point(0, 0, 1));
	const auto up = [](std::size_t) { return Point(0, 0, 1); };
	double before = mean_angle(f.geometry.normals, up);
	for (const int ring : {1, 2, 3, 5}) {
		const double now = mean_angle(
			filtered_normals(
				f.workspace,
				{guides, f.geometry.centroids, f.mesh.positions},
				options_of(sigma, ring, ring)),
			up);
		CAPTURE(ring);
		CHECK(now < 0.7 * before);
		before = now;
	}
	CHECK(before < 1);
}

TEST_CASE("Wide structures are taken on plain faces, and not over detail", "[height_filter]")
{
	TriangleMesh flat = make_flat_grid(60);
	TriangleMesh wavy = flat;
	for (Point& p : wavy.positions)
		p.z() = 0.01 * std::sin(30 * p.x()) * std::sin(30 * p.y());
	for (const bool has_detail : {false, true}) {
		CAPTURE(has_detail);
		const TriangleMesh& truth = has_detail ? wavy : flat;
		const FaceGeometry clean = face_geometry(truth.positions, truth.faces);
		const StepFixture f(noisy(truth, 0.2));
		const double sigma = 0.2 * mean_edge_length(truth.positions, truth.faces);
		const auto error = [&](int largest, int faces) {
			HeightFilterOptions options = options_of(sigma, 1, largest);
			options.faces_per_structure = faces;
			return mean_angle(
				filtered_normals(
					f.workspace, {clean.normals, clean.centroids, f.mesh.positions}, options),
				[&](std::size_t i) { return clean.normals[i]; });
		};
		for (const int faces : {1, 4}) {
			CAPTURE(faces);
			CHECK(error(14, faces) < (has_detail ? 1.05 : 0.6) * error(7, faces));
		}
	}
}

TEST_CASE("On a noisy sphere normals are radial", "[height_filter]")
{
	const TriangleMesh sphere = make_sphere(8000);
	const FaceGeometry clean = face_geometry(sphere.positions, sphere.faces);
	const StepFixture f(noisy(sphere, 0.2));
	const double sigma = 0.2 * mean_edge_length(sphere.positions, sphere.faces);
	const std::vector<Point> found = filtered_normals(
		f.workspace, {clean.normals, clean.centroids, f.mesh.positions}, options_of(sigma, 1, 5));
	const auto radial = [&](std::size_t i) { return clean.centroids[i].normalized(); };
	CHECK(mean_angle(f.geometry.normals, radial) > 15);
	CHECK(mean_angle(found, radial) < 1.5);
}

TEST_CASE("Structures end at an edge the guides know", "[height_filter]")
{
	const TriangleMesh box = make_box({12, 12, 12}, Point(1, 1, 1));
	const FaceGeometry clean = face_geometry(box.positions, box.faces);
	const StepFixture exact(box);
	const double edge = exact.workspace.mean_edge_length;
	// Heights of the vertices on the edge count on both sides and are right on both.
	for (const Point& n : {Point(1, 0, 0), Point(0, -1, 0), Point(0, 0, 1)}) {
		const std::vector<Point> found = filtered_normals(
			exact.workspace,
			{clean.normals, clean.centroids, box.positions},
			options_of(0.1 * edge, 1, 5));
		for (std::size_t i = 0; i < found.size(); ++i) {
			if (clean.normals[i].dot(n) > 0.5)
				CHECK((found[i] - n).norm() < 1e-12);
		}
	}
	// What happens to vertices in the middle of the top is not felt on the sides.
	const std::vector<Point> expected = filtered_normals(
		exact.workspace,
		{clean.normals, clean.centroids, box.positions},
		options_of(0.1 * edge, 1, 5));
	std::vector<Point> bumpy = box.positions;
	for (Point& p : bumpy) {
		if (p.z() > 0.49 && std::abs(p.x()) < 0.49 && std::abs(p.y()) < 0.49)
			p.z() += 0.3 * edge * std::sin(40 * p.x()) * std::cos(50 * p.y());
	}
	const std::vector<Point> found = filtered_normals(
		exact.workspace, {clean.normals, clean.centroids, bumpy}, options_of(0.1 * edge, 1, 5));
	std::size_t changed = 0;
	for (std::size_t i = 0; i < found.size(); ++i) {
		const bool same = same_bits(found[i], expected[i]);
		if (clean.normals[i].z() < 0.5)
			CHECK(same);
		else
			changed += same ? 0U : 1U;
	}
	CHECK(changed > 200);
}

TEST_CASE("Votes spread where structures do not know about an edge", "[height_filter]")
{
	const TriangleMesh box = make_box({12, 12, 12}, Point(1, 1, 1));
	const StepFixture f(box);
	std::vector<Point> guides = f.geometry.normals;
	const HeightFilterOptions options = options_of(0.1 * f.workspace.mean_edge_length, 1, 5);
	const auto worst = [&](double from, double to) {
		const std::vector<double> spreads =
			normals_from_heights(
				f.workspace, {guides, f.geometry.centroids, box.positions}, options)
				.spreads;
		double result = 0;
		for (std::size_t i = 0; i < spreads.size(); ++i) {
			const double place = f.geometry.centroids[i].x();
			if (place > from && place < to)
				result = std::max(result, spreads[i]);
		}
		return result;
	};
	CHECK(worst(-1, 1) < 1e-12);
	// Nearly the same for all faces near the edges at x = 0.5.
	for (std::size_t i = 0; i < guides.size(); ++i) {
		if (f.geometry.centroids[i].x() > 0.38)
			guides[i] = Point(1, 0.4 * guides[i].y(), 0.4 * guides[i].z()).normalized();
	}
	CHECK(worst(0.38, 1) > 0.01);
	CHECK(worst(-1, 0) < 1e-12);
}

TEST_CASE("Heights of a face without a guide or without company", "[height_filter]")
{
	const StepFixture f(noisy(make_flat_grid(12), 0.1));
	std::vector<Point> guides(f.mesh.faces.size(), Point(0, 0, 1));
	guides[100] = Point::Zero();  // left out
	guides[180] = Point(1, 0, 0); // similar to nobody: three vertices fix no plane
	const HeightNormals result = normals_from_heights(
		f.workspace,
		{guides, f.geometry.centroids, f.mesh.positions},
		options_of(0.1 * f.workspace.mean_edge_length, 1, 3));
	const std::vector<Point>& found = result.normals;
	CHECK(same_bits(found[100], guides[100]));
	CHECK(same_bits(found[180], guides[180]));
	CHECK(result.spreads[100] == 1);
	CHECK(result.spreads[180] == 1);
	CHECK(result.spreads[101] < 0.1);
	for (std::size_t i = 0; i < found.size(); ++i) {
		if (i != 100 && i != 180)
			CHECK(found[i].norm() == Approx(1));
	}
}

TEST_CASE("Strict selection drops curvature that is noise", "[height_filter]")
{
	const StepFixture f(noisy(make_flat_grid(40), 0.3));
	const std::vector<Point> guides(f.mesh.faces.size(), Point(0, 0, 1));
	const auto angle = [&](double selection) {
		HeightFilterOptions options = options_of(0.3 / 40, 4, 4);
		options.selection = selection;
		return mean_angle(
			filtered_normals(
				f.workspace, {guides, f.geometry.centroids, f.mesh.positions}, options),
			[](std::size_t) { return Point(0, 0, 1); });
	};
	CHECK(angle(9) < 0.7 * angle(0));
}

TEST_CASE("A looser structure of heights is taken where the surface bends", "[height_filter]")
{
	const TriangleMesh clean = make_sphere(600);
	const FaceGeometry truth = face_geometry(clean.positions, clean.faces);
	const StepFixture f(noisy(clean, 0.15));
	const auto angle = [&](double loosening) {
		HeightFilterOptions options = options_of(0.15 * f.workspace.mean_edge_length, 1, 5);
		options.loosening = loosening;
		return mean_angle(
			filtered_normals(
				f.workspace, {truth.normals, truth.centroids, f.mesh.positions}, options),
			[&](std::size_t i) { return truth.normals[i]; });
	};
	CHECK(angle(0.15) < 0.95 * angle(0));
}

TEST_CASE("Normals from heights turn and grow with the mesh", "[height_filter]")
{
	const TriangleMesh clean = make_part(4000);
	const FaceGeometry guide = face_geometry(clean.positions, clean.faces);
	const TriangleMesh mesh = noisy(clean, 0.15);
	const StepFixture f(mesh);
	const double sigma = 0.15 * f.workspace.mean_edge_length;
	const std::vector<Point> expected = filtered_normals(
		f.workspace, {guide.normals, guide.centroids, mesh.positions}, options_of(sigma, 1, 5));
	const Eigen::Matrix3d rotation = some_rotation();
	for (const double scale : {1e-3, 1.0, 1e3}) {
		const auto there = [&](const Point& p) { return Point(scale * (rotation * p)); };
		const auto turn = [&](const Point& p) { return Point(rotation * p); };
		TriangleMesh moved_mesh = mesh;
		moved_mesh.positions = each(mesh.positions, there);
		const StepFixture moved(moved_mesh);
		const std::vector<Point> found = filtered_normals(
			moved.workspace,
			{each(guide.normals, turn), each(guide.centroids, there), moved_mesh.positions},
			options_of(scale * sigma, 1, 5));
		// Guides that all agree to the last bit leave the axes to chance; the flat parts of this
		// mesh have such, and there choices may differ.
		std::size_t differing = 0;
		for (std::size_t i = 0; i < found.size(); ++i)
			differing += (found[i] - rotation * expected[i]).norm() > 1e-9 ? 1U : 0U;
		CHECK(differing < found.size() / 2);
		CHECK(
			mean_angle(found, [&](std::size_t i) { return Point(rotation * expected[i]); }) < 0.1);
	}
}

TEST_CASE("Normals from heights are the same on any number of threads", "[height_filter][parallel]")
{
	const TriangleMesh mesh = noisy(make_part(8000), 0.15);
	const StepFixture one(mesh, 1);
	const auto found = [&](const StepFixture& f) {
		return filtered_normals(
			f.workspace,
			{f.geometry.normals, f.geometry.centroids, mesh.positions},
			options_of(0.15 * f.workspace.mean_edge_length, 1, 5));
	};
	const std::vector<Point> expected = found(one);
	for (const int threads : {2, 4})
		CHECK(same_bits(found(StepFixture(mesh, threads)), expected));
}

TEST_CASE("Wide lanes give the same bits for heights", "[height_filter]")
{
	if (!has_wide_lanes()) {
		WARN("this processor has no wide lanes; nothing to compare");
		return;
	}
	const StepFixture f(noisy(make_part(4000), 0.15));
	// Those of the mesh without noise: structures with all faces as members, and with some.
	const FaceGeometry clean = face_geometry(make_part(4000).positions, f.mesh.faces);
	for (const int rings : {2, 7}) {
		HeightFilterOptions options = options_of(0.15 * f.workspace.mean_edge_length, 1, rings);
		options.loosening = 0.15;
		const auto found = [&](bool wide) {
			options.wide_lanes = wide;
			return filtered_normals(
				f.workspace, {clean.normals, f.geometry.centroids, f.mesh.positions}, options);
		};
		CHECK(same_bits(found(true), found(false)));
	}
}

TEST_CASE("The height filter can be stopped", "[height_filter]")
{
	const TriangleMesh mesh = make_flat_grid(10);
	bool go_on = true;
	Progress progress([&](int, const std::string&) { return go_on; });
	Execution execution(1, progress);
	const Workspace workspace(mesh, execution);
	go_on = false;
	progress.report(1, "stop");
	const FaceGeometry geometry = face_geometry(mesh.positions, mesh.faces);
	CHECK_THROWS_AS(
		filtered_normals(workspace, {geometry.normals, geometry.centroids, mesh.positions}, {}),
		Cancelled);
}

TEST_CASE("Vertices with more noise than others say less", "[height_filter]")
{
	// Every other vertex has eight times the noise.
	const TriangleMesh flat = make_flat_grid(40);
	const double edge = mean_edge_length(flat.positions, flat.faces);
	std::vector<double> factors;
	TriangleMesh mesh = noisy(flat, 0.05);
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		factors.push_back(i % 2 == 0 ? 1 : 8);
		mesh.positions[i].z() *= factors.back();
	}
	const StepFixture f(mesh);
	const std::vector<Point> guides(mesh.faces.size(), Point(0, 0, 1));
	const auto angle = [&](const Deviations& sigma) {
		HeightFilterOptions options = options_of(0, 3, 3);
		options.sigma = sigma;
		return mean_angle(
			filtered_normals(f.workspace, {guides, f.geometry.centroids, mesh.positions}, options),
			[](std::size_t) { return Point(0, 0, 1); });
	};
	CHECK(angle({0.05 * edge, factors}) < 0.6 * angle(0.3 * edge));
}
