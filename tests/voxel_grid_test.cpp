// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_grid.h"

#include "method_support.h"
#include "recipes.h"
#include "volume_support.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <string>

using namespace orthopoly;

namespace {

VoxelShares shares_of(const TriangleMesh& mesh, int threads = 1)
{
	const StepFixture f(mesh, threads);
	return voxel_shares(f.workspace, mesh.positions);
}

double share_of(const TriangleMesh& mesh, int threads = 1)
{
	return shares_of(mesh, threads).on;
}

// A block with a hole through it.
double drilled_block(const Point& p)
{
	const double block = (p.cwiseAbs() - Point(0.7, 0.5, 0.3)).maxCoeff();
	return std::max(block, 0.25 - std::hypot(p.x() - 0.1, p.y()));
}

} // namespace

TEST_CASE("Surfaces of volumes lie on a grid, however noisy and whichever way", "[voxel_grid]")
{
	for (const double noise : {0.0, 0.1, 0.3, 0.5}) {
		CAPTURE(noise);
		for (const TriangleMesh& mesh :
			 {ball_of_volume(0.7, 40, noise), surface_of(drilled_block, 40, noise)}) {
			const double here = share_of(mesh);
			CHECK(here > 0.18);
			const Eigen::Matrix3d rotation = some_rotation();
			for (const double scale : {1e-3, 1e3}) {
				const auto there = [&](const Point& p) {
					return Point(scale * (rotation * p) + scale * Point(20, -10, 5));
				};
				// As a file in single precision has it.
				const auto stored = [&](const Point& p) {
					return Point(there(p).cast<float>().cast<double>());
				};
				CHECK(
					share_of(with_positions(mesh, each(mesh.positions, stored))) ==
					Approx(here).margin(0.01));
			}
			CHECK(share_of(Renumbered(mesh).mesh) == Approx(here).margin(0.01));
			CHECK(share_of(mesh, 2) == here);
		}
	}
}

TEST_CASE("Other noisy meshes do not lie on a grid", "[voxel_grid]")
{
	const auto direction = GENERATE(NoiseDirection::Random, NoiseDirection::Isotropic);
	for (const std::string name :
		 {"cube", "sphere", "torus", "part", "height_field", "thin_plate"}) {
		CAPTURE(name);
		CHECK(share_of(noisy(find_recipe(name).make(4000), 0.05, direction)) < 0.04);
	}
	// Noise of every vertex takes a volume's surface off its grid.
	CHECK(share_of(noisy(ball_of_volume(0.7, 30, 0), 0.05, direction)) < 0.04);
}

TEST_CASE("Surfaces whose vertices were moved off the grid lie near it", "[voxel_grid]")
{
	const TriangleMesh mesh = ball_of_volume(0.7, 60, 0.3);
	CHECK(shares_of(mesh).near >= shares_of(mesh).on);
	const VoxelShares moved = shares_of(noisy(mesh, 0.01, NoiseDirection::Random));
	CHECK(moved.on < 0.08);
	CHECK(moved.near > 0.08);
	CHECK(shares_of(noisy(mesh, 0.3, NoiseDirection::Random)).near < 0.05);
	for (const std::string name : {"sphere", "torus", "part", "height_field"}) {
		CAPTURE(name);
		CHECK(shares_of(noisy(find_recipe(name).make(4000), 0.2)).near < 0.06);
	}
}

TEST_CASE("What has edges longer than cubes is none of them", "[voxel_grid]")
{
	// A box in cells of all widths, as what is drawn along the axes has them.
	TriangleMesh box = find_recipe("cube").make(6000);
	CHECK(share_of(box) > 0.2);
	for (Point& p : box.positions)
		p = p.array().sign() * p.array().abs().pow(6);
	CHECK(share_of(box) == 0);
}

TEST_CASE("What lies on a grid is what may move, in what lies there all in all", "[voxel_grid]")
{
	const TriangleMesh clean = ball_of_volume(0.7, 60, 0);
	const TriangleMesh off = noisy(clean, 0.1, NoiseDirection::Random);
	TriangleMesh mesh = clean;
	mesh.fixed.assign(mesh.positions.size(), 0);
	CHECK(share_of(mesh) == share_of(clean));
	for (const bool moving_off : {false, true}) {
		for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
			const bool moving = mesh.positions[i].z() > 0.4;
			mesh.fixed[i] = moving ? 0 : 1;
			mesh.positions[i] = moving == moving_off ? off.positions[i] : clean.positions[i];
		}
		CHECK(share_of(mesh) < 0.08);
	}
}

TEST_CASE("A grid in two directions is none of cubes", "[voxel_grid]")
{
	CHECK(share_of(make_flat_grid(40)) < 0.5);
	CHECK(share_of(noisy(make_flat_grid(40), 0.3)) < 0.02);
}

TEST_CASE("Meshes with hardly an edge lie on no grid", "[voxel_grid]")
{
	CHECK(share_of({}) == 0);
	CHECK(share_of(unit_square()) == 0);
	TriangleMesh point = make_flat_grid(20);
	std::fill(point.positions.begin(), point.positions.end(), Point(1, 2, 3));
	CHECK(share_of(point) == 0);
}
