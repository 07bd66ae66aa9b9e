// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_correlation.h"

#include "local_heights.h"
#include "method_support.h"
#include "recipes.h"
#include "volume_support.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <string>
#include <vector>

using namespace orthopoly;

namespace {

NoiseCorrelation measured(const TriangleMesh& mesh, int threads = 1, bool in_any_case = false)
{
	const StepFixture f(mesh, threads);
	const std::vector<Point> smooth = surface_below_heights(f.workspace, mesh.positions);
	return measure_noise_correlation(f.workspace, mesh.positions, smooth, in_any_case);
}

// What a depth camera sees of a hill on a plain, without its noise: a regular grid from above.
TriangleMesh depth_image(int n = 60)
{
	TriangleMesh mesh = make_flat_grid(n);
	for (Point& p : mesh.positions)
		p.z() = 0.25 * std::exp(-((p - Point(0.5, 0.4, 0)).squaredNorm()) / 0.05);
	return mesh;
}

} // namespace

TEST_CASE("White noise is not taken for correlated, on any surface", "[noise_correlation][slow]")
{
	const auto direction =
		GENERATE(NoiseDirection::Normal, NoiseDirection::Random, NoiseDirection::Isotropic);
	for (const std::string name :
		 {"cube", "sphere", "torus", "part", "height_field", "thin_plate"}) {
		for (const double sigma : {0.05, 0.2, 0.6}) {
			CAPTURE(name, static_cast<int>(direction), sigma);
			const TriangleMesh mesh = noisy(find_recipe(name).make(4000), sigma, direction);
			CHECK(measured(mesh).certainty() == 0);
			CHECK(measured(mesh).by_rise().certainty == 0);
		}
	}
	for (const double sigma : {0.05, 0.2, 0.6}) {
		CAPTURE(sigma);
		const NoiseCorrelation found = measured(noisy(depth_image(), sigma, direction));
		CHECK(found.certainty() == 0);
		CHECK(std::abs(found.edge_correlation) < 0.09);
	}
}

TEST_CASE("Outliers are not taken for correlated noise", "[noise_correlation]")
{
	NoiseOptions options;
	options.impulsive_share = 0.3;
	for (const double sigma : {0.1, 0.4}) {
		TriangleMesh mesh = depth_image();
		options.sigma = sigma;
		mesh.positions = add_noise(mesh, options);
		CHECK(measured(mesh).certainty() == 0);
	}
}

TEST_CASE("The noise of a depth camera is found", "[noise_correlation]")
{
	for (const double sigma : {0.3, 0.4}) {
		CAPTURE(sigma);
		const NoiseCorrelation found = measured(with_correlated_noise(depth_image(), sigma, 2));
		CHECK(found.certainty() > 0.6);
		CHECK(found.edge_correlation > 0.2);
		CHECK(found.growth < 2);
		CHECK(found.unevenness < 1.5);
		// The longest waves are taken for the surface.
		CHECK(found.level > 0.5 * sigma);
		CHECK(found.level < sigma);
		CHECK(found.narrow_level < found.level);
		CHECK(found.reach() == 1);
	}
}

TEST_CASE("The noise of a volume is found", "[noise_correlation]")
{
	for (const double noise : {0.2, 0.3, 0.5}) {
		CAPTURE(noise);
		const NoiseCorrelation found = measured(ball_of_volume(0.7, 60, noise));
		CHECK(found.is_of_voxels() == 1);
		CHECK(found.view_irregularity > 0.99);
		CHECK(found.edge_correlation > 0.2);
		CHECK(found.growth < 1.6);
		CHECK(found.certainty() > 0.8);
	}
}

TEST_CASE("The noise of a reconstruction from points is found", "[noise_correlation]")
{
	for (const double noise : {0.15, 0.3}) {
		CAPTURE(noise);
		const TriangleMesh mesh = ball_from_points(0.7, 60, noise);
		const NoiseCorrelation found = measured(mesh);
		CHECK(found.edge_correlation > 0.25);
		CHECK(found.middle_growth < 1.6);
		CHECK(found.middle_growth < found.growth);
		CHECK(found.certainty() > 0.8);
		CHECK(found.reach() > measured(ball_of_volume(0.7, 60, noise)).reach() + 0.1);
		// Its vertices moved to where moving least squares have the surface.
		const NoiseCorrelation moved = measured(noisy(mesh, 0.01, NoiseDirection::Random));
		CHECK(moved.voxels.on < 0.08);
		CHECK(moved.certainty() > 0.6);
	}
}

