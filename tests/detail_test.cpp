// SPDX-License-Identifier: GPL-3.0-or-later
#include "detail.h"

#include "measures.h"
#include "method_support.h"
#include "recipes.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>

using namespace orthopoly;

namespace {

// Root mean square of the distances between two meshes' vertices whose flag is as wanted.
double distance(
	const std::vector<Point>& a,
	const std::vector<Point>& b,
	const std::vector<bool>& flags,
	bool wanted)
{
	double sum = 0;
	double count = 0;
	for (std::size_t i = 0; i < a.size(); ++i) {
		if (flags[i] == wanted) {
			sum += (a[i] - b[i]).squaredNorm();
			++count;
		}
	}
	return std::sqrt(sum / count);
}

} // namespace

TEST_CASE("Noise alone is not given back", "[detail]")
{
	const auto direction =
		GENERATE(NoiseDirection::Normal, NoiseDirection::Random, NoiseDirection::Isotropic);
	const TriangleMesh truth = make_sphere(20000);
	const StepFixture f(noisy(truth, 0.2, direction));
	std::vector<Point> positions = truth.positions;
	const double sigma = direction == NoiseDirection::Random ? 0.2 / std::sqrt(3) : 0.2;
	give_back_detail(f.workspace, sigma * f.workspace.mean_edge_length, 1, positions);
	std::size_t moved = 0;
	double energy = 0;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		moved += !same_bits(positions[i], truth.positions[i]);
		energy += (positions[i] - truth.positions[i]).squaredNorm();
	}
	const auto count = static_cast<double>(positions.size());
	CHECK(moved < 0.01 * count);
	CHECK(std::sqrt(energy / count) < 0.02 * sigma * f.workspace.mean_edge_length);
}

TEST_CASE("Detail below the noise is given back where neighbours have it in common", "[detail]")
{
	// Half of the square has ridges six edges apart, as high as the noise; both were smoothed.
	const TriangleMesh flat = make_flat_grid(80);
	const double edge = mean_edge_length(flat.positions, flat.faces);
	const double sigma = 0.2 * edge;
	TriangleMesh truth = flat;
	std::vector<bool> ridged(flat.positions.size());
	for (std::size_t i = 0; i < ridged.size(); ++i) {
		Point& p = truth.positions[i];
		ridged[i] = p.x() < 0.5;
		if (ridged[i])
			p.z() = sigma * std::sin(2 * std::acos(-1.0) * p.y() / (6 * edge));
	}
	const StepFixture f(with_positions(truth, noisy(truth, 0.2).positions));
	std::vector<Point> positions = flat.positions;
	give_back_detail(f.workspace, sigma, 1, positions);
	const double before = distance(flat.positions, truth.positions, ridged, true);
	CHECK(distance(positions, truth.positions, ridged, true) < 0.75 * before);
	CHECK(distance(positions, truth.positions, ridged, false) < 0.3 * sigma);
}

TEST_CASE("Ridges as narrow as the triangles are given back", "[detail]")
{
	// They run aslant, so that the six neighbours of a vertex together say nothing of it.
	const TriangleMesh flat = make_flat_grid(60);
	const double edge = mean_edge_length(flat.positions, flat.faces);
	const double sigma = 0.15 * edge;
	TriangleMesh truth = flat;
	for (Point& p : truth.positions)
		p.z() = 1.5 * sigma * std::sin(2 * std::acos(-1.0) * (p.x() + 2 * p.y()) / (5 * edge));
	const StepFixture f(with_positions(truth, noisy(truth, 0.15).positions));
	std::vector<Point> positions = flat.positions;
	const TakenMoves taken = give_back_detail(f.workspace, sigma, 1, positions);
	CHECK(taken.predicted > 0.35);
	const std::vector<bool> everywhere(positions.size(), true);
	CHECK(
		distance(positions, truth.positions, everywhere, true) <
		0.6 * distance(flat.positions, truth.positions, everywhere, true));
	// Noise alone is not predicted.
	const StepFixture noise(noisy(flat, 0.15));
	positions = flat.positions;
	CHECK(give_back_detail(noise.workspace, sigma, 1, positions).predicted < 0.1);
}

