// SPDX-License-Identifier: GPL-3.0-or-later
#include "prefilter.h"

#include "measures.h"
#include "shapes.h"
#include "step_fixture.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

std::vector<Point>
smoothed(const StepFixture& f, double pairs, const std::vector<std::uint8_t>& only = {})
{
	std::vector<Point> positions = f.mesh.positions;
	taubin_smooth(f.workspace, pairs, positions, only);
	return positions;
}

// A tetrahedron with all edges alike, around the origin.
TriangleMesh regular_tetrahedron()
{
	TriangleMesh mesh = tetrahedron();
	mesh.positions = {Point(1, 1, 1), Point(-1, -1, 1), Point(-1, 1, -1), Point(1, -1, -1)};
	return mesh;
}

// A quarter of a cylinder with its axis along y, open all around.
TriangleMesh arch(int n)
{
	TriangleMesh mesh = make_flat_grid(n);
	mesh.positions = each(mesh.positions, [](const Point& p) {
		return Point(std::sin(1.5 * p.x()), p.y(), std::cos(1.5 * p.x()));
	});
	return mesh;
}

std::vector<Point> vertex_normals(const StepFixture& f)
{
	std::vector<Point> normals(f.mesh.positions.size(), Point::Zero());
	for (const Face& face : f.mesh.faces) {
		for (const Index corner : face)
			normals[static_cast<std::size_t>(corner)] += face_cross_product(f.mesh.positions, face);
	}
	return each(normals, [](const Point& n) { return Point(n.normalized()); });
}

} // namespace

TEST_CASE("A pair shrinks and inflates by hand", "[prefilter]")
{
	// The mean of the three others is minus a third of a corner, so the umbrella is -4/3 of it.
	const StepFixture f(regular_tetrahedron());
	const auto factor = [](double share) {
		return (1 - share * 0.5 * 4 / 3) * (1 + share * 0.53 * 4 / 3);
	};
	for (const double pairs : {1.0, 0.5, 0.25, 0.01}) {
		CAPTURE(pairs);
		const std::vector<Point> expected =
			each(f.mesh.positions, [&](const Point& p) { return Point(factor(pairs) * p); });
		CHECK(largest_distance(smoothed(f, pairs), expected) < 1e-14);
	}
	const std::vector<Point> expected = each(f.mesh.positions, [&](const Point& p) {
		return Point(factor(1) * factor(1) * factor(0.5) * p);
	});
	CHECK(largest_distance(smoothed(f, 2.5), expected) < 1e-14);
	CHECK(same_bits(smoothed(f, 0), f.mesh.positions));
}

TEST_CASE("Pairs add up, and a fraction lies between its neighbours", "[prefilter]")
{
	const StepFixture f(noisy(make_torus(2000), 0.3));
	const StepFixture two(noisy(make_torus(2000), 0.3));
	std::vector<Point> positions = smoothed(f, 2);
	taubin_smooth(f.workspace, 0.5, positions);
	CHECK(same_bits(positions, smoothed(two, 2.5)));
	const std::vector<Point> whole = smoothed(f, 1);
	double before = largest_distance(f.mesh.positions, whole);
	for (const double pairs : {0.1, 0.4, 0.7, 0.9, 1.0}) {
		const double now = largest_distance(smoothed(f, pairs), whole);
		CHECK(now < before);
		before = now;
	}
	CHECK(before == 0);
}

TEST_CASE("Vertices take pairs of their own", "[prefilter]")
{
	const StepFixture f(noisy(make_torus(2000), 0.3));
	std::vector<double> pairs(f.mesh.positions.size(), 2.5);
	std::vector<Point> positions = f.mesh.positions;
	taubin_smooth(f.workspace, pairs, positions);
	CHECK(same_bits(positions, smoothed(f, 2.5)));
	// Those without any stay, and the others go by them.
	std::fill(pairs.begin(), pairs.begin() + 500, 0.0);
	positions = f.mesh.positions;
	taubin_smooth(f.workspace, pairs, positions);
	for (std::size_t i = 0; i < positions.size(); ++i)
		CHECK(same_bits(positions[i], f.mesh.positions[i]) == (i < 500));
}

