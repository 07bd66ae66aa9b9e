// SPDX-License-Identifier: GPL-3.0-or-later
#include "adjacency.h"
#include "defects.h"
#include "errors.h"
#include "inspection.h"
#include "recipes.h"
#include "shapes.h"
#include "test_support.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>
#include <utility>

using namespace orthopoly;

namespace {

const Point& corner(const TriangleMesh& mesh, std::size_t face, std::size_t k)
{
	return mesh.positions[static_cast<std::size_t>(mesh.faces[face][k])];
}

double volume(const TriangleMesh& mesh)
{
	double sum = 0;
	for (std::size_t i = 0; i < mesh.faces.size(); ++i)
		sum += corner(mesh, i, 0).dot(corner(mesh, i, 1).cross(corner(mesh, i, 2))) / 6;
	return sum;
}

double area(const TriangleMesh& mesh)
{
	double sum = 0;
	for (const Face& face : mesh.faces)
		sum += 0.5 * face_cross_product(mesh.positions, face).norm();
	return sum;
}

int euler_characteristic(const TriangleMesh& mesh)
{
	std::set<std::pair<Index, Index>> edges;
	for (const Face& face : mesh.faces) {
		for (std::size_t k = 0; k < 3; ++k)
			edges.insert(std::minmax(face[k], face[(k + 1) % 3]));
	}
	return mesh.vertex_count() - static_cast<int>(edges.size()) + mesh.face_count();
}

// 1 for an equilateral triangle, 0 for one without area.
double worst_quality(const TriangleMesh& mesh)
{
	double worst = 1;
	for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
		double squared = 0;
		for (std::size_t k = 0; k < 3; ++k)
			squared += (corner(mesh, i, (k + 1) % 3) - corner(mesh, i, k)).squaredNorm();
		const double twice_area = face_cross_product(mesh.positions, mesh.faces[i]).norm();
		worst = std::min(worst, 2 * std::sqrt(3.0) * twice_area / squared);
	}
	return worst;
}

bool has_vertex(const TriangleMesh& mesh, const Point& point)
{
	return std::any_of(mesh.positions.begin(), mesh.positions.end(), [&](const Point& position) {
		return (position - point).norm() < 1e-12;
	});
}

void check_sound(const TriangleMesh& mesh)
{
	const Inspection found = inspect(mesh);
	CHECK(found.not_finite_vertices == 0);
	CHECK(found.unreferenced_vertices == 0);
	CHECK(found.duplicate_vertices == 0);
	CHECK(found.duplicate_faces == 0);
	CHECK(found.degenerate_faces == 0);
	CHECK(found.non_manifold_edges == 0);
	CHECK(found.components == 1);
}

// What one of the defect meshes has more than a sound box.
Inspection inspect_defect(const char* name)
{
	return inspect(find_recipe(name).make_default());
}

} // namespace

TEST_CASE("the cube has the size and the counts of the paper's", "[meshes]")
{
	const TriangleMesh cube = find_recipe("cube").make_default();
	check_sound(cube);
	CHECK(inspect(cube).boundary_vertices == 0);
	CHECK(cube.vertex_count() == 6146);
	CHECK(cube.face_count() == 12288);
	CHECK(volume(cube) == Approx(8));
	CHECK(area(cube) == Approx(24));
	CHECK(euler_characteristic(cube) == 2);
	CHECK(has_vertex(cube, Point(1, -1, 1)));
}

TEST_CASE("the vertices of the sphere lie on it", "[meshes]")
{
	const TriangleMesh sphere = make_sphere(8000);
	check_sound(sphere);
	CHECK(inspect(sphere).boundary_vertices == 0);
	CHECK(sphere.face_count() == 8000);
	CHECK(euler_characteristic(sphere) == 2);
	for (const Point& point : sphere.positions)
		REQUIRE(point.norm() == Approx(1).epsilon(1e-15));
	CHECK(volume(sphere) == Approx(4.0 / 3 * PI).epsilon(0.002));
	CHECK(worst_quality(sphere) > 0.8);
}