TEST_CASE("Vertices that make up for those around them are not detail", "[detail]")
{
	// As simplified meshes have it: whichever way a neighbour lies, it is up where this one is
	// down.
	const TriangleMesh flat = make_flat_grid(60);
	const StepFixture noise(noisy(flat, 0.15));
	std::vector<Point> measured = noise.mesh.positions;
	for (std::size_t i = 0; i < measured.size(); ++i) {
		double sum = 0;
		const Index vertex = static_cast<Index>(i);
		for (const Index* it = noise.workspace.vertex_faces.begin(vertex);
			 it != noise.workspace.vertex_faces.end(vertex);
			 ++it) {
			for (const Index corner : noise.mesh.faces[at(*it)])
				sum += corner != vertex ? noise.mesh.positions[at(corner)].z() : 0;
		}
		measured[i].z() -= 0.5 * sum / noise.workspace.vertex_faces.size(vertex);
	}
	const StepFixture f(with_positions(flat, measured));
	std::vector<Point> positions = flat.positions;
	const double sigma = 0.15 * mean_edge_length(flat.positions, flat.faces);
	CHECK(give_back_detail(f.workspace, sigma, 1, positions).predicted < 0.05);
}

TEST_CASE("Vertices that slid along an edge are not detail", "[detail]")
{
	// Roofs side by side, whose ridges were moved along a side.
	TriangleMesh truth = make_flat_grid(60);
	TriangleMesh mesh = truth;
	const double sigma = 0.2 / 60;
	for (std::size_t i = 0; i < truth.positions.size(); ++i) {
		const long column = std::lround(60 * truth.positions[i].x());
		const long height = std::abs((column + 2) % 4 - 2);
		truth.positions[i].z() = static_cast<double>(height) / 60;
		mesh.positions[i] = truth.positions[i];
		if (height == 2)
			mesh.positions[i] += 2.2 * sigma * Point(1, 0, -1);
	}
	const StepFixture f(mesh);
	std::vector<Point> positions = truth.positions;
	give_back_detail(f.workspace, sigma, 1, positions);
	CHECK(same_bits(positions, truth.positions));
}

TEST_CASE("Detail beyond the noise is given back, as far as it is detail", "[detail]")
{
	// One half of the square is rough, three times as much as the noise; both halves were smoothed.
	const TriangleMesh flat = make_flat_grid(60);
	const double edge = mean_edge_length(flat.positions, flat.faces);
	const double sigma = 0.1 * edge;
	TriangleMesh truth = flat;
	std::vector<bool> rough(flat.positions.size());
	std::mt19937 generator(5);
	for (std::size_t i = 0; i < rough.size(); ++i) {
		rough[i] = flat.positions[i].x() < 0.5;
		if (rough[i])
			truth.positions[i].z() = generator() % 2 == 0 ? 3 * sigma : -3 * sigma;
	}
	const StepFixture f(with_positions(truth, noisy(truth, 0.1).positions));
	std::vector<Point> positions = flat.positions;
	give_back_detail(f.workspace, sigma, 1, positions);
	const double before = distance(flat.positions, truth.positions, rough, true);
	CHECK(distance(positions, truth.positions, rough, true) < 0.5 * before);
	// The flat half stays as it was, but for the rows next to the other.
	const double noise = distance(f.mesh.positions, truth.positions, rough, false);
	CHECK(distance(positions, truth.positions, rough, false) < 0.3 * noise);
	// Half of the way at most.
	std::vector<Point> halfway = flat.positions;
	give_back_detail(f.workspace, sigma, 0.5, halfway);
	for (std::size_t i = 0; i < positions.size(); ++i)
		CHECK((flat.positions[i] + positions[i]).isApprox(2 * halfway[i], 1e-12));
}