TEST_CASE("Smoothing takes noise and leaves the shape", "[prefilter]")
{
	// The truth against itself: the pass band keeps the sphere's radius.
	const StepFixture clean(make_sphere(8000));
	for (const Point& p : smoothed(clean, 4))
		REQUIRE(p.norm() == Approx(1).margin(2e-3));
	const StepFixture f(noisy(make_sphere(8000), 0.3));
	const auto deviation = [](const std::vector<Point>& positions) {
		double sum = 0;
		for (const Point& p : positions)
			sum += std::pow(p.norm() - 1, 2);
		return std::sqrt(sum / static_cast<double>(positions.size()));
	};
	CHECK(deviation(smoothed(f, 4)) < 0.6 * deviation(f.mesh.positions));
}

TEST_CASE("A flat outline stays where it is, what is inside it moves", "[prefilter]")
{
	// Flat, with vertices shifted about in the plane: smoothing would draw the outline inwards.
	TriangleMesh mesh = noisy(make_flat_grid(12), 0.3, NoiseDirection::Isotropic);
	const Eigen::Matrix3d rotation = some_rotation();
	for (Point& p : mesh.positions)
		p = rotation * Point(p.x(), p.y(), 0);
	const StepFixture f(mesh);
	const std::vector<Point> smooth = smoothed(f, 5.5);
	double most_inside = 0;
	for (std::size_t i = 0; i < smooth.size(); ++i) {
		const double moved = (smooth[i] - mesh.positions[i]).norm();
		if (f.workspace.edges.boundary[i] != 0)
			CHECK(moved < 1e-14);
		else
			most_inside = std::max(most_inside, moved);
	}
	CHECK(most_inside > 0.1 * f.workspace.mean_edge_length);
}

TEST_CASE("A bent outline moves along its normal only", "[prefilter]")
{
	const StepFixture f(arch(12));
	const std::vector<Point> normals = vertex_normals(f);
	// So little of a pair that normals do not change on the way.
	const std::vector<Point> smooth = smoothed(f, 1e-5);
	int moved = 0;
	for (std::size_t i = 0; i < smooth.size(); ++i) {
		if (f.workspace.edges.boundary[i] == 0)
			continue;
		const Point offset = smooth[i] - f.mesh.positions[i];
		CHECK(offset.cross(normals[i]).norm() < 1e-4 * offset.norm() + 1e-15);
		moved += offset.norm() > 1e-9 ? 1 : 0;
	}
	CHECK(moved > 10);
}

TEST_CASE("The outline of a noisy open mesh is smoothed too", "[prefilter]")
{
	const StepFixture f(noisy(make_flat_grid(20), 0.3));
	const std::vector<Point> smooth = smoothed(f, 3);
	double before = 0;
	double after = 0;
	for (std::size_t i = 0; i < smooth.size(); ++i) {
		if (f.workspace.edges.boundary[i] == 0)
			continue;
		before += std::pow(f.mesh.positions[i].z(), 2);
		after += std::pow(smooth[i].z(), 2);
	}
	CHECK(after < 0.75 * before);
}

TEST_CASE("Vertices that may not move keep every bit in the prefilter", "[prefilter]")
{
	TriangleMesh mesh = noisy(make_torus(1000), 0.3);
	mesh.positions.emplace_back(5, 5, 5); // no face
	mesh.fixed.assign(mesh.positions.size(), 0);
	std::vector<std::uint8_t> only(mesh.positions.size(), 0);
	for (std::size_t i = 0; i < mesh.fixed.size(); ++i) {
		mesh.fixed[i] = i % 3 == 0;
		only[i] = i % 2 == 0;
	}
	const StepFixture f(mesh);
	const std::vector<Point> all = smoothed(f, 2.5);
	const std::vector<Point> some = smoothed(f, 2.5, only);
	for (std::size_t i = 0; i + 1 < all.size(); ++i) {
		CHECK(same_bits(all[i], mesh.positions[i]) == (i % 3 == 0));
		CHECK(same_bits(some[i], mesh.positions[i]) == (i % 3 == 0 || i % 2 == 1));
	}
	CHECK(same_bits(all.back(), mesh.positions.back()));
}