TEST_CASE("the vertices of the torus lie on it", "[meshes]")
{
	const TriangleMesh torus = make_torus(10000);
	check_sound(torus);
	CHECK(inspect(torus).boundary_vertices == 0);
	CHECK(torus.face_count() == Approx(10000).epsilon(0.01));
	CHECK(euler_characteristic(torus) == 0);
	for (const Point& point : torus.positions)
		REQUIRE(
			std::hypot(std::hypot(point.x(), point.y()) - 1, point.z()) ==
			Approx(0.4).epsilon(1e-14));
	CHECK(volume(torus) == Approx(2 * PI * PI * 0.16).epsilon(0.005));
}

TEST_CASE("the part has the volume of its parts", "[meshes]")
{
	const TriangleMesh part = make_part(100000);
	check_sound(part);
	CHECK(inspect(part).boundary_vertices == 0);
	CHECK(euler_characteristic(part) == 0);
	const double flange = PI * 1.5 * 1.5 * 0.06;
	const double block = 4 * (1 - 0.06);
	// A disk of radius 0.55, and around it a quarter of a circle swept around the axis.
	const double rim =
		PI * 0.55 * 0.55 * 0.3 + 2 * PI * (PI * 0.3 * 0.3 / 4) * (0.55 + 4 * 0.3 / (3 * PI));
	const double bore = PI * 0.55 * 0.55 * 1.3;
	CHECK(volume(part) == Approx(flange + block + rim - bore).epsilon(0.002));
	CHECK(has_vertex(part, Point(1, 1, 1)));
	CHECK(has_vertex(part, Point(-1, 1, 0.06)));
	CHECK(worst_quality(part) > 0.1);
}

TEST_CASE("the part comes in any size", "[meshes]")
{
	const auto faces = GENERATE(1000, 16000, 64000, 400000);
	const TriangleMesh part = make_part(faces);
	CHECK(part.face_count() == Approx(faces).epsilon(0.15));
	CHECK(inspect(part).degenerate_faces == 0);
}

TEST_CASE("the sides of the thin plate are one mean edge length apart", "[meshes]")
{
	const TriangleMesh plate = find_recipe("thin_plate").make_default();
	check_sound(plate);
	CHECK(inspect(plate).boundary_vertices == 0);
	const auto [low, high] = std::minmax_element(
		plate.positions.begin(), plate.positions.end(), [](const Point& a, const Point& b) {
			return a.z() < b.z();
		});
	CHECK(high->z() - low->z() == Approx(mean_edge_length(plate.positions, plate.faces)));
	CHECK(volume(plate) == Approx(high->z() - low->z()));
}

TEST_CASE("the height field is open, has a hole and looks up", "[meshes]")
{
	const TriangleMesh field = find_recipe("height_field").make_default();
	check_sound(field);
	CHECK(field.face_count() == Approx(12000).epsilon(0.02));
	CHECK(inspect(field).boundary_vertices > 300);
	// A disk has 1, a disk with a hole 0.
	CHECK(euler_characteristic(field) == 0);
	for (const Face& face : field.faces)
		REQUIRE(face_cross_product(field.positions, face).z() > 0);
}

TEST_CASE("scan lines are of long thin triangles that look up", "[meshes]")
{
	const TriangleMesh sheet = find_recipe("scan_lines").make_default();
	check_sound(sheet);
	CHECK(sheet.face_count() == Approx(9000).epsilon(0.02));
	CHECK(euler_characteristic(sheet) == 1);
	for (const Face& face : sheet.faces)
		REQUIRE(face_cross_product(sheet.positions, face).z() > 0);
	// Height over the longest side.
	Index thin = 0;
	for (const Face& face : sheet.faces) {
		const double area = face_cross_product(sheet.positions, face).norm();
		thin += area < 0.3 * longest_edge_squared(sheet.positions, face) ? 1 : 0;
	}
	CHECK(thin > 0.95 * sheet.face_count());
}