TEST_CASE("A vertex far off does not make its surroundings detail", "[detail]")
{
	TriangleMesh mesh = make_flat_grid(40);
	const std::size_t middle = 20 * 41 + 20;
	mesh.positions[middle].z() = 1;
	const StepFixture f(mesh);
	std::vector<Point> positions = make_flat_grid(40).positions;
	give_back_detail(f.workspace, 0.1 * f.workspace.mean_edge_length, 1, positions);
	CHECK(positions[middle].z() < 0.2);
}

TEST_CASE("Inliers are given back, outliers are not", "[detail]")
{
	// Denoising took the detail of all vertices, and one in ten of these was an outlier.
	const TriangleMesh flat = make_flat_grid(60);
	const double edge = mean_edge_length(flat.positions, flat.faces);
	TriangleMesh truth = flat;
	std::mt19937 generator(5);
	for (Point& p : truth.positions)
		p.z() = (generator() % 2 == 0 ? 0.02 : -0.02) * edge;
	TriangleMesh mesh = truth;
	std::vector<bool> outlying(mesh.positions.size());
	for (std::size_t i = 0; i < outlying.size(); ++i) {
		outlying[i] = generator() % 10 == 0;
		if (outlying[i])
			mesh.positions[i].z() += 0.5 * edge;
	}
	const StepFixture f(mesh);
	std::vector<Point> positions = flat.positions;
	give_back_inliers(f.workspace, 0, 1, positions);
	CHECK(distance(positions, truth.positions, outlying, false) == 0);
	CHECK(distance(positions, flat.positions, outlying, true) == 0);
	// Where all vertices are as noisy as that, none is.
	std::vector<Point> noise = flat.positions;
	give_back_inliers(f.workspace, 0.03 * edge, 1, noise);
	CHECK(same_bits(noise, flat.positions));
}

TEST_CASE("Fixed vertices stay where they were put", "[detail]")
{
	TriangleMesh mesh = noisy(make_flat_grid(20), 0.3);
	mesh.fixed.assign(mesh.positions.size(), 1);
	const StepFixture f(mesh);
	std::vector<Point> flat = make_flat_grid(20).positions;
	for (Point& p : flat)
		p.z() = -0.0; // adding nothing would turn it into 0.0
	std::vector<Point> positions = flat;
	give_back_detail(f.workspace, 1e-6, 1, positions);
	give_back_inliers(f.workspace, 0, 1, positions);
	CHECK(same_bits(positions, flat));
}

TEST_CASE("What is given back is the same on any number of threads", "[detail][parallel]")
{
	const TriangleMesh truth = make_sphere(20000);
	const TriangleMesh mesh = noisy(truth, 0.2);
	std::vector<std::vector<Point>> results;
	for (const int threads : {1, 2, 3}) {
		const StepFixture f(mesh, threads);
		std::vector<Point> positions = truth.positions;
		give_back_detail(f.workspace, 0.1 * f.workspace.mean_edge_length, 1, positions);
		give_back_inliers(f.workspace, 0.01 * f.workspace.mean_edge_length, 1, positions);
		results.push_back(positions);
	}
	CHECK(same_bits(results[0], results[1]));
	CHECK(same_bits(results[0], results[2]));
}

TEST_CASE("What is detail where there is little noise is noise where there is much", "[detail]")
{
	// The same bumps were taken everywhere; half of the square has noise as high, the rest a tenth.
	const TriangleMesh flat = make_flat_grid(60);
	const TriangleMesh mesh = noisy(flat, 0.2);
	const StepFixture f(mesh);
	std::vector<double> factors;
	std::vector<bool> noise;
	for (const Point& p : flat.positions) {
		noise.push_back(p.x() < 0.5);
		factors.push_back(noise.back() ? 1 : 0.1);
	}
	std::vector<Point> positions = flat.positions;
	give_back_detail(f.workspace, {0.2 * f.workspace.mean_edge_length, factors}, 1, positions);
	const double whole = distance(mesh.positions, flat.positions, noise, true);
	CHECK(distance(positions, flat.positions, noise, true) < 0.35 * whole);
	CHECK(distance(positions, mesh.positions, noise, false) < 0.35 * whole);
}