TEST_CASE(
	"What is measured in any case is the same where it is told by itself", "[noise_correlation]")
{
	const TriangleMesh ball = ball_of_volume(0.7, 40, 0.3);
	const TriangleMesh sphere = noisy(find_recipe("sphere").make(4000), 0.4);
	const auto narrow_level = [](const TriangleMesh& mesh, bool in_any_case) {
		return measured(mesh, 1, in_any_case).narrow_level;
	};
	CHECK(narrow_level(ball, true) == narrow_level(ball, false));
	CHECK(narrow_level(sphere, false) == 0);
	CHECK(narrow_level(sphere, true) > 0.1);
}

TEST_CASE("A volume without noise of its own has none that goes together", "[noise_correlation]")
{
	const TriangleMesh clean = ball_of_volume(0.7, 60, 0);
	CHECK(measured(clean).is_of_voxels() == 1);
	CHECK(measured(clean).certainty() == 0);
	for (const double sigma : {0.1, 0.3})
		CHECK(measured(noisy(clean, sigma)).certainty() == 0);
	// Bumps as small as the cubes let it.
	const auto bumpy = [](const Point& p) {
		const double waves = std::sin(16 * p.x()) * std::sin(16 * p.y()) * std::sin(16 * p.z());
		return p.norm() - 0.7 + 0.04 * waves;
	};
	CHECK(measured(surface_of(bumpy, 60, 0)).certainty() == 0);
}

TEST_CASE("Only a single view can be a depth camera's", "[noise_correlation]")
{
	for (const std::string name : {"cube", "sphere", "torus"}) {
		CAPTURE(name);
		const NoiseCorrelation found =
			measured(with_correlated_noise(find_recipe(name).make(4000), 0.4));
		CHECK(found.view_irregularity > 0.99);
		CHECK(found.certainty() == 0);
	}
	CHECK(measured(depth_image()).view_irregularity < 1e-6);
	CHECK(measured(make_height_field(8000)).view_irregularity < 0.25);
}

TEST_CASE("Noise along the view does not hide it", "[noise_correlation]")
{
	TriangleMesh mesh = depth_image();
	const TriangleMesh strong = noisy(mesh, 1.0);
	for (std::size_t i = 0; i < mesh.positions.size(); ++i)
		mesh.positions[i].z() += (strong.positions[i] - mesh.positions[i]).norm();
	CHECK(measured(mesh).view_irregularity < 1e-6);
}

TEST_CASE("Rough ground is not taken for noise", "[noise_correlation][slow]")
{
	// Waves of several lengths over the whole of it, the longer the higher, a little white noise.
	TriangleMesh mesh = make_flat_grid(80);
	for (Point& p : mesh.positions) {
		for (int wave = 4; wave <= 16; wave *= 2)
			p.z() += 0.12 / wave * std::sin(2 * M_PI * wave * p.x() + 0.7 * wave) *
					 std::cos(2 * M_PI * wave * p.y() + 0.3 * wave);
	}
	for (const double sigma : {0.02, 0.05, 0.1}) {
		CAPTURE(sigma);
		CHECK(measured(noisy(mesh, sigma)).certainty() < 0.1);
		CHECK(measured(noisy(mesh, sigma)).by_rise().certainty == 0);
	}
	const TriangleMesh rough = with_relief(make_sphere(20000));
	const NoiseCorrelation found = measured(rough);
	CAPTURE(found.first_rise, found.further_rise, found.middle_level);
	CHECK(found.first_rise > 0.7);
	CHECK(found.middle_level > 0.045);
	CHECK(found.by_rise().certainty == 0);
	CHECK(measured(noisy(rough, 0.1)).by_rise().certainty == 0);
}

TEST_CASE("Grooves of one width do not rise like noise that was smoothed", "[noise_correlation]")
{
	const TriangleMesh sphere = make_sphere(40000);
	const double edge = mean_edge_length(sphere.positions, sphere.faces);
	for (const double height : {0.1, 0.2}) {
		CAPTURE(height);
		const auto grooved = [&](const Point& p) {
			const double along = (p.x() + 2 * p.y() + p.z()) / std::sqrt(6.0);
			const double waves = std::sin(2 * PI * along / (3 * edge));
			return Point(p + height * edge * waves * p.normalized());
		};
		const NoiseCorrelation found =
			measured(with_positions(sphere, each(sphere.positions, grooved)));
		CAPTURE(found.first_rise, found.further_rise);
		CHECK(found.middle_level > 0.5 * height);
		CHECK(found.by_rise().certainty == 0);
	}
}

