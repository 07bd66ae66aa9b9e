// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_level.h"

#include "lattice.h"
#include "method_support.h"
#include "recipes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <random>
#include <string>

using namespace orthopoly;

namespace {

double estimated(const TriangleMesh& mesh, int threads = 1)
{
	const StepFixture f(mesh, threads);
	return estimate_noise_level(f.workspace, mesh.positions);
}

// What the noise really is along the normal of the clean surface, in its mean edge lengths.
double true_level(const TriangleMesh& clean, const TriangleMesh& mesh)
{
	std::vector<Point> normals(clean.positions.size(), Point::Zero());
	for (const Face& face : clean.faces) {
		for (const Index corner : face)
			normals[static_cast<std::size_t>(corner)] += face_cross_product(clean.positions, face);
	}
	double sum = 0;
	for (std::size_t i = 0; i < normals.size(); ++i)
		sum += std::pow((mesh.positions[i] - clean.positions[i]).dot(normals[i].normalized()), 2);
	return std::sqrt(sum / static_cast<double>(normals.size())) /
		   mean_edge_length(clean.positions, clean.faces);
}

} // namespace

TEST_CASE(
	"The noise is estimated on every surface, of every kind and strength", "[noise_level][slow]")
{
	const std::string name = GENERATE("cube", "sphere", "torus", "part", "height_field");
	const auto direction =
		GENERATE(NoiseDirection::Normal, NoiseDirection::Random, NoiseDirection::Isotropic);
	const TriangleMesh clean = find_recipe(name).make_default();
	for (const double sigma : {0.05, 0.1, 0.2, 0.3, 0.45, 0.6}) {
		CAPTURE(name, static_cast<int>(direction), sigma);
		const TriangleMesh mesh = noisy(clean, sigma, direction);
		const double expected = true_level(clean, mesh);
		CHECK(std::abs(estimated(mesh) - expected) < std::max(0.02, 0.15 * expected));
	}
}

TEST_CASE("The noise is estimated where there is an edge in every ring", "[noise_level][slow]")
{
	const auto direction =
		GENERATE(NoiseDirection::Normal, NoiseDirection::Random, NoiseDirection::Isotropic);
	for (const Index faces : {2000, 4000}) {
		const TriangleMesh clean = make_part(faces);
		for (const double sigma : {0.05, 0.1, 0.2, 0.3, 0.45, 0.6}) {
			CAPTURE(faces, static_cast<int>(direction), sigma);
			const TriangleMesh mesh = noisy(clean, sigma, direction);
			const double expected = true_level(clean, mesh);
			CHECK(std::abs(estimated(mesh) - expected) < std::max(0.02, 0.15 * expected));
		}
	}
}

TEST_CASE("The noise is estimated on long thin triangles that it is higher than", "[noise_level]")
{
	const TriangleMesh lines = find_recipe("scan_lines").make_default();
	CHECK(estimated(lines) < 0.025);
	for (const double sigma : {0.05, 0.1, 0.2, 0.3}) {
		CAPTURE(sigma);
		const TriangleMesh mesh = noisy(lines, sigma);
		const double expected = true_level(lines, mesh);
		CHECK(std::abs(estimated(mesh) - expected) < std::max(0.02, 0.12 * expected));
	}
	// A sheet of triangles ten times as long as wide; noise of 0.3 is twice their height.
	TriangleMesh sheet = make_flat_grid(60);
	for (Point& p : sheet.positions)
		p = Point(10 * p.x(), p.y(), 0.4 * std::cos(p.x()));
	const TriangleMesh mesh = noisy(sheet, 0.3);
	CHECK(estimated(mesh) > 0.74 * true_level(sheet, mesh));
	CHECK(estimated(mesh) < 1.1 * true_level(sheet, mesh));
}

TEST_CASE("Clean meshes read as clean", "[noise_level][slow]")
{
	for (const std::string name :
		 {"cube", "sphere", "torus", "part", "height_field", "thin_plate"}) {
		const Recipe& recipe = find_recipe(name);
		for (const double finer : {1.0, 4.0}) {
			CAPTURE(name, finer);
			const double faces = finer * static_cast<double>(recipe.default_faces);
			CHECK(estimated(recipe.make(static_cast<Index>(faces))) < 0.025);
		}
	}
	// Coarse ones as well.
	for (const std::string name : {"part", "height_field"}) {
		CAPTURE(name);
		CHECK(estimated(find_recipe(name).make(2000)) < 0.025);
	}
	CHECK(estimated(make_flat_grid(20)) < 1e-12);
}

