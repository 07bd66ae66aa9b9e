// SPDX-License-Identifier: GPL-3.0-or-later
#include "closest_point.h"

#include "defects.h"
#include "errors.h"
#include "noise.h"
#include "shapes.h"
#include "test_support.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

using namespace orthopoly;

namespace {

// Distance to a triangle by another way than the index takes: the minimum of a convex function of
// the barycentric coordinates, by the seven cases of where it lies.
double distance_to_triangle(const Point& query, const Point& a, const Point& b, const Point& c)
{
	const Point u = b - a;
	const Point v = c - a;
	const Point w = query - a;
	const double uu = u.dot(u);
	const double uv = u.dot(v);
	const double vv = v.dot(v);
	const double determinant = uu * vv - uv * uv;
	double best = std::numeric_limits<double>::infinity();
	const double s = (vv * u.dot(w) - uv * v.dot(w)) / determinant;
	const double t = (uu * v.dot(w) - uv * u.dot(w)) / determinant;
	if (s >= 0 && t >= 0 && s + t <= 1)
		best = (w - s * u - t * v).norm();
	const auto to_segment = [&](const Point& from, const Point& to) {
		const double along =
			std::clamp((query - from).dot(to - from) / (to - from).squaredNorm(), 0.0, 1.0);
		best = std::min(best, (from + along * (to - from) - query).norm());
	};
	to_segment(a, b);
	to_segment(b, c);
	to_segment(c, a);
	return best;
}

double distance_to_all(const TriangleMesh& mesh, const Point& query)
{
	double best = std::numeric_limits<double>::infinity();
	for (const Face& face : mesh.faces) {
		const auto corner = [&](std::size_t k) {
			return mesh.positions[static_cast<std::size_t>(face[k])];
		};
		if (!is_degenerate(mesh.positions, face))
			best = std::min(best, distance_to_triangle(query, corner(0), corner(1), corner(2)));
	}
	return best;
}

} // namespace

TEST_CASE("the closest point of a square, in front of it and beside it", "[closest_point]")
{
	const ClosestPointIndex index(unit_square());
	struct Case {
		Point query;
		Point closest;
	};
	const auto [query, closest] = GENERATE(
		Case {Point(0.5, 0.25, 2), Point(0.5, 0.25, 0)},
		Case {Point(0.5, 0.25, -2), Point(0.5, 0.25, 0)},
		Case {Point(0.3, 0.3, 0), Point(0.3, 0.3, 0)},
		Case {Point(3, 0.5, 0), Point(1, 0.5, 0)},
		Case {Point(3, 4, 5), Point(1, 1, 0)},
		Case {Point(-1, -1, -1), Point(0, 0, 0)},
		Case {Point(0.5, -7, 1), Point(0.5, 0, 0)});
	const ClosestPoint found = index.find(query);
	CHECK((found.position - closest).norm() < 1e-14);
	CHECK(found.distance == Approx((query - closest).norm()).margin(1e-14));
	CHECK((found.face == 0 || found.face == 1));
}

// In a mesh a neighbour covers up for an edge that a triangle forgets; alone it shows.
TEST_CASE("the closest point of a single triangle, all around it", "[closest_point]")
{
	TriangleMesh mesh;
	mesh.positions = {Point(0, 0, 0), Point(4, 0, 1), Point(1, 3, -1)};
	mesh.faces = {{0, 1, 2}};
	const ClosestPointIndex index(mesh);
	for (int x = -4; x <= 8; ++x) {
		for (int y = -4; y <= 7; ++y) {
			for (const double z : {-2.0, 0.0, 0.5}) {
				const Point query(x, y, z);
				REQUIRE(
					index.find(query).distance ==
					Approx(distance_to_all(mesh, query)).margin(1e-14));
			}
		}
	}
}