TEST_CASE("each defect is there, and only that one", "[meshes]")
{
	const TriangleMesh box = make_box({6, 6, 6}, Point::Constant(1));
	check_sound(box);

	SECTION("non_manifold_edge")
	{
		CHECK(inspect_defect("non_manifold_edge").non_manifold_edges == 6);
		CHECK(inspect_defect("non_manifold_edge").duplicate_faces == 0);
	}
	SECTION("non_manifold_vertex")
	{
		const TriangleMesh mesh = make_non_manifold_vertex();
		check_sound(mesh);
		CHECK(mesh.vertex_count() == 2 * box.vertex_count() - 1);
		// Two closed surfaces, one vertex less.
		CHECK(euler_characteristic(mesh) == 3);
		CHECK(volume(mesh) == Approx(2));
	}
	SECTION("degenerate_face")
	{
		const TriangleMesh mesh = make_degenerate_face();
		CHECK(inspect(mesh).degenerate_faces == 2);
		CHECK(inspect(mesh).components == 1);
		CHECK(volume(mesh) == Approx(1));
	}
	SECTION("duplicate_vertex")
	{
		CHECK(inspect_defect("duplicate_vertex").duplicate_vertices == 1);
		CHECK(inspect_defect("duplicate_vertex").seam_vertices == 1);
		CHECK(inspect_defect("duplicate_vertex").duplicate_faces == 0);
		CHECK(inspect_defect("duplicate_vertex").boundary_vertices > 0);
	}
	SECTION("seam")
	{
		CHECK(inspect_defect("seam").duplicate_vertices == 24);
		CHECK(inspect_defect("seam").seam_vertices == 24);
		CHECK(inspect_defect("seam").boundary_vertices == 48);
		CHECK(inspect_defect("seam").components == 2);
	}
	SECTION("loose_triangles")
	{
		const TriangleMesh mesh = make_loose_triangles();
		CHECK(mesh.vertex_count() == 3 * box.face_count());
		CHECK(inspect(mesh).seam_vertices == mesh.vertex_count() - box.vertex_count());
		CHECK(inspect(mesh).components == box.face_count());
	}
	SECTION("duplicate_face")
	{
		CHECK(inspect_defect("duplicate_face").duplicate_faces == 2);
		CHECK(inspect_defect("duplicate_face").duplicate_vertices == 0);
	}
	SECTION("unreferenced_vertex")
	{
		CHECK(inspect_defect("unreferenced_vertex").unreferenced_vertices == 1);
	}
	SECTION("isolated_face")
	{
		CHECK(inspect_defect("isolated_face").components == 2);
		CHECK(inspect_defect("isolated_face").boundary_vertices == 3);
	}
	SECTION("mixed_orientation")
	{
		CHECK(inspect_defect("mixed_orientation").non_manifold_edges > 100);
		CHECK(inspect_defect("mixed_orientation").boundary_vertices == 0);
		CHECK(make_mixed_orientation().face_count() == box.face_count());
	}
	SECTION("two_components")
	{
		CHECK(inspect_defect("two_components").components == 2);
		CHECK(inspect_defect("two_components").boundary_vertices == 0);
	}
	SECTION("empty")
	{
		CHECK(make_empty().positions.empty());
		CHECK(make_empty().faces.empty());
	}
	SECTION("points_only")
	{
		CHECK(make_points_only().vertex_count() == box.vertex_count());
		CHECK(make_points_only().faces.empty());
	}
	SECTION("nan_coordinate")
	{
		CHECK(inspect_defect("nan_coordinate").not_finite_vertices == 1);
		CHECK(std::isnan(make_nan_coordinate().positions[7].y()));
	}
}

TEST_CASE("recipes are found by name and give the same mesh each time", "[meshes]")
{
	for (const Recipe& recipe : recipes()) {
		CAPTURE(recipe.name);
		CHECK(&find_recipe(recipe.name) == &recipe);
		const TriangleMesh first = recipe.make_default();
		const TriangleMesh second = recipe.make_default();
		CHECK(first.faces == second.faces);
		// Compared as bits, since one of the meshes has a coordinate that equals nothing.
		CHECK(first.positions.size() == second.positions.size());
		CHECK(std::equal(
			first.positions.begin(),
			first.positions.end(),
			second.positions.begin(),
			[](const Point& a, const Point& b) {
				return a == b || (!a.allFinite() && !b.allFinite());
			}));
	}
	CHECK_THROWS_AS(find_recipe("teapot"), InvalidParameter);
	CHECK_THROWS_WITH(
		find_recipe("teapot"), Catch::Contains("'teapot'") && Catch::Contains("cube"));
}
