// SPDX-License-Identifier: GPL-3.0-or-later
#include "unfolding.h"

#include "measures.h"
#include "method_support.h"
#include "recipes.h"
#include "vertex_update.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace orthopoly;

namespace {

const Point UP(0, 0, 1);

// A vertex in the middle of a flat grid of 8 by 8 squares.
constexpr std::size_t MIDDLE = 4 * 9 + 4;

// The grid with that vertex pushed over a neighbour, which turns faces over.
TriangleMesh folded_grid()
{
	TriangleMesh mesh = make_flat_grid(8);
	mesh.positions[MIDDLE] += Point(1.4 / 8, 0.2 / 8, 0);
	return mesh;
}

Index count_turned(const StepFixture& f, const std::vector<Point>& positions)
{
	return count_folded_faces(positions, f.workspace);
}

// Two sheets that meet at an angle of some degrees along the y axis.
TriangleMesh knife_edge(double degrees)
{
	TriangleMesh mesh = make_flat_grid(10);
	const double half = 0.5 * degrees / 57.29578;
	for (Point& p : mesh.positions) {
		const double x = p.x() - 0.5;
		p = Point(-std::abs(x) * std::cos(half), p.y(), -x * std::sin(half));
	}
	return mesh;
}

} // namespace

TEST_CASE("Faces turned over by a vertex that slid are turned back, on the surface", "[unfolding]")
{
	for (const double scale : {1e-3, 1.0, 1e3}) {
		CAPTURE(scale);
		const TriangleMesh mesh = placed(folded_grid(), scale);
		const StepFixture f(mesh);
		REQUIRE(count_turned(f, mesh.positions) > 0);
		std::vector<Point> positions = mesh.positions;
		CHECK(unfold_faces(f.workspace, std::vector<Point>(mesh.faces.size(), UP), positions));
		CHECK(count_turned(f, positions) == 0);
		for (const Face& face : mesh.faces)
			CHECK(face_cross_product(positions, face).z() > 0);
		for (std::size_t i = 0; i < positions.size(); ++i) {
			CAPTURE(i);
			CHECK(positions[i].z() == 0);
			// No further than the least move asks for: less than the way back.
			CHECK((positions[i] - mesh.positions[i]).norm() < scale * 1.2 / 8);
			if ((mesh.positions[i] - mesh.positions[MIDDLE]).norm() > scale * 0.5)
				CHECK(same_bits(positions[i], mesh.positions[i]));
		}
	}
}

TEST_CASE("A mesh without folds keeps every bit, sharp as its edges may be", "[unfolding]")
{
	for (const TriangleMesh& mesh :
		 {make_flat_grid(6), make_cube(300), make_torus(800), knife_edge(60), knife_edge(10)}) {
		const StepFixture f(mesh);
		std::vector<Point> positions = mesh.positions;
		CHECK_FALSE(unfold_faces(f.workspace, f.geometry.normals, positions));
		CHECK(same_bits(positions, mesh.positions));
	}
}

TEST_CASE("A target that none around agrees with is not believed", "[unfolding]")
{
	const TriangleMesh mesh = folded_grid();
	const StepFixture f(mesh);
	// As a filter leaves it that takes a folded face for its own guide.
	std::vector<Point> normals(mesh.faces.size(), UP);
	const auto folded =
		std::find_if(f.geometry.normals.begin(), f.geometry.normals.end(), [](const Point& n) {
			return n.z() < 0;
		});
	REQUIRE(folded != f.geometry.normals.end());
	normals[static_cast<std::size_t>(folded - f.geometry.normals.begin())] = Point(0, 1, 0);
	std::vector<Point> positions = mesh.positions;
	CHECK(unfold_faces(f.workspace, normals, positions));
	CHECK(count_turned(f, positions) == 0);
}

TEST_CASE("A folded face without a target is turned to where those around look", "[unfolding]")
{
	const TriangleMesh mesh = folded_grid();
	const StepFixture f(mesh);
	std::vector<Point> normals(mesh.faces.size(), UP);
	Index folded = 0;
	for (std::size_t i = 0; i < normals.size(); ++i) {
		if (f.geometry.normals[i].z() < 0) {
			normals[i] = Point::Zero();
			++folded;
		}
	}
	REQUIRE(folded == 2);
	std::vector<Point> positions = mesh.positions;
	CHECK(unfold_faces(f.workspace, normals, positions));
	for (const Face& face : mesh.faces)
		CHECK(face_cross_product(positions, face).z() > 0);
}

TEST_CASE("The tip of a face with two edges on the outline is turned back", "[unfolding]")
{
	TriangleMesh mesh = make_flat_grid(8);
	std::vector<std::size_t> tips;
	{
		const StepFixture flat(mesh);
		for (Index i = 0; i < mesh.vertex_count(); ++i) {
			if (flat.workspace.vertex_faces.size(i) == 1)
				tips.push_back(static_cast<std::size_t>(i));
		}
	}
	REQUIRE(tips.size() == 2);
	const Point corner = mesh.positions[tips[0]];
	// Beyond the diagonal of its square.
	mesh.positions[tips[0]] += 0.7 / 8 * (Point(1, 1, 0) - 2 * corner);
	const StepFixture f(mesh);
	const std::vector<Point> up(mesh.faces.size(), UP);
	std::vector<Point> positions = mesh.positions;
	REQUIRE(count_turned(f, positions) == 1);
	CHECK(unfold_faces(f.workspace, up, positions));
	CHECK(count_turned(f, positions) == 0);
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (i != tips[0] && f.workspace.edges.boundary[i] != 0)
			CHECK(same_bits(positions[i], mesh.positions[i]));
	}
	TriangleMesh held = mesh;
	held.fixed.assign(held.positions.size(), 0);
	held.fixed[tips[0]] = 1;
	const StepFixture g(held);
	positions = held.positions;
	unfold_faces(g.workspace, up, positions);
	CHECK(same_bits(positions[tips[0]], held.positions[tips[0]]));
}

