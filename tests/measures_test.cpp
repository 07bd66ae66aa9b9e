// SPDX-License-Identifier: GPL-3.0-or-later
#include "measures.h"

#include "defects.h"
#include "errors.h"
#include "execution.h"
#include "progress_part.h"
#include "shapes.h"
#include "step_fixture.h"
#include "test_support.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

using namespace orthopoly;
using Catch::Contains;

namespace {

// The square of side 1 turned around the x axis.
TriangleMesh tilted_square(double degrees)
{
	TriangleMesh mesh = unit_square();
	const Eigen::AngleAxisd turn(degrees / 180 * PI, Point::UnitX());
	for (Point& point : mesh.positions)
		point = turn * point;
	return mesh;
}

} // namespace

TEST_CASE("a mesh measured against itself has no error", "[measures]")
{
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	const Point offset = GENERATE(Point(0, 0, 0), Point(1, 1, 1)) * (1e6 * scale);
	const TriangleMesh mesh = placed(make_part(3000), scale, offset);
	const ErrorMeasures measures = measure(mesh, mesh);
	CHECK(measures.mean_angle == 0);
	CHECK(measures.max_angle == 0);
	CHECK(measures.msae == 0);
	CHECK(measures.relative_vertex_error < 1e-9);
	CHECK(measures.folded_faces == 0);
	CHECK(measures.measured_faces == mesh.face_count());
	CHECK(measures.paired_by_index);
}

TEST_CASE("eq. 14 on faces turned by a known angle", "[measures]")
{
	const double degrees = GENERATE(1e-6, 5.0, 60.0, 89.0, 91.0, 179.0);
	const ErrorMeasures measures = measure(tilted_square(degrees), unit_square());
	CHECK(measures.mean_angle == Approx(degrees).epsilon(1e-9));
	CHECK(measures.max_angle == Approx(degrees).epsilon(1e-9));
	CHECK(measures.msae == Approx(std::pow(degrees / 180 * PI, 2)).epsilon(1e-9));
	CHECK(measures.folded_faces == (degrees > 90 ? 2 : 0));
	REQUIRE(measures.face_angles.size() == 2);
	CHECK(measures.face_angles[1] == Approx(degrees).epsilon(1e-9));
}

TEST_CASE("folds of the reference are told from those of the mesh", "[measures]")
{
	const TriangleMesh flat = make_flat_grid(10);
	TriangleMesh folded = flat;
	// Pulled across the far sides of its faces.
	folded.positions[5 * 11 + 5].x() += 0.15;
	const ErrorMeasures against_folded = measure(flat, folded);
	CHECK(against_folded.folded_faces > 0);
	CHECK(against_folded.folded_in_reference == against_folded.folded_faces);
	const ErrorMeasures of_folded = measure(folded, flat);
	CHECK(of_folded.folded_faces == against_folded.folded_faces);
	CHECK(of_folded.folded_in_reference == 0);
	CHECK(measure(folded, folded).folded_in_reference == 0);
}

TEST_CASE("eq. 14 is the mean of squares, not the square of the mean", "[measures]")
{
	TriangleMesh mesh = unit_square();
	// Only the second face turns, by 45 degrees: its third corner goes up.
	mesh.positions.push_back(Point(0, 1, 0));
	mesh.faces[1] = {0, 2, 4};
	TriangleMesh reference = mesh;
	mesh.positions[4].z() = std::sqrt(0.5);
	const ErrorMeasures measures = measure(mesh, reference);
	CHECK(measures.mean_angle == Approx(22.5));
	CHECK(measures.max_angle == Approx(45));
	CHECK(measures.msae == Approx(PI * PI / 16 / 2));
}

TEST_CASE("eq. 13 on a mesh lifted by a known height", "[measures]")
{
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	const TriangleMesh reference = placed(unit_square(), scale);
	const TriangleMesh mesh = placed(unit_square(), scale, Point(0, 0, 0.25 * scale));
	const ErrorMeasures measures = measure(mesh, reference);
	CHECK(measures.vertex_error == Approx(0.25 * scale));
	CHECK(measures.max_distance == Approx(0.25 * scale));
	CHECK(
		measures.relative_vertex_error ==
		Approx(0.25 * scale / mean_edge_length(reference.positions, reference.faces)));
	CHECK(measures.mean_angle == 0);
}

