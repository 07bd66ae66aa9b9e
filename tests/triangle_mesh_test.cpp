// SPDX-License-Identifier: GPL-3.0-or-later
#include "triangle_mesh.h"

#include "defects.h"
#include "errors.h"
#include "shapes.h"
#include "test_support.h"

#include <cmath>
#include <limits>
#include <vector>

using namespace orthopoly;
using Catch::Contains;

TEST_CASE("a sound mesh is valid, defects that can be worked around too", "[triangle_mesh]")
{
	CHECK_NOTHROW(validate(tetrahedron()));
	CHECK_NOTHROW(validate(make_degenerate_face()));
	CHECK_NOTHROW(validate(make_non_manifold_edge()));
	CHECK_NOTHROW(validate(make_unreferenced_vertex()));
	CHECK_NOTHROW(validate(TriangleMesh()));
}

TEST_CASE("what is wrong with a mesh is named with its index", "[triangle_mesh]")
{
	TriangleMesh mesh = tetrahedron();
	SECTION("an index past the end")
	{
		mesh.faces[2][1] = 4;
		CHECK_THROWS_AS(validate(mesh), InvalidMesh);
		CHECK_THROWS_WITH(
			validate(mesh), Contains("face 2") && Contains("index 4") && Contains("4 vertices"));
	}
	SECTION("an index below zero")
	{
		mesh.faces[1][0] = -1;
		CHECK_THROWS_WITH(validate(mesh), Contains("face 1") && Contains("-1"));
	}
	SECTION("a coordinate that is not a number")
	{
		CHECK_THROWS_WITH(validate(make_nan_coordinate()), Contains("vertex 7"));
	}
	SECTION("an infinite coordinate")
	{
		mesh.positions[3].z() = -std::numeric_limits<double>::infinity();
		CHECK_THROWS_WITH(validate(mesh), Contains("vertex 3"));
	}
	SECTION("a coordinate out of all proportion")
	{
		mesh.positions[2].x() = -1e61;
		CHECK_THROWS_WITH(validate(mesh), Contains("vertex 2") && Contains("1e60"));
	}
	SECTION("flags for another number of vertices")
	{
		mesh.fixed = {1, 0, 1};
		CHECK_THROWS_WITH(validate(mesh), Contains("3") && Contains("4"));
	}
}

TEST_CASE("fixed flags are off where there are none", "[triangle_mesh]")
{
	TriangleMesh mesh = tetrahedron();
	CHECK_FALSE(mesh.is_fixed(2));
	mesh.fixed = {0, 0, 7, 0};
	CHECK(mesh.is_fixed(2));
	CHECK_FALSE(mesh.is_fixed(1));
}

TEST_CASE("normals, centroids and areas of a triangle", "[triangle_mesh]")
{
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	const Point offset = GENERATE(Point(0, 0, 0), Point(1, 1, 1)) * (1e6 * scale);
	const TriangleMesh mesh = placed(unit_square(), scale, offset);
	const FaceGeometry geometry = face_geometry(mesh.positions, mesh.faces);
	REQUIRE(geometry.normals.size() == 2);
	for (std::size_t i = 0; i < 2; ++i) {
		CHECK((geometry.normals[i] - Point(0, 0, 1)).norm() < 1e-9);
		CHECK(geometry.areas[i] == Approx(0.5 * scale * scale).epsilon(1e-9));
	}
	CHECK(
		(geometry.centroids[0] - (scale * Point(2.0 / 3, 1.0 / 3, 0) + offset)).norm() <
		1e-9 * scale);
	CHECK(
		mean_edge_length(mesh.positions, mesh.faces) ==
		Approx(scale * (4 + 2 * std::sqrt(2.0)) / 6));
	CHECK(bounding_box_diagonal(mesh.positions) == Approx(scale * std::sqrt(2.0)));
}

TEST_CASE("the vectors of a closed surface's faces cancel", "[triangle_mesh]")
{
	const TriangleMesh part = make_part(4000);
	Point sum = Point::Zero();
	for (const Face& face : part.faces)
		sum += face_cross_product(part.positions, face);
	CHECK(sum.norm() < 1e-12);
}

TEST_CASE("a face without area has no normal at any scale", "[triangle_mesh]")
{
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	TriangleMesh mesh = placed(tetrahedron(), scale);
	mesh.positions[3] = mesh.positions[1];
	// Face 1 now names one place twice, face 3 as well; the others are sound.
	CHECK_FALSE(is_degenerate(mesh.positions, mesh.faces[0]));
	CHECK(is_degenerate(mesh.positions, mesh.faces[1]));
	CHECK(is_degenerate(mesh.positions, {1, 1, 2}));
	CHECK(is_degenerate(mesh.positions, {2, 2, 2}));
	const FaceGeometry geometry = face_geometry(mesh.positions, mesh.faces);
	CHECK(geometry.normals[1] == Point(0, 0, 0));
	CHECK(geometry.normals[0].norm() == Approx(1));
	CHECK(geometry.areas[1] == Approx(0).margin(1e-20 * scale * scale));
}

TEST_CASE("a thin but honest face is not degenerate", "[triangle_mesh]")
{
	const std::vector<Point> positions = {Point(0, 0, 0), Point(1, 0, 0), Point(0.5, 1e-10, 0)};
	CHECK_FALSE(is_degenerate(positions, {0, 1, 2}));
	CHECK(is_degenerate({Point(0, 0, 0), Point(1, 0, 0), Point(0.5, 1e-15, 0)}, {0, 1, 2}));
}

TEST_CASE("an empty mesh has no edges and no box", "[triangle_mesh]")
{
	CHECK(mean_edge_length({}, {}) == 0);
	CHECK(bounding_box_diagonal({}) == 0);
	CHECK(face_geometry({}, {}).normals.empty());
}