TEST_CASE("the index finds what a search through all faces finds", "[closest_point]")
{
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	const Point offset = GENERATE(Point(0, 0, 0), Point(1, -1, 0.5)) * (1e6 * scale);
	TriangleMesh mesh = make_part(1500);
	mesh = placed(mesh, scale, offset);
	NoiseOptions options;
	// From within the mesh to thirty edges away.
	options.sigma = GENERATE(0.1, 3.0, 10.0);
	const std::vector<Point> queries = add_noise(mesh, options);
	const ClosestPointIndex index(mesh);
	const double rounding = 1e-9 * scale;
	for (std::size_t i = 0; i < queries.size(); i += 7) {
		const ClosestPoint found = index.find(queries[i]);
		REQUIRE(found.distance == Approx(distance_to_all(mesh, queries[i])).margin(rounding));
		REQUIRE((found.position - queries[i]).norm() == Approx(found.distance).margin(rounding));
		const Face& face = mesh.faces[static_cast<std::size_t>(found.face)];
		TriangleMesh triangle;
		triangle.positions = mesh.positions;
		triangle.faces = {face};
		REQUIRE(distance_to_all(triangle, found.position) < rounding);
	}
}

TEST_CASE("queries far away are answered, and soon", "[closest_point]")
{
	const TriangleMesh sphere = make_sphere(2000);
	const ClosestPointIndex index(sphere);
	for (const double distance : {10.0, 1e3, 1e6, 1e9}) {
		for (const Point& direction :
			 {Point(1, 0, 0), Point(-0.3, 0.4, 0.866), Point(0, 0, -1), Point(1, 1, 1)}) {
			const Point query = distance * direction.normalized();
			const ClosestPoint found = index.find(query);
			CHECK(found.distance == Approx(distance_to_all(sphere, query)).epsilon(1e-12));
			CHECK(found.position.norm() == Approx(1).epsilon(0.01));
		}
	}
}

TEST_CASE("a vertex of the mesh is its own closest point", "[closest_point]")
{
	const TriangleMesh mesh = make_height_field(3000);
	const ClosestPointIndex index(mesh);
	for (const Point& point : mesh.positions)
		REQUIRE(index.find(point).distance < 1e-15);
}

TEST_CASE("faces without area are passed over", "[closest_point]")
{
	const TriangleMesh mesh = make_degenerate_face();
	const ClosestPointIndex index(mesh);
	for (const Point& point : mesh.positions) {
		const ClosestPoint found = index.find(point);
		CHECK(found.distance < 1e-15);
		CHECK_FALSE(
			is_degenerate(mesh.positions, mesh.faces[static_cast<std::size_t>(found.face)]));
	}
}

TEST_CASE("a surface of no area has no closest point", "[closest_point]")
{
	CHECK_THROWS_AS(ClosestPointIndex(make_points_only()), InvalidMesh);
	CHECK_THROWS_AS(ClosestPointIndex(TriangleMesh()), InvalidMesh);
	TriangleMesh line = unit_square();
	line.positions.assign(4, Point(1, 2, 3));
	CHECK_THROWS_AS(ClosestPointIndex(line), InvalidMesh);
	CHECK_THROWS_WITH(ClosestPointIndex(line), Catch::Contains("2 faces"));
}

TEST_CASE("many faces at the same place are no trouble", "[closest_point]")
{
	TriangleMesh mesh = unit_square();
	for (int i = 0; i < 5000; ++i)
		mesh.faces.push_back(mesh.faces[0]);
	const ClosestPointIndex index(mesh);
	CHECK(index.find(Point(0.7, 0.2, 1)).distance == Approx(1));
}

TEST_CASE("an index can be moved and outlives its mesh", "[closest_point]")
{
	auto mesh = std::make_unique<TriangleMesh>(unit_square());
	ClosestPointIndex first(*mesh);
	mesh.reset();
	ClosestPointIndex second(std::move(first));
	CHECK(second.find(Point(0.5, 0.5, 3)).distance == Approx(3));
	first = std::move(second);
	CHECK(first.find(Point(0.5, 0.5, 4)).distance == Approx(4));
}
