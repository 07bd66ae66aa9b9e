// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise.h"

#include "defects.h"
#include "errors.h"
#include "seams.h"
#include "shapes.h"
#include "test_support.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

using namespace orthopoly;
using Catch::Contains;

namespace {

NoiseOptions noise(double sigma, NoiseDirection direction, std::uint32_t seed = 1)
{
	NoiseOptions options;
	options.sigma = sigma;
	options.direction = direction;
	options.seed = seed;
	return options;
}

// Displacements in mean edge lengths.
std::vector<Point> displacements(const TriangleMesh& mesh, const NoiseOptions& options)
{
	const std::vector<Point> noisy = add_noise(mesh, options);
	const double edge = mean_edge_length(mesh.positions, mesh.faces);
	std::vector<Point> moved;
	for (std::size_t i = 0; i < noisy.size(); ++i)
		moved.emplace_back((noisy[i] - mesh.positions[i]) / edge);
	return moved;
}

double mean_square(const std::vector<Point>& points)
{
	double sum = 0;
	for (const Point& point : points)
		sum += point.squaredNorm();
	return sum / static_cast<double>(points.size());
}

} // namespace

TEST_CASE("the same seed gives the same noise, another seed another", "[noise]")
{
	const TriangleMesh mesh = make_part(2000);
	const auto direction =
		GENERATE(NoiseDirection::Random, NoiseDirection::Normal, NoiseDirection::Isotropic);
	const std::vector<Point> first = add_noise(mesh, noise(0.2, direction));
	CHECK(same_bits(first, add_noise(mesh, noise(0.2, direction))));
	CHECK_FALSE(same_bits(first, add_noise(mesh, noise(0.2, direction, 2))));
	CHECK_FALSE(same_bits(first, mesh.positions));
}

// What makes "the same on every platform" more than a promise: the bits, as whole numbers.
TEST_CASE("the draws are these on every platform", "[noise]")
{
	TriangleMesh mesh;
	// Edges of 3, 4 and 5: the mean is 4 without any rounding, and so are the products with it.
	mesh.positions = {Point(0, 0, 0), Point(3, 0, 0), Point(0, 4, 0)};
	mesh.faces = {{0, 1, 2}};
	const std::vector<Point> noisy = add_noise(mesh, noise(0.25, NoiseDirection::Isotropic, 42));
	// With sigma at a quarter, the displacement of vertex 0 is three standard normal numbers. These
	// come from a second implementation of the same generators, in another language.
	CHECK(noisy[0].x() == -0x1.0014ee8f00146p-4);
	CHECK(noisy[0].y() == 0x1.1b9df6c89262p-1);
	CHECK(noisy[0].z() == 0x1.71154d0c9f8d1p+0);
}

TEST_CASE("amplitudes are Gaussian with the standard deviation asked for", "[noise]")
{
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	const double sigma = GENERATE(0.05, 0.4);
	const TriangleMesh mesh = placed(make_sphere(80000), scale);
	const auto count = static_cast<double>(mesh.positions.size());

	SECTION("random direction")
	{
		const std::vector<Point> moved = displacements(mesh, noise(sigma, NoiseDirection::Random));
		CHECK(std::sqrt(mean_square(moved)) == Approx(sigma).epsilon(0.02));
		// Evenly from the sphere: every axis gets a third.
		for (int axis = 0; axis < 3; ++axis) {
			double sum = 0;
			double squares = 0;
			for (const Point& point : moved) {
				sum += point[axis];
				squares += point[axis] * point[axis];
			}
			CHECK(squares / count == Approx(sigma * sigma / 3).epsilon(0.05));
			CHECK(std::abs(sum / count) < 0.01 * sigma);
		}
		// A Gaussian has 68.3 % within one deviation and 4.55 % beyond two.
		const auto beyond = [&](double deviations) {
			return static_cast<double>(std::count_if(
					   moved.begin(),
					   moved.end(),
					   [&](const Point& point) { return point.norm() > deviations * sigma; })) /
				   count;
		};
		CHECK(beyond(1) == Approx(0.3173).margin(0.01));
		CHECK(beyond(2) == Approx(0.0455).margin(0.005));
		CHECK(beyond(3) == Approx(0.0027).margin(0.0015));
	}
	SECTION("along the normal")
	{
		const std::vector<Point> moved = displacements(mesh, noise(sigma, NoiseDirection::Normal));
		CHECK(std::sqrt(mean_square(moved)) == Approx(sigma).epsilon(0.02));
		for (std::size_t i = 0; i < moved.size(); ++i) {
			const double across = moved[i].cross(mesh.positions[i].normalized()).norm();
			REQUIRE(across <= 0.02 * moved[i].norm());
		}
	}
	SECTION("along each axis")
	{
		const std::vector<Point> moved =
			displacements(mesh, noise(sigma, NoiseDirection::Isotropic));
		CHECK(std::sqrt(mean_square(moved)) == Approx(std::sqrt(3.0) * sigma).epsilon(0.02));
		double product = 0;
		for (const Point& point : moved)
			product += point.x() * point.y();
		CHECK(std::abs(product / count) < 0.02 * sigma * sigma);
	}
}

