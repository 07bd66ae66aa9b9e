// SPDX-License-Identifier: GPL-3.0-or-later
#include "guide_direction.h"

#include "defects.h"
#include "step_fixture.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <set>

using namespace orthopoly;

namespace {

// Ring by ring over shared vertices, without any of the library's connectivity.
std::set<std::size_t> ring_by_definition(const TriangleMesh& mesh, std::size_t face, int rings)
{
	std::set<std::size_t> found = {face};
	for (int ring = 0; ring < rings; ++ring) {
		std::set<Index> vertices;
		for (const std::size_t i : found)
			vertices.insert(mesh.faces[i].begin(), mesh.faces[i].end());
		for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
			for (const Index vertex : mesh.faces[i]) {
				if (vertices.count(vertex) > 0)
					found.insert(i);
			}
		}
	}
	return found;
}

// Eqs. 1 to 4 with nothing saved: every pair of centroids, an iterative eigenvalue solver.
Point guide_by_definition(const StepFixture& f, std::size_t i, const GuideDirectionOptions& options)
{
	const std::set<std::size_t> structure = ring_by_definition(f.mesh, i, options.ring);
	const FaceGeometry& g = f.geometry;
	double sigma_p = 0;
	for (const std::size_t j : structure) {
		for (const std::size_t k : structure)
			sigma_p = std::max(sigma_p, 2 * (g.centroids[j] - g.centroids[k]).norm());
	}
	Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
	Point mean = Point::Zero();
	for (const std::size_t j : structure) {
		const double x = (g.centroids[i] - g.centroids[j]).norm();
		const double theta = angle_between(g.normals[i], g.normals[j]);
		const double eta = std::exp(-std::pow(x / sigma_p, 2));
		const double phi = std::exp(
			-std::pow((1 - std::cos(theta)) / (1 - std::cos(options.sigma_theta * PI / 180)), 2));
		tensor += eta * phi * g.normals[j] * g.normals[j].transpose();
		mean += eta * phi * g.normals[j];
	}
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(tensor);
	const Point v = solver.eigenvectors().col(2);
	return v.dot(mean) < 0 ? Point(-v) : v;
}

std::vector<Point> guides(const StepFixture& f, const GuideDirectionOptions& options = {})
{
	return guide_directions(f.workspace, f.geometry, options);
}

} // namespace

TEST_CASE("On a plane every guide direction is its normal", "[guide_direction]")
{
	for (const double scale : {1e-6, 1.0, 1e6}) {
		for (const double distance : {0.0, 1e3}) {
			TriangleMesh mesh = make_flat_grid(6);
			const Eigen::Matrix3d rotation = some_rotation();
			mesh.positions = each(mesh.positions, [&](const Point& p) {
				return Point(scale * (rotation * p + Point::Constant(distance)));
			});
			for (const Point& v : guides(StepFixture(mesh)))
				CHECK((v - rotation.col(2)).norm() < 1e-12 * (1 + distance));
		}
	}
}

TEST_CASE("A guide direction is the sum of eqs. 1 to 4", "[guide_direction]")
{
	const StepFixture f(noisy(make_torus(1000), 0.25, NoiseDirection::Random));
	GuideDirectionOptions options;
	for (const int ring : {1, 2, 3}) {
		for (const double sigma_theta : {10.0, 30.0, 60.0}) {
			options.ring = ring;
			options.sigma_theta = sigma_theta;
			const std::vector<Point> found = guides(f, options);
			double worst = 0;
			for (std::size_t i = 0; i < found.size(); i += 37)
				worst =
					std::max(worst, angle_between(found[i], guide_by_definition(f, i, options)));
			CHECK(worst < 1e-7);
		}
	}
}

TEST_CASE(
	"Two faces: the direction between their normals that the weights say", "[guide_direction]")
{
	// A roof of two triangles, normals 20 degrees to either side of z, the ridge along y.
	const double c = std::cos(PI / 9);
	const double s = std::sin(PI / 9);
	TriangleMesh mesh;
	mesh.positions = {Point(0, -1, 0), Point(0, 1, 0), Point(-c, 0, -s), Point(c, 0, -s)};
	mesh.faces = {{0, 1, 2}, {1, 0, 3}};
	const StepFixture f(mesh);
	REQUIRE((f.geometry.normals[0] - Point(-s, 0, c)).norm() < 1e-15);
	REQUIRE((f.geometry.normals[1] - Point(s, 0, c)).norm() < 1e-15);

	// The tensor is 1 for the face's own normal and w for the other one's; with the angle 2a
	// between them the principal axis is t away from the middle, tan 2t = (1 - w) / (1 + w) tan 2a.
	const double a = PI / 9;
	const double spread = (1 - std::cos(2 * a)) / (1 - std::cos(PI / 6));
	const double w = std::exp(-0.25) * std::exp(-spread * spread);
	const double t = 0.5 * std::atan2((1 - w) * std::sin(2 * a), (1 + w) * std::cos(2 * a));
	const std::vector<Point> v = guides(f);
	CHECK((v[0] - Point(-std::sin(t), 0, std::cos(t))).norm() < 1e-12);
	CHECK((v[1] - Point(std::sin(t), 0, std::cos(t))).norm() < 1e-12);
}