TEST_CASE("Smoothing turns, moves and grows with the mesh", "[prefilter]")
{
	const StepFixture f(noisy(make_height_field(2000), 0.2));
	const std::vector<Point> expected = smoothed(f, 3.5);
	const Eigen::Matrix3d rotation = some_rotation();
	for (const double scale : {1e-3, 1.0, 1e3}) {
		const auto there = [&](const Point& p) { return Point(scale * (rotation * p)); };
		TriangleMesh mesh = f.mesh;
		mesh.positions = each(mesh.positions, there);
		const StepFixture moved(mesh);
		CHECK(largest_distance(smoothed(moved, 3.5), each(expected, there)) < scale * 1e-13);
	}
}

TEST_CASE("A vertex with a face turned over is found", "[prefilter]")
{
	const StepFixture flat(make_flat_grid(6));
	const auto count = [](const std::vector<std::uint8_t>& flags) {
		return std::count(flags.begin(), flags.end(), 1);
	};
	CHECK(count(folded_vertices(flat.workspace, flat.mesh.positions, {0.999})) == 0);

	// One vertex pulled over its neighbour turns faces over: all of theirs see it.
	std::vector<Point> positions = flat.mesh.positions;
	positions[24].x() += 1.2 / 6;
	const std::vector<std::uint8_t> flags = folded_vertices(flat.workspace, positions, {0.3});
	for (Index i = 0; i < flat.mesh.vertex_count(); ++i) {
		bool touches = false;
		for (const Index* it = flat.workspace.vertex_faces.begin(i);
			 it != flat.workspace.vertex_faces.end(i);
			 ++it)
			touches =
				touches || face_cross_product(positions, flat.mesh.faces[std::size_t(*it)]).z() < 0;
		CAPTURE(i);
		CHECK((flags[std::size_t(i)] != 0) == touches);
	}
	CHECK(flags[24] == TURNED_OVER);
	CHECK(count(flags) < 12);
}

TEST_CASE("The cosine of a fold is the one asked for", "[prefilter]")
{
	// A roof of two equal sides, 80 degrees apart.
	TriangleMesh mesh = unit_square();
	const double angle = 40 * 3.14159265358979323846 / 180;
	mesh.positions = {
		Point(0, -1, 0),
		Point(std::cos(angle), 0, -std::sin(angle)),
		Point(0, 1, 0),
		Point(-std::cos(angle), 0, -std::sin(angle))};
	mesh.faces = {{0, 1, 2}, {0, 2, 3}};
	const StepFixture f(mesh);
	for (const double degrees : {79.0, 81.0}) {
		const double cosine = std::cos(degrees * 3.14159265358979323846 / 180);
		const std::vector<std::uint8_t> flags =
			folded_vertices(f.workspace, mesh.positions, {cosine});
		CHECK(flags == std::vector<std::uint8_t>(4, degrees < 80));
	}
}

TEST_CASE("Only faces as low as noise can turn them over are folded", "[prefilter]")
{
	const StepFixture f(make_flat_grid(6));
	std::vector<Point> positions = f.mesh.positions;
	positions[24].x() += 1.2 / 6;
	// The faces turned over are a fifth of a square high or more, and shrunk by no more than that.
	CHECK(
		folded_vertices(f.workspace, positions, {0.3, 0.01 / 6}) ==
		std::vector<std::uint8_t>(positions.size(), 0));
	CHECK(
		folded_vertices(f.workspace, positions, {0.3, 2.0 / 6}) ==
		folded_vertices(f.workspace, positions, {0.3}));
}

TEST_CASE("Smoothing where faces are folded unfolds them", "[prefilter]")
{
	const StepFixture f(noisy(make_sphere(8000), 0.35, NoiseDirection::Random));
	std::vector<Point> positions = f.mesh.positions;
	const Index before = count_folded_faces(positions, f.workspace);
	REQUIRE(before > 20);
	const std::vector<std::uint8_t> flags = folded_vertices(f.workspace, positions, {0.3});
	taubin_smooth(f.workspace, 3, positions, flags);
	CHECK(count_folded_faces(positions, f.workspace) < before / 4);
	for (std::size_t i = 0; i < flags.size(); ++i)
		REQUIRE(same_bits(positions[i], f.mesh.positions[i]) == (flags[i] == 0));
}