TEST_CASE("Detail as small as the triangles is not noise", "[noise_level]")
{
	// Bumps of some two edges, as high as the noise or higher: scans simplified to few triangles
	// are like that everywhere.
	const TriangleMesh clean = with_correlated_noise(make_sphere(20000), 0.2, 2);
	const StepFixture f(clean);
	const NoiseLevels levels = estimate_noise_levels(f.workspace, clean.positions);
	CHECK(levels.rough > 0.035);
	CHECK(levels.flat < 0.025);
	for (const double sigma : {0.1, 0.2, 0.3}) {
		CAPTURE(sigma);
		const TriangleMesh mesh = noisy(clean, sigma);
		const double expected = true_level(clean, mesh);
		CHECK(std::abs(estimated(mesh) - expected) < std::max(0.02, 0.15 * expected));
	}
}

TEST_CASE("A drawn part of few faces reads as clean, and as noisy with noise", "[noise_level]")
{
	// Edges in every ring: polynomials leave 0.03 to 0.09. But half of its faces are in a plane
	// with their neighbours.
	for (const Index faces : {200, 400, 800}) {
		const TriangleMesh clean = make_part(faces);
		CAPTURE(faces);
		const StepFixture f(clean);
		const NoiseLevels levels = estimate_noise_levels(f.workspace, clean.positions);
		CHECK(levels.flat > LEAST_NOISE);
		CHECK(levels.drawn == 1);
		CHECK(estimated(clean) == 0);
		for (const double sigma : {0.05, 0.1, 0.3}) {
			const TriangleMesh mesh = noisy(clean, sigma);
			const StepFixture g(mesh);
			CHECK(estimate_noise_levels(g.workspace, mesh.positions).drawn == 0);
		}
	}
}

TEST_CASE("Rounded coordinates are noise, a drawn lattice is none", "[noise_level][slow]")
{
	for (const double step : {0.15, 0.3, 0.6}) {
		CAPTURE(step);
		for (const TriangleMesh& truth : {make_sphere(6000), make_torus(6000), make_part(15000)}) {
			const TriangleMesh mesh = rounded(truth, step);
			const StepFixture f(mesh);
			const NoiseLevels levels = estimate_noise_levels(f.workspace, mesh.positions);
			// Faces along the lattice are in planes with their neighbours.
			CHECK(levels.rounding == Approx(step / std::sqrt(12)).epsilon(0.1));
			CHECK(levels.drawn == 0);
			CHECK(estimated(mesh) >= levels.rounding);
			CHECK(estimated(mesh) < 1.2 * levels.rounding);
			// Stronger noise is what there is to take.
			const TriangleMesh twice = rounded(noisy(truth, step), step);
			CHECK(estimated(twice) == Approx(true_level(truth, twice)).epsilon(0.2));
		}
	}
	for (const TriangleMesh& drawn : {make_cube(5000), make_cube(300), make_flat_grid(30)}) {
		const StepFixture f(drawn);
		CHECK(lattice_step(f.workspace, drawn.positions) > 0.5);
		CHECK(estimate_noise_levels(f.workspace, drawn.positions).rounding == 0);
		CHECK(estimated(drawn) == 0);
	}
}

TEST_CASE("Triangles lower than the noise do not lower the estimate", "[noise_level]")
{
	// Half of the vertices in triangles an eighth as wide as the others.
	TriangleMesh clean = make_flat_grid(60);
	for (Point& position : clean.positions)
		position.x() = std::max(position.x(), 0.4375 + 0.125 * position.x());
	for (const double sigma : {0.1, 0.3, 0.5}) {
		CAPTURE(sigma);
		const TriangleMesh mesh = noisy(clean, sigma);
		const double expected = true_level(clean, mesh);
		CHECK(std::abs(estimated(mesh) - expected) < std::max(0.02, 0.15 * expected));
	}
}