TEST_CASE("eq. 13 weighs a vertex by the area around it", "[measures]")
{
	// Vertex 0 belongs to both triangles, of areas 1/2 and 2; the others to one.
	TriangleMesh reference;
	reference.positions = {
		Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0), Point(-2, 0, 0), Point(0, -2, 0)};
	reference.faces = {{0, 1, 2}, {0, 3, 4}};
	// Sideways moves within the plane keep to the surface; only vertex 1 leaves it.
	TriangleMesh mesh = reference;
	mesh.positions[1] = Point(1, 0, 0.3);
	const ErrorMeasures measures = measure(mesh, reference);
	const double area_near = 0.5 * std::sqrt(1 + 0.09);
	CHECK(measures.vertex_error == Approx(std::sqrt(area_near * 0.09 / (3 * (area_near + 2)))));
	CHECK(measures.vertex_distances[1] == Approx(0.3));
	CHECK(measures.vertex_distances[0] == Approx(0).margin(1e-15));
}

TEST_CASE("distances go to the whole reference, not to the vertex of the same index", "[measures]")
{
	// Vertices slid along the faces of a cube are not off it.
	TriangleMesh mesh = make_cube(1200);
	const TriangleMesh reference = mesh;
	for (Point& point : mesh.positions) {
		if (std::abs(point.x()) < 0.99 && std::abs(point.y()) < 0.99)
			point.x() += 0.004;
	}
	const ErrorMeasures measures = measure(mesh, reference);
	CHECK(measures.max_distance < 1e-14);
	CHECK(measures.mean_angle < 1e-6);
}

TEST_CASE("without the same faces, faces pair with the closest point", "[measures]")
{
	const TriangleMesh reference = make_cube(1200);
	SECTION("another size of the same shape")
	{
		const ErrorMeasures measures = measure(make_cube(3072), reference);
		CHECK_FALSE(measures.paired_by_index);
		CHECK(measures.mean_angle < 1e-6);
		CHECK(measures.vertex_error < 1e-14);
		CHECK(measures.measured_faces == 3072);
	}
	SECTION("the same faces in another order")
	{
		TriangleMesh mesh = noisy(reference, 0.1);
		const ErrorMeasures by_index = measure(mesh, reference);
		std::reverse(mesh.faces.begin(), mesh.faces.end());
		const ErrorMeasures by_place = measure(mesh, reference);
		CHECK(by_index.paired_by_index);
		CHECK_FALSE(by_place.paired_by_index);
		CHECK(by_place.vertex_error == Approx(by_index.vertex_error));
		CHECK(by_place.mean_angle == Approx(by_index.mean_angle).epsilon(0.05));
	}
	SECTION("the surface inside out")
	{
		TriangleMesh mesh = reference;
		for (Face& face : mesh.faces)
			std::swap(face[0], face[1]);
		const ErrorMeasures measures = measure(mesh, reference);
		CHECK(measures.mean_angle == Approx(180));
		CHECK(measures.folded_faces == mesh.face_count());
	}
}

TEST_CASE("measures do not depend on where the mesh is", "[measures]")
{
	const TriangleMesh reference = make_part(3000);
	const TriangleMesh mesh = noisy(reference, 0.3);
	const ErrorMeasures here = measure(mesh, reference);
	CHECK(here.mean_angle > 5);
	const double scale = GENERATE(1e-6, 1e6);
	const Point offset = Point(1, 2, -3) * (1e4 * scale);
	const ErrorMeasures there =
		measure(placed(mesh, scale, offset), placed(reference, scale, offset));
	CHECK(there.mean_angle == Approx(here.mean_angle).epsilon(1e-6));
	CHECK(there.msae == Approx(here.msae).epsilon(1e-6));
	CHECK(there.relative_vertex_error == Approx(here.relative_vertex_error).epsilon(1e-6));
	CHECK(there.vertex_error == Approx(scale * here.vertex_error).epsilon(1e-6));
	CHECK(there.folded_faces == here.folded_faces);
}

TEST_CASE("noise along the normal is read back as E_v", "[measures]")
{
	const TriangleMesh reference = make_sphere(20000);
	NoiseOptions options;
	options.sigma = 0.1;
	options.direction = NoiseDirection::Normal;
	TriangleMesh mesh = reference;
	mesh.positions = add_noise(reference, options);
	CHECK(measure(mesh, reference).relative_vertex_error == Approx(0.1).epsilon(0.03));
}

TEST_CASE("what is too far from a partial reference is not measured", "[measures]")
{
	const TriangleMesh reference = unit_square();
	TriangleMesh mesh = unit_square();
	const TriangleMesh far_away = placed(unit_square(), 1, Point(50, 0, 0.1));
	for (const Point& point : far_away.positions)
		mesh.positions.push_back(point);
	mesh.faces.push_back({4, 5, 6});
	mesh.faces.push_back({4, 6, 7});
	MeasureOptions options;
	options.max_distance = 1;
	const ErrorMeasures measures = measure(mesh, reference, options);
	CHECK(measures.measured_faces == 2);
	CHECK(measures.face_angles[3] == -1);
	CHECK(measures.vertex_distances[7] == -1);
	CHECK(measures.vertex_distances[3] == Approx(0).margin(1e-15));
	CHECK(measures.max_distance < 1e-14);
	CHECK(measure(mesh, reference).max_distance > 49);
}