TEST_CASE("A face on the wrong side of an edge is turned to less than a right angle", "[unfolding]")
{
	// One face of the flat side, with its targets, taken for one of a wall beyond a right angle.
	TriangleMesh mesh = make_flat_grid(8);
	mesh.positions[MIDDLE].z() = 0.5 / 8;
	mesh.positions[MIDDLE] += Point(1.1 / 8, 0, 0);
	const StepFixture f(mesh);
	std::vector<Point> positions = mesh.positions;
	std::vector<Point> normals(mesh.faces.size(), UP);
	const auto beyond = [&] {
		Index count = 0;
		for (const Face& face : mesh.faces)
			count += face_cross_product(positions, face).z() < 0 ? 1 : 0;
		return count;
	};
	const Index before = beyond();
	REQUIRE(before > 0);
	for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
		if (f.geometry.normals[i].z() < 0) {
			normals[i] = f.geometry.normals[i];
			normals[i].z() = 0;
			normals[i].normalize();
		}
	}
	unfold_faces(f.workspace, normals, positions);
	CHECK(beyond() < before);
}

TEST_CASE("Fixed vertices and open boundaries stay when faces are turned back", "[unfolding]")
{
	TriangleMesh mesh = folded_grid();
	mesh.fixed.assign(mesh.positions.size(), 0);
	mesh.fixed[MIDDLE] = 1;
	mesh.positions[4].x() += 1.5 / 8; // on the outline
	const StepFixture f(mesh);
	const std::vector<Point> up(mesh.faces.size(), UP);
	std::vector<Point> positions = mesh.positions;
	const Index before = count_turned(f, positions);
	CHECK(unfold_faces(f.workspace, up, positions));
	CHECK(count_turned(f, positions) < before);
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (mesh.fixed[i] != 0 || f.workspace.edges.boundary[i] != 0)
			CHECK(same_bits(positions[i], mesh.positions[i]));
	}
	std::fill(mesh.fixed.begin(), mesh.fixed.end(), std::uint8_t(1));
	const StepFixture held(mesh);
	positions = mesh.positions;
	CHECK_FALSE(unfold_faces(held.workspace, up, positions));
	CHECK(same_bits(positions, mesh.positions));
}

TEST_CASE("Faces are turned back without folding others, whatever the targets", "[unfolding]")
{
	// Brought close to the surface, which by itself unfolds nothing.
	TriangleMesh mesh = noisy(make_torus(3000), 0.3, NoiseDirection::Isotropic);
	const FaceGeometry truth = face_geometry(make_torus(3000).positions, mesh.faces);
	{
		const StepFixture raw(mesh);
		update_vertices(raw.workspace, truth.normals, {}, mesh.positions);
	}
	const StepFixture f(mesh);
	const auto turned = [&](const std::vector<Point>& positions) {
		Index count = 0;
		for (std::size_t i = 0; i < mesh.faces.size(); ++i)
			count += face_cross_product(positions, mesh.faces[i]).dot(truth.normals[i]) < 0 ? 1 : 0;
		return count;
	};
	std::vector<Point> positions = mesh.positions;
	const Index before = turned(positions);
	CAPTURE(before, turned(positions));
	REQUIRE(before > 100);
	unfold_faces(f.workspace, truth.normals, positions);
	CHECK(turned(positions) < before / 4);
	CHECK(all_finite(positions));
	// Targets that say nothing.
	std::vector<Point> normals = truth.normals;
	std::mt19937 generator(5);
	std::shuffle(normals.begin(), normals.end(), generator);
	positions = mesh.positions;
	unfold_faces(f.workspace, normals, positions);
	CHECK(all_finite(positions));
	// None at all.
	positions = mesh.positions;
	CHECK_FALSE(
		unfold_faces(f.workspace, std::vector<Point>(mesh.faces.size(), Point::Zero()), positions));
	CHECK(same_bits(positions, mesh.positions));
}

TEST_CASE("Faces are turned back the same on any number of threads", "[unfolding][parallel]")
{
	const TriangleMesh mesh = noisy(make_torus(20000), 0.4, NoiseDirection::Isotropic);
	const std::vector<Point> normals =
		face_geometry(make_torus(20000).positions, mesh.faces).normals;
	const StepFixture one(mesh, 1);
	std::vector<Point> expected = mesh.positions;
	REQUIRE(unfold_faces(one.workspace, normals, expected));
	for (const int threads : {2, 3, 8}) {
		const StepFixture several(mesh, threads);
		std::vector<Point> positions = mesh.positions;
		unfold_faces(several.workspace, normals, positions);
		CHECK(same_bits(positions, expected));
	}
}

TEST_CASE("The method leaves no more folds than a few on strong noise", "[unfolding][slow]")
{
	// Over twelve noises, since one has none and another six.
	const auto count = [](const std::string& name, double sigma, NoiseDirection direction) {
		const TriangleMesh truth = find_recipe(name).make_default();
		Index folded = 0;
		for (std::uint32_t seed = 1; seed <= 12; ++seed) {
			NoiseOptions noise;
			noise.sigma = sigma;
			noise.direction = direction;
			noise.seed = seed;
			const TriangleMesh mesh = with_positions(truth, add_noise(truth, noise));
			const DenoiseResult result = denoised(mesh, {});
			folded += measure(with_positions(truth, result.positions), truth).folded_faces;
		}
		return folded;
	};
	CHECK(count("height_field", 0.4, NoiseDirection::Random) <= 26);
	CHECK(count("part", 0.2, NoiseDirection::Isotropic) <= 26);
}