TEST_CASE(
	"Noise that was smoothed rises with the rings, and then no more", "[noise_correlation][slow]")
{
	for (const std::string name : {"cube", "sphere", "torus", "part"}) {
		for (const double sigma : {0.08, 0.15}) {
			CAPTURE(name, sigma);
			const TriangleMesh clean = find_recipe(name).make(40000);
			const NoiseCorrelation found = measured(with_correlated_noise(clean, sigma, 1));
			CAPTURE(found.first_rise, found.further_rise, found.middle_level);
			CHECK(found.first_rise > 0.65);
			CHECK(found.further_rise < 0.7);
			CHECK(found.deviation() == Approx(sigma).epsilon(0.15));
			CHECK(found.by_rise().certainty > 0.8);
			CHECK(measured(clean).by_rise().certainty == 0);
		}
	}
	// On flat faces it may be faint.
	for (const std::string name : {"cube", "part"}) {
		const TriangleMesh faint = with_correlated_noise(find_recipe(name).make(40000), 0.015, 1);
		CHECK(measured(faint).by_rise().certainty > 0.8);
	}
}

TEST_CASE(
	"Noise that was smoothed is alike everywhere to three rings, however a surface bends",
	"[noise_correlation][slow]")
{
	for (const TriangleMesh& clean : {make_torus(8000), bumpy_sphere(12000, 20, 1.0)}) {
		CAPTURE(clean.face_count());
		CHECK(measured(clean).by_rise().certainty == 0);
		const TriangleMesh white = noisy(clean, 0.1);
		CHECK(measured(white).by_rise().certainty == 0);
		CHECK(measured(white, 1, true).near.edge_correlation < 0.03);
		for (const double sigma : {0.12, 0.2}) {
			CAPTURE(sigma);
			const NoiseCorrelation found = measured(with_correlated_noise(clean, sigma, 1));
			CHECK(found.near.unevenness < 1.4);
			CHECK(found.near.edge_correlation > 0.13);
			CHECK(found.near.rise == Approx(1.35).margin(0.1));
			CHECK(found.near.next_rise < 0.75 * found.near.rise);
			CHECK(found.near.level == Approx(0.5 * sigma).epsilon(0.1));
			CHECK(found.by_rise().certainty > 0.79);
		}
	}
	// Where edges are near most places, the flattest are alike.
	const TriangleMesh part = make_part(12000);
	CHECK(measured(part).by_rise().certainty == 0);
	CHECK(measured(noisy(part, 0.12)).by_rise().certainty == 0);
	const NoiseCorrelation on_part = measured(with_correlated_noise(part, 0.12, 1));
	CHECK(on_part.near.unevenness > 2);
	CHECK(on_part.near.spread < 1.16);
	CHECK(on_part.by_rise().certainty > 0.99);
	// Ground that is as rough everywhere does not bend.
	const NoiseCorrelation rough = measured(with_relief(make_torus(8000)), 1, true);
	CHECK(rough.near.unevenness < 1.5);
	CHECK(rough.by_rise().certainty == 0);
}

TEST_CASE("Noise that was smoothed more rises steeply and bends", "[noise_correlation][slow]")
{
	for (const std::string name : {"cube", "sphere", "thin_plate"}) {
		const TriangleMesh clean = find_recipe(name).make(16000);
		CHECK(measured(clean).by_rise().certainty == 0);
		for (const int steps : {2, 3, 4}) {
			CAPTURE(name, steps);
			const NoiseCorrelation found = measured(with_correlated_noise(clean, 0.12, steps));
			CAPTURE(found.first_rise, found.further_rise, found.narrow_spread);
			CHECK(found.first_rise - found.further_rise > 0.6);
			CHECK(found.narrow_spread < 1.18);
			CHECK(found.by_rise().certainty > 0.5);
			CHECK(found.deviation() == Approx(0.12).epsilon(0.35));
		}
	}
}