TEST_CASE("A face turned over at an outline is turned back along it", "[prefilter]")
{
	TriangleMesh mesh = make_flat_grid(8);
	mesh.positions[4].x() += 1.5 / 8;                   // beyond the next on the outline
	mesh.positions[2 * 9] = Point(1.5 / 8, 2.0 / 8, 0); // and beyond one inside
	StepFixture f(mesh);
	const auto folded = [&] { return count_folded_faces(f.mesh.positions, f.workspace); };
	REQUIRE(folded() >= 2);
	std::vector<Point>& positions = f.mesh.positions;
	for (int pair = 0; pair < 3; ++pair)
		taubin_smooth(f.workspace, 1, positions, folded_vertices(f.workspace, positions, {}));
	CHECK(folded() == 0);
	for (std::size_t i = 0; i < 9; ++i)
		CHECK(positions[i].y() == Approx(0).margin(1e-15));
	for (const Point& p : positions)
		CHECK(p.z() == 0);

	mesh.fixed.assign(mesh.positions.size(), 0);
	mesh.fixed[4] = mesh.fixed[2 * 9] = 1;
	StepFixture held(mesh);
	taubin_smooth(
		held.workspace,
		1,
		held.mesh.positions,
		folded_vertices(held.workspace, held.mesh.positions, {}));
	CHECK(same_bits(held.mesh.positions[4], mesh.positions[4]));
	CHECK(same_bits(held.mesh.positions[2 * 9], mesh.positions[2 * 9]));
}

TEST_CASE("The prefilter gives the same on any number of threads", "[prefilter][parallel]")
{
	const TriangleMesh mesh = noisy(make_torus(20000), 0.3, NoiseDirection::Random);
	const StepFixture one(mesh, 1);
	const std::vector<Point> expected = smoothed(one, 2.5);
	const std::vector<std::uint8_t> flags = folded_vertices(one.workspace, mesh.positions, {0.3});
	for (const int threads : {2, 4}) {
		const StepFixture several(mesh, threads);
		CHECK(same_bits(smoothed(several, 2.5), expected));
		CHECK(folded_vertices(several.workspace, mesh.positions, {0.3}) == flags);
	}
}

TEST_CASE(
	"Near neighbours first, noise goes and the shape along long triangles stays", "[prefilter]")
{
	// A wave five lines long, on lines ten times as far apart as their samples.
	TriangleMesh truth = make_flat_grid(40);
	truth.positions = each(truth.positions, [](const Point& p) {
		return Point(10 * p.x(), p.y(), 0.3 * std::sin(16 * M_PI * p.x()));
	});
	const StepFixture f(noisy(truth, 0.1));
	const std::vector<double> pairs(truth.positions.size(), 6);
	const std::vector<double> shares(truth.positions.size(), 1);
	const auto error_after = [&](const NearFirst* near_first) {
		std::vector<Point> positions = f.mesh.positions;
		taubin_smooth(f.workspace, pairs, positions, near_first);
		return measure(with_positions(f.mesh, positions), truth).relative_vertex_error;
	};
	const NearFirst near_first = {shares, truth.positions};
	const double before = measure(f.mesh, truth).relative_vertex_error;
	CHECK(error_after(&near_first) < 0.6 * before);
	CHECK(error_after(&near_first) < 0.8 * error_after(nullptr));
}

TEST_CASE("Neighbours count the same where none is to come first", "[prefilter]")
{
	const StepFixture f(noisy(make_height_field(2000), 0.2));
	const std::vector<double> pairs(f.mesh.positions.size(), 2.5);
	const std::vector<double> shares(f.mesh.positions.size(), 0);
	const NearFirst near_first = {shares, f.mesh.positions};
	std::vector<Point> plain = f.mesh.positions;
	taubin_smooth(f.workspace, pairs, plain);
	std::vector<Point> positions = f.mesh.positions;
	taubin_smooth(f.workspace, pairs, positions, &near_first);
	CHECK(same_bits(positions, plain));
}