TEST_CASE("On a noisy cube guide directions are nearer the truth than normals", "[guide_direction]")
{
	const TriangleMesh cube = make_cube(3000);
	const FaceGeometry truth = face_geometry(cube.positions, cube.faces);
	const StepFixture f(noisy(cube, 0.2));
	const std::vector<Point> v = guides(f);
	double guide_sum = 0;
	double normal_sum = 0;
	for (std::size_t i = 0; i < v.size(); ++i) {
		guide_sum += angle_between(v[i], truth.normals[i]);
		normal_sum += angle_between(f.geometry.normals[i], truth.normals[i]);
	}
	CHECK(guide_sum < 0.8 * normal_sum);
}

TEST_CASE("Turning all faces over turns the guide directions", "[guide_direction]")
{
	TriangleMesh mesh = noisy(make_sphere(500), 0.2);
	const std::vector<Point> before = guides(StepFixture(mesh));
	for (Face& face : mesh.faces)
		std::swap(face[0], face[1]);
	const std::vector<Point> after = guides(StepFixture(mesh));
	CHECK(largest_distance(before, each(after, [](const Point& v) { return Point(-v); })) < 1e-12);
}

TEST_CASE("Faces without a normal have no guide direction and no vote", "[guide_direction]")
{
	TriangleMesh mesh = noisy(make_sphere(500), 0.2);
	const std::vector<Point> sound = guides(StepFixture(mesh));
	const auto count = sound.size();
	// On an edge that is there: changes neither rings nor distances between centroids by much, but
	// its vote, were it counted, would not be a number.
	mesh.faces.push_back({mesh.faces[0][0], mesh.faces[0][1], mesh.faces[0][1]});
	const std::vector<Point> found = guides(StepFixture(mesh));
	CHECK(found[count].isZero(0));
	for (std::size_t i = 0; i < count; ++i)
		REQUIRE(std::abs(found[i].norm() - 1) < 1e-12);
	// Where its centroid does not widen the structure, nothing changes at all.
	std::size_t same = 0;
	for (std::size_t i = 0; i < count; ++i)
		same += same_bits(found[i], sound[i]) ? 1 : 0;
	CHECK(same > count - 30);
}

TEST_CASE("Guide directions turn with the mesh and do not mind its scale", "[guide_direction]")
{
	const TriangleMesh mesh = noisy(make_torus(2000), 0.2);
	const std::vector<Point> expected = guides(StepFixture(mesh));
	const Eigen::Matrix3d rotation = some_rotation();
	for (const double scale : {1e-6, 1.0, 1e6}) {
		TriangleMesh moved = mesh;
		moved.positions = each(mesh.positions, [&](const Point& p) {
			return Point(scale * (rotation * p + Point(3, 1, -2)));
		});
		const std::vector<Point> back = each(guides(StepFixture(moved)), [&](const Point& v) {
			return Point(rotation.transpose() * v);
		});
		CHECK(largest_distance(back, expected) < 1e-9);
	}
}

TEST_CASE("Ring and sigma_theta matter", "[guide_direction]")
{
	const StepFixture f(noisy(make_torus(1000), 0.2));
	GuideDirectionOptions wider;
	wider.ring = 2;
	GuideDirectionOptions stricter;
	stricter.sigma_theta = 10;
	CHECK(largest_distance(guides(f), guides(f, wider)) > 1e-3);
	CHECK(largest_distance(guides(f), guides(f, stricter)) > 1e-3);
}

TEST_CASE("Defects do not keep guide directions from being directions", "[guide_direction]")
{
	for (const auto make :
		 {make_non_manifold_edge,
		  make_non_manifold_vertex,
		  make_degenerate_face,
		  make_duplicate_face,
		  make_isolated_face,
		  make_mixed_orientation}) {
		const StepFixture f(make());
		const std::vector<Point> v = guides(f);
		for (std::size_t i = 0; i < v.size(); ++i)
			CHECK(v[i].norm() == Approx(f.geometry.normals[i].norm()).margin(1e-12));
	}
}

TEST_CASE("Guide directions are the same on any number of threads", "[guide_direction][parallel]")
{
	const TriangleMesh mesh = noisy(make_torus(5000), 0.2);
	const std::vector<Point> expected = guides(StepFixture(mesh, 1));
	for (const int threads : {2, 4})
		CHECK(same_bits(guides(StepFixture(mesh, threads)), expected));
}