TEST_CASE("Noise as strong as edges are long is estimated", "[noise_level]")
{
	for (const TriangleMesh& clean : {make_sphere(20000), make_torus(20000)}) {
		for (const double sigma : {0.6, 1.0, 1.4}) {
			CAPTURE(sigma);
			const TriangleMesh mesh = noisy(clean, sigma);
			CHECK(estimated(mesh) == Approx(true_level(clean, mesh)).epsilon(0.1));
		}
	}
}

TEST_CASE("A mesh without neighbours enough reads as clean", "[noise_level]")
{
	CHECK(estimated(tetrahedron()) == 0);
	CHECK(estimated(unit_square()) == 0);
}

TEST_CASE("The estimate does not depend on size, place or order", "[noise_level][slow]")
{
	// More vertices than are sampled, so that the choice is put to the test as well.
	TriangleMesh mesh = noisy(make_part(90000), 0.2);
	REQUIRE(mesh.vertex_count() > 40000);
	const double expected = estimated(mesh);
	for (const double scale : {1e-3, 1e3}) {
		const Eigen::Matrix3d rotation = some_rotation();
		TriangleMesh there = mesh;
		there.positions =
			each(mesh.positions, [&](const Point& p) { return Point(scale * (rotation * p)); });
		CHECK(estimated(there) == Approx(expected).epsilon(1e-9));
	}
	std::vector<std::size_t> order(mesh.faces.size());
	std::iota(order.begin(), order.end(), std::size_t(0));
	std::mt19937 generator(3);
	std::shuffle(order.begin(), order.end(), generator);
	TriangleMesh shuffled = mesh;
	for (std::size_t i = 0; i < order.size(); ++i) {
		const Face& face = mesh.faces[order[i]];
		shuffled.faces[i] = {face[1], face[2], face[0]};
	}
	CHECK(estimated(shuffled) == Approx(expected).epsilon(1e-9));
}

TEST_CASE("Rare outliers show in ordinary places only", "[noise_level]")
{
	NoiseOptions options;
	options.sigma = 0.5;
	options.impulsive_share = 0.1;
	TriangleMesh mesh = make_sphere(8000);
	mesh.positions = add_noise(mesh, options);
	const StepFixture f(mesh);
	const NoiseLevels levels = estimate_noise_levels(f.workspace, mesh.positions);
	CHECK(levels.ordinary > 0.025);
	CHECK(levels.flat < 0.6 * levels.ordinary);
	// White noise is the same everywhere.
	const TriangleMesh white = noisy(make_sphere(8000), 0.2);
	const StepFixture g(white);
	const NoiseLevels same = estimate_noise_levels(g.workspace, white.positions);
	CHECK(same.flat == Approx(same.ordinary).epsilon(0.05));
	CHECK(same.flat == estimate_noise_level(g.workspace, white.positions));
}

TEST_CASE("A part of the surface with features does not raise the estimate", "[noise_level]")
{
	// A tenth of the squares carry sharp ripples as high as ten times the noise.
	TriangleMesh mesh = make_flat_grid(60);
	for (Point& p : mesh.positions) {
		if (p.x() < 0.1)
			p.z() += std::lround(60 * p.x()) % 2 == 0 ? 0.02 : -0.02;
	}
	const double with_features = estimated(noisy(mesh, 0.1));
	CHECK(with_features == Approx(estimated(noisy(make_flat_grid(60), 0.1))).epsilon(0.15));
}

TEST_CASE("The estimate is the same on any number of threads", "[noise_level][parallel]")
{
	const TriangleMesh mesh = noisy(make_torus(20000), 0.2);
	const double expected = estimated(mesh, 1);
	for (const int threads : {2, 4})
		CHECK(estimated(mesh, threads) == expected);
}

TEST_CASE("The estimate is the same whichever way a mesh lies", "[noise_level]")
{
	// More vertices than any sample has: these are to be the same ones.
	const TriangleMesh mesh = noisy(make_part(60000), 0.25, NoiseDirection::Random);
	const double expected = estimated(mesh);
	const Eigen::Matrix3d rotation = some_rotation();
	const auto turn = [&](const Point& p) { return Point(1e3 * (rotation * p)); };
	CHECK(
		estimated(with_positions(mesh, each(mesh.positions, turn))) ==
		Approx(expected).epsilon(1e-9));
	CHECK(expected > 0.1);
}
