// SPDX-License-Identifier: GPL-3.0-or-later
#include "broad_detail.h"

#include "measures.h"
#include "method_support.h"
#include "prefilter.h"

#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

constexpr double NOISE = 0.2;

// A method that follows noise over few edges only, or over more of them.
std::vector<Point> smoothed(const TriangleMesh& mesh, double pairs)
{
	std::vector<Point> positions = mesh.positions;
	taubin_smooth(StepFixture(mesh).workspace, pairs, positions);
	return positions;
}

/// What a method makes of a mesh, and of it with the probe.
struct Probed {
	/// @param factors of the noise at the vertices, which outlive this, or none
	Probed(const TriangleMesh& mesh, double pairs, const std::vector<double>& factors = {}) :
			f(mesh), positions(smoothed(mesh, pairs)),
			probe(f.workspace, {NOISE * f.workspace.mean_edge_length, factors}, positions),
			detail(f.workspace, probe, positions),
			with_probe(with_positions(mesh, probe.with_probe(positions))),
			share(followed(smoothed(with_probe, pairs)))
	{
	}

	double followed(const std::vector<Point>& probed) const
	{
		return detail.share_followed(probe.responses(positions, probed));
	}

	std::vector<Point> given_back() const
	{
		std::vector<Point> result = positions;
		detail.give_back(share, result);
		return result;
	}

	StepFixture f;
	std::vector<Point> positions;
	Probe probe;
	BroadDetail detail;
	TriangleMesh with_probe;
	double share;
};

double vertex_error(const TriangleMesh& truth, const std::vector<Point>& positions)
{
	return measure(with_positions(truth, positions), truth).vertex_error;
}

} // namespace

TEST_CASE("The probe tells what a method follows of noise", "[broad_detail]")
{
	const TriangleMesh mesh = noisy(make_sphere(8000), NOISE);
	double last = 2;
	for (const double pairs : {5, 20, 80, 320}) {
		const Probed probed(mesh, pairs);
		CAPTURE(pairs);
		CHECK(probed.share < last);
		last = probed.share;
	}
	CHECK(Probed(mesh, 5).share > 0.85);
	// Sum of squares over sum of the filter's own response, and a tenth more for what a method
	// follows of a mesh beyond its result.
	CHECK(Probed(mesh, 30).share == Approx(1.1 * 0.73).margin(0.06));
	CHECK(last < 0.7);
	const Probed probed(mesh, 20);
	CHECK(probed.followed(probed.positions) == 0);
	// A method that leaves all as it is follows all there is.
	const std::vector<Point>& measured = mesh.positions;
	const std::vector<Point> with_probe = probed.probe.with_probe(measured);
	CHECK(probed.detail.share_followed(probed.probe.responses(measured, with_probe)) == 1);
	// The noise each way along the normals, and across them where vertices were measured.
	const double edge = probed.f.workspace.mean_edge_length;
	for (std::size_t i = 0; i < measured.size(); ++i) {
		const Point& normal = probed.probe.normals()[i];
		const Point move = probed.with_probe.positions[i] - probed.positions[i];
		REQUIRE(std::abs(move.dot(normal)) == Approx(NOISE * edge));
		const Point from_measured = probed.with_probe.positions[i] - measured[i];
		REQUIRE((from_measured - from_measured.dot(normal) * normal).norm() < 1e-9 * edge);
	}
}

TEST_CASE("Broad detail is given back, noise is not", "[broad_detail]")
{
	for (const double edges : {8.0, 12.0}) {
		CAPTURE(edges);
		const TriangleMesh truth = bumpy_sphere(12000, edges, 0.8);
		const Probed probed(noisy(truth, NOISE), 320);
		CHECK(probed.detail.certainty(probed.share) == 1);
		const double before = vertex_error(truth, probed.positions);
		CHECK(vertex_error(truth, probed.given_back()) < 0.75 * before);
	}
	for (const double pairs : {20, 80}) {
		const Probed probed(noisy(make_flat_grid(80), NOISE), pairs);
		CHECK(probed.detail.certainty(probed.share) == 0);
		CHECK(same_bits(probed.given_back(), probed.positions));
	}
}

TEST_CASE("Broad detail is given back where noise differs from place to place", "[broad_detail]")
{
	const auto ramp = [](const Point& p) { return 1 + 0.8 * p.x(); };
	const TriangleMesh bumpy = bumpy_sphere(12000, 10, 0.8);
	const std::vector<double> factors = share_at_vertices(bumpy, ramp);
	const Probed probed(unevenly_noisy(bumpy, NOISE, ramp), 320, factors);
	for (std::size_t i = 0; i < factors.size(); ++i) {
		const Point move = probed.with_probe.positions[i] - probed.positions[i];
		const double noise = factors[i] * NOISE * probed.f.workspace.mean_edge_length;
		REQUIRE(std::abs(move.dot(probed.probe.normals()[i])) == Approx(noise));
	}
	const std::vector<Point>& measured = probed.f.mesh.positions;
	const std::vector<Point> with_probe = probed.probe.with_probe(measured);
	CHECK(probed.detail.share_followed(probed.probe.responses(measured, with_probe)) == 1);
	const double before = vertex_error(bumpy, probed.positions);
	CHECK(vertex_error(bumpy, probed.given_back()) < 0.75 * before);
	// What is but higher than thought by a seventh is no detail, if levels are such as differ.
	const TriangleMesh flat = make_flat_grid(80);
	const std::vector<double> same(flat.positions.size(), 1);
	const Probed higher(noisy(flat, 1.14 * NOISE), 80, same);
	CHECK(higher.detail.certainty(higher.share) == 0);
}

TEST_CASE(
	"Broad detail does not depend on threads and numbers, nor moves what is fixed",
	"[broad_detail]")
{
	TriangleMesh truth = bumpy_sphere(6000, 10, 0.8);
	TriangleMesh mesh = noisy(truth, NOISE);
	const Probed here(mesh, 320);
	const std::vector<Point> expected = here.given_back();
	CHECK_FALSE(same_bits(expected, here.positions));
	const StepFixture f(mesh, 2);
	const double sigma = NOISE * f.workspace.mean_edge_length;
	std::vector<Point> positions = here.positions;
	const Probe probe(f.workspace, sigma, positions);
	CHECK(same_bits(probe.with_probe(positions), here.with_probe.positions));
	const BroadDetail detail(f.workspace, probe, positions);
	detail.give_back(here.share, positions);
	CHECK(same_bits(positions, expected));
	const Renumbered other(mesh);
	const Probed there(other.mesh, 320);
	CHECK(there.share == Approx(here.share).epsilon(1e-9));
	const std::vector<Point> back = other.in_given_order(there.given_back());
	CHECK(largest_distance(back, expected) < 1e-9 * f.workspace.mean_edge_length);

	mesh.fixed.assign(mesh.positions.size(), 0);
	for (std::size_t i = 0; i < mesh.fixed.size(); i += 3)
		mesh.fixed[i] = 1;
	const Probed fixed(mesh, 320);
	const std::vector<Point> given = fixed.given_back();
	for (std::size_t i = 0; i < mesh.fixed.size(); i += 3) {
		REQUIRE(given[i] == mesh.positions[i]);
		REQUIRE(fixed.with_probe.positions[i] == mesh.positions[i]);
	}
}