TEST_CASE("faces without area and vertices without faces are not measured", "[measures]")
{
	const TriangleMesh mesh = make_degenerate_face();
	const ErrorMeasures measures = measure(mesh, mesh);
	CHECK(measures.measured_faces == mesh.face_count() - 2);
	CHECK(measures.face_angles.back() == -1);
	CHECK(measures.mean_angle == 0);
	const TriangleMesh stray = make_unreferenced_vertex();
	CHECK(measure(stray, stray).vertex_distances.back() == -1);
}

TEST_CASE("meshes without a surface are refused", "[measures]")
{
	const TriangleMesh mesh = unit_square();
	CHECK_THROWS_AS(measure(mesh, make_points_only()), InvalidMesh);
	CHECK_THROWS_WITH(measure(mesh, make_points_only()), Contains("reference"));
	CHECK_THROWS_AS(measure(make_points_only(), mesh), InvalidMesh);
	CHECK_THROWS_AS(measure(mesh, make_empty()), InvalidMesh);
	CHECK_THROWS_WITH(measure(make_nan_coordinate(), mesh), Contains("vertex 7"));
	CHECK_THROWS_WITH(measure(mesh, make_nan_coordinate()), Contains("vertex 7"));
}

TEST_CASE("The measures are the same on any number of threads", "[measures][parallel]")
{
	const TriangleMesh clean = make_part(20000);
	const TriangleMesh mesh = noisy(clean, 0.3);
	// Pairs by number and by the closest point.
	TriangleMesh other = clean;
	other.faces.pop_back();
	for (const TriangleMesh& reference : {clean, other}) {
		MeasureOptions options;
		options.threads = 1;
		const ErrorMeasures expected = measure(mesh, reference, options);
		CHECK(expected.mean_angle > 10);
		options.threads = 3;
		const ErrorMeasures found = measure(mesh, reference, options);
		CHECK(found.vertex_error == expected.vertex_error);
		CHECK(found.mean_angle == expected.mean_angle);
		CHECK(found.face_angles == expected.face_angles);
		CHECK(found.vertex_distances == expected.vertex_distances);
	}
}

TEST_CASE("one reference measures several meshes", "[measures]")
{
	const TriangleMesh clean = make_part(2000);
	const ReferenceMeasure reference(clean);
	for (const double sigma : {0.1, 0.3}) {
		const TriangleMesh mesh = noisy(clean, sigma);
		const ErrorMeasures expected = measure(mesh, clean);
		Progress progress;
		const ErrorMeasures found = reference.measure(mesh, progress);
		CHECK(found.mean_angle == expected.mean_angle);
		CHECK(found.relative_vertex_error == expected.relative_vertex_error);
		CHECK(found.mean_angle > 5);
	}
}

TEST_CASE("measuring tells how far it is and hears of a cancel", "[measures]")
{
	const TriangleMesh clean = make_part(2000);
	const TriangleMesh mesh = noisy(clean, 0.2);
	const ReferenceMeasure reference(clean);
	std::vector<int> percents;
	Progress whole([&](int percent, const std::string& words) {
		CHECK_THAT(words, Contains("reference"));
		percents.push_back(percent);
		return true;
	});
	reference.measure(mesh, whole);
	CHECK(percents.size() >= 3);
	CHECK(std::is_sorted(percents.begin(), percents.end()));
	CHECK(percents.back() >= 80);

	const int last = GENERATE(0, 40, 80);
	CAPTURE(last);
	int calls_after = -1;
	Progress stopped([&](int percent, const std::string&) {
		if (percent >= last)
			++calls_after;
		return percent < last;
	});
	CHECK_THROWS_AS(reference.measure(mesh, stopped), Cancelled);
	CHECK(calls_after == 0);
}

TEST_CASE("a part of the work reports within its share of the whole", "[measures]")
{
	std::vector<int> percents;
	bool go_on = true;
	Progress whole([&](int percent, const std::string&) {
		percents.push_back(percent);
		return go_on;
	});
	Progress part = part_of(whole, 0.25, 0.75);
	CHECK(part.report(0, "begins"));
	CHECK(part.report(0.5, "goes on"));
	CHECK(part.report(1, "is over"));
	CHECK(percents == std::vector<int> {25, 50, 75});
	go_on = false;
	Progress next = part_of(whole, 0.75, 1);
	CHECK_FALSE(next.report(0, "begins"));
	CHECK(whole.cancelled());
	CHECK(next.cancelled());
}