TEST_CASE("noise scales with sigma and with the mesh", "[noise]")
{
	const TriangleMesh mesh = make_torus(1000);
	const std::vector<Point> one = displacements(mesh, noise(0.1, NoiseDirection::Random));
	const std::vector<Point> two = displacements(mesh, noise(0.2, NoiseDirection::Random));
	const std::vector<Point> large =
		displacements(placed(mesh, 1e6), noise(0.1, NoiseDirection::Random));
	for (std::size_t i = 0; i < one.size(); ++i) {
		REQUIRE((two[i] - 2 * one[i]).norm() < 1e-12);
		REQUIRE((large[i] - one[i]).norm() < 1e-9);
	}
}

TEST_CASE("no noise leaves every bit alone", "[noise]")
{
	const TriangleMesh mesh = make_part(1000);
	CHECK(same_bits(add_noise(mesh, noise(0, NoiseDirection::Isotropic)), mesh.positions));
	NoiseOptions options = noise(0.3, NoiseDirection::Random);
	options.impulsive_share = 0;
	CHECK(same_bits(add_noise(mesh, options), mesh.positions));
}

TEST_CASE("impulsive noise moves its share, and those as the ordinary noise would", "[noise]")
{
	const TriangleMesh mesh = make_sphere(20000);
	NoiseOptions options = noise(0.3, NoiseDirection::Random);
	const std::vector<Point> ordinary = add_noise(mesh, options);
	options.impulsive_share = 0.1;
	const std::vector<Point> impulsive = add_noise(mesh, options);
	std::size_t moved = 0;
	for (std::size_t i = 0; i < impulsive.size(); ++i) {
		if (impulsive[i] == mesh.positions[i])
			continue;
		++moved;
		REQUIRE(impulsive[i] == ordinary[i]);
	}
	CHECK(
		static_cast<double>(moved) / static_cast<double>(impulsive.size()) ==
		Approx(0.1).margin(0.01));
}

TEST_CASE("fixed vertices stay, and the others do not notice", "[noise]")
{
	TriangleMesh mesh = make_part(1000);
	const std::vector<Point> free = add_noise(mesh, noise(0.2, NoiseDirection::Random));
	mesh.fixed.assign(mesh.positions.size(), 0);
	for (std::size_t i = 0; i < mesh.fixed.size(); i += 3)
		mesh.fixed[i] = 1;
	const std::vector<Point> noisy = add_noise(mesh, noise(0.2, NoiseDirection::Random));
	for (std::size_t i = 0; i < noisy.size(); ++i)
		REQUIRE(noisy[i] == (mesh.fixed[i] != 0 ? mesh.positions[i] : free[i]));
}

TEST_CASE("vertices that are the same on a seam move together", "[noise]")
{
	const TriangleMesh mesh = make_seam();
	TriangleMesh noisy = mesh;
	noisy.positions = add_noise(mesh, noise(0.2, NoiseDirection::Normal));
	CHECK(find_seams(noisy).repeated == find_seams(mesh).repeated);
	CHECK(noisy.positions.back() != mesh.positions.back());
}

TEST_CASE("defects do not spoil the noise", "[noise]")
{
	const auto direction =
		GENERATE(NoiseDirection::Random, NoiseDirection::Normal, NoiseDirection::Isotropic);
	CHECK(all_finite(add_noise(make_degenerate_face(), noise(0.2, direction))));
	CHECK(all_finite(add_noise(make_unreferenced_vertex(), noise(0.2, direction))));
	CHECK(all_finite(add_noise(make_duplicate_face(), noise(0.2, direction))));
	// Without faces around it, a vertex has no normal to move along.
	const TriangleMesh mesh = make_unreferenced_vertex();
	CHECK((add_noise(mesh, noise(0.2, NoiseDirection::Normal)).back() == mesh.positions.back()));
}

TEST_CASE("noise that makes no sense is refused", "[noise]")
{
	const TriangleMesh mesh = make_part(1000);
	for (const double sigma : {-0.1, std::nan(""), std::numeric_limits<double>::infinity(), 11.0}) {
		CHECK_THROWS_AS(add_noise(mesh, noise(sigma, NoiseDirection::Random)), InvalidParameter);
		CHECK_THROWS_WITH(add_noise(mesh, noise(sigma, NoiseDirection::Random)), Contains("sigma"));
	}
	NoiseOptions options;
	for (const double share : {-0.1, 1.1, std::nan("")}) {
		options.impulsive_share = share;
		CHECK_THROWS_WITH(add_noise(mesh, options), Contains("impulsive_share"));
	}
	CHECK_THROWS_WITH(add_noise(make_points_only(), NoiseOptions()), Contains("no faces"));
	CHECK_THROWS_AS(add_noise(make_nan_coordinate(), NoiseOptions()), InvalidMesh);
}