TEST_CASE("What a trial takes decides where residuals do not", "[noise_correlation][slow]")
{
	const CorrelatedMoves of_noise = {1.13, 1.2, 0.35};
	const CorrelatedMoves of_hardly_smoothed_noise = {1.1, 1.18, 0.12};
	const CorrelatedMoves of_white_noise = {1.08, 1.14, 0.02};
	const CorrelatedMoves of_detail = {1.35, 1.9, 0.5};
	for (const TriangleMesh& clean : {make_torus(8000), make_part(12000)}) {
		CAPTURE(clean.face_count());
		CHECK(measured(clean).worth_trying() == 0);
		for (const double sigma : {0.05, 0.2, 0.4})
			CHECK(measured(noisy(clean, sigma)).worth_trying() == 0);
		const NoiseCorrelation smoothed = measured(with_correlated_noise(clean, 0.15, 1));
		CHECK(smoothed.worth_trying() > 0.9);
		CHECK(smoothed.by_trial(of_noise) > 0.9);
		const NoiseCorrelation hardly = measured(hardly_smoothed(noisy(clean, 0.3)));
		CHECK(hardly.by_rise().certainty == 0);
		CHECK(hardly.worth_trying() > 0.8);
		CHECK(hardly.by_trial(of_hardly_smoothed_noise) > 0.8);
		// That would have been smoothed more.
		CHECK(hardly.by_trial({1.13, 1.2, 0.5}) == 0);
		for (const NoiseCorrelation& found : {smoothed, hardly}) {
			CHECK(found.by_trial(of_white_noise) == 0);
			CHECK(found.by_trial(of_detail) == 0);
		}
	}
	// Detail that is the same all over is taken alike, and goes together.
	for (const TriangleMesh& rough : {with_relief(make_sphere(20000)), bumpy_sphere(12000, 8, 0.3)})
		CHECK(measured(noisy(rough, 0.1)).by_trial(of_noise) == 0);
}

TEST_CASE("Size, place, turn and order do not matter to the kind of noise", "[noise_correlation]")
{
	const TriangleMesh mesh = with_correlated_noise(depth_image(), 0.3, 2);
	const NoiseCorrelation here = measured(mesh);
	const auto check = [&](const NoiseCorrelation& found) {
		CHECK(found.view_irregularity == Approx(here.view_irregularity).epsilon(1e-9));
		CHECK(found.edge_correlation == Approx(here.edge_correlation).epsilon(1e-7));
		CHECK(found.growth == Approx(here.growth).epsilon(1e-9));
		CHECK(found.unevenness == Approx(here.unevenness).epsilon(1e-9));
		CHECK(found.level == Approx(here.level).epsilon(1e-9));
		CHECK(found.deviation() == Approx(here.deviation()).epsilon(1e-7));
		CHECK(found.certainty() == Approx(here.certainty()).epsilon(1e-6));
		CHECK(found.first_rise == Approx(here.first_rise).epsilon(1e-7));
		CHECK(found.further_rise == Approx(here.further_rise).epsilon(1e-7));
		CHECK(found.narrow_spread == Approx(here.narrow_spread).epsilon(1e-7));
	};
	for (const double scale : {1e-3, 1e3}) {
		const Eigen::Matrix3d rotation = some_rotation();
		const auto there = [&](const Point& p) { return Point(scale * (rotation * p)); };
		check(measured(with_positions(mesh, each(mesh.positions, there))));
	}
	check(measured(Renumbered(mesh).mesh));
}

TEST_CASE("Coarse boxes are no volumes", "[noise_correlation][slow]")
{
	// Edges everywhere look like noise.
	for (const std::string name : {"cube", "part", "thin_plate"}) {
		for (const int faces : {600, 1500, 4000}) {
			CAPTURE(name, faces);
			const TriangleMesh clean = find_recipe(name).make(faces);
			CHECK(measured(clean).certainty() == 0);
			CHECK(measured(clean).by_rise().certainty == 0);
			CHECK(measured(noisy(clean, 0.1)).certainty() == 0);
		}
	}
}

TEST_CASE("A mesh too small to tell is white", "[noise_correlation]")
{
	CHECK(measured(unit_square()).certainty() == 0);
	CHECK(measured(with_correlated_noise(make_flat_grid(4), 0.4)).certainty() == 0);
	// Nothing is left over on a plane, so there is nothing to judge.
	CHECK(measured(make_flat_grid(30)).certainty() == 0);
}

TEST_CASE("The kind of noise is the same on any number of threads", "[noise_correlation][parallel]")
{
	const TriangleMesh mesh = with_correlated_noise(depth_image(), 0.3, 2);
	const NoiseCorrelation one = measured(mesh, 1);
	for (const int threads : {2, 4}) {
		const NoiseCorrelation many = measured(mesh, threads);
		CHECK(many.edge_correlation == one.edge_correlation);
		CHECK(many.growth == one.growth);
		CHECK(many.certainty() == one.certainty());
		CHECK(many.first_rise == one.first_rise);
		CHECK(many.further_rise == one.further_rise);
	}
}
