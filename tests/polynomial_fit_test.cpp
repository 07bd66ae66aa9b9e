// SPDX-License-Identifier: GPL-3.0-or-later
#include "polynomial_fit.h"

#include "defects.h"
#include "guide_direction.h"
#include "step_fixture.h"

#include <Eigen/Dense>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <random>

using namespace orthopoly;

namespace {

std::vector<Point> random_vectors(std::size_t count)
{
	std::mt19937 generator(3);
	const auto next = [&]() { return generator() / double(std::mt19937::max()) - 0.5; };
	std::vector<Point> vectors(count);
	for (Point& v : vectors) {
		for (Eigen::Index k = 0; k < 3; ++k)
			v[k] = next();
	}
	return vectors;
}

std::vector<Index> counting(std::size_t count)
{
	std::vector<Index> rows(count);
	std::iota(rows.begin(), rows.end(), 0);
	return rows;
}

std::vector<Point> fitted(const std::vector<Point>& values, int order_x, int order_y)
{
	PolynomialFitOptions options;
	options.order_x = order_x;
	options.order_y = order_y;
	PolynomialFit fit(options);
	fit.fit(values, counting(values.size()));
	return fit.values();
}

// Orthonormal basis of the polynomials on uniform nodes, by QR of the powers.
Eigen::MatrixXd basis_by_qr(int size, int order)
{
	Eigen::MatrixXd powers(size, order + 1);
	for (int i = 0; i < size; ++i) {
		for (int k = 0; k <= order; ++k)
			powers(i, k) = std::pow(-1 + 2.0 * i / (size - 1), k);
	}
	return Eigen::HouseholderQR<Eigen::MatrixXd>(powers).householderQ() *
		   Eigen::MatrixXd::Identity(size, order + 1);
}

} // namespace

TEST_CASE("Near-square shapes leave out less than a column", "[polynomial_fit]")
{
	CHECK(near_square_shape(0).rows == 0);
	CHECK(near_square_shape(0).columns == 0);
	for (int count = 1; count <= 3000; ++count) {
		const MatrixShape shape = near_square_shape(count);
		const int left_out = count - shape.rows * shape.columns;
		INFO(count << " values in " << shape.rows << " x " << shape.columns);
		REQUIRE(shape.rows * shape.rows <= count);
		REQUIRE(left_out >= 0);
		REQUIRE(left_out < shape.rows);
		REQUIRE(shape.columns - shape.rows >= 0);
		REQUIRE(shape.columns - shape.rows <= 2);
	}
}

TEST_CASE("The fit is eq. 11 with dense matrices, a component at a time", "[polynomial_fit]")
{
	for (const int order_x : {0, 1, 2, 3}) {
		for (const int order_y : {0, 1, 2, 3}) {
			const std::vector<Point> values = random_vectors(59); // 7 x 8 and three left over
			const std::vector<Point> found = fitted(values, order_x, order_y);
			REQUIRE(found.size() == 56);
			const Eigen::MatrixXd B_x = basis_by_qr(8, order_x);
			const Eigen::MatrixXd B_y = basis_by_qr(7, order_y);
			double worst = 0;
			for (Eigen::Index component = 0; component < 3; ++component) {
				Eigen::MatrixXd R(7, 8);
				for (Eigen::Index p = 0; p < 56; ++p)
					R(p % 7, p / 7) = values[static_cast<std::size_t>(p)][component];
				const Eigen::MatrixXd Z = B_y * B_y.transpose() * R * B_x * B_x.transpose();
				for (Eigen::Index p = 0; p < 56; ++p)
					worst = std::max(
						worst,
						std::abs(Z(p % 7, p / 7) - found[static_cast<std::size_t>(p)][component]));
			}
			CHECK(worst < 1e-13);
		}
	}
}

TEST_CASE("A surface of the fit's own degrees is reproduced", "[polynomial_fit]")
{
	// 10 x 10, quadratic along the rows, linear along the columns.
	std::vector<Point> values;
	for (int column = 0; column < 10; ++column) {
		for (int row = 0; row < 10; ++row)
			values.emplace_back(
				1 + column * column - 3 * row, column * row, 2 - column * column * row);
	}
	CHECK(largest_distance(fitted(values, 2, 1), values) < 1e-11);
	CHECK(largest_distance(fitted(values, 1, 1), values) > 1);
	CHECK(largest_distance(fitted(values, 2, 0), values) > 1);
}

TEST_CASE("Order 0 is the mean, the highest orders interpolate", "[polynomial_fit]")
{
	const std::vector<Point> values = random_vectors(36);
	const Point mean = std::accumulate(values.begin(), values.end(), Point(Point::Zero())) / 36;
	CHECK(largest_distance(fitted(values, 0, 0), std::vector<Point>(36, mean)) < 1e-14);
	CHECK(largest_distance(fitted(values, 5, 5), values) < 1e-13);
	CHECK(largest_distance(fitted(values, 10, 10), values) < 1e-13);
}

TEST_CASE("Lists too short for the orders are fitted as well as they can be", "[polynomial_fit]")
{
	for (std::size_t count = 1; count <= 12; ++count) {
		const std::vector<Point> values = random_vectors(count);
		const std::vector<Point> found = fitted(values, 10, 10);
		const MatrixShape shape = near_square_shape(static_cast<int>(count));
		REQUIRE(found.size() == static_cast<std::size_t>(shape.rows * shape.columns));
		for (std::size_t i = 0; i < found.size(); ++i)
			CHECK((found[i] - values[i]).norm() < 1e-14);
	}
	CHECK(fitted({}, 2, 2).empty());
}

TEST_CASE("Fitting again changes nothing", "[polynomial_fit]")
{
	const std::vector<Point> once = fitted(random_vectors(100), 2, 1);
	CHECK(largest_distance(fitted(once, 2, 1), once) < 1e-13);
}

TEST_CASE("What was fitted before does not matter", "[polynomial_fit]")
{
	const std::vector<Point> normals = random_vectors(300);
	PolynomialFit fit({3, 2});
	fit.fit(normals, {5, 4, 3, 9, 9});
	const std::vector<Point> fresh = fit.values();
	fit.fit(normals, counting(300));
	fit.fit(normals, {});
	CHECK(fit.values().empty());
	fit.fit(normals, {5, 4, 3, 9, 9});
	CHECK(same_bits(fit.values(), fresh));
}

TEST_CASE("Every row of every fit is a vote", "[filter_normals]")
{
	// Large enough for the votes to be gathered in several parts.
	const StepFixture f(noisy(make_torus(10000), 0.2, NoiseDirection::Random));
	const std::vector<Point>& normals = f.geometry.normals;
	const std::vector<Point> guides = guide_directions(f.workspace, f.geometry, {});
	PolynomialFilterOptions options;
	options.fit = {2, 1};
	options.structures.cos_threshold = 0.8;
	const std::vector<Point> found = filter_normals(f.workspace, normals, guides, options);

	std::vector<Point> sums(normals.size(), Point::Zero());
	const IndexLists isotropic =
		isotropic_structures(f.workspace, normals, guides, options.structures);
	SimilarStructures structures(f.workspace, guides, isotropic, options.structures);
	PolynomialFit fit(options.fit);
	for (Index i = 0; i < f.mesh.face_count(); ++i) {
		structures.collect(i);
		fit.fit(normals, structures.faces());
		for (std::size_t row = 0; row < fit.values().size(); ++row)
			sums[static_cast<std::size_t>(structures.faces()[row])] += fit.values()[row];
	}
	CHECK(largest_distance(found, each(sums, [](const Point& sum) {
							   return sum.normalized();
						   })) < 1e-13);
}

TEST_CASE("Normals of a clean cube stay as they are", "[filter_normals]")
{
	const StepFixture f(make_cube(3000));
	const std::vector<Point> guides = guide_directions(f.workspace, f.geometry, {});
	CHECK(
		largest_distance(
			filter_normals(f.workspace, f.geometry.normals, guides, {}), f.geometry.normals) <
		1e-14);
}

TEST_CASE("Filtered normals of a noisy cube are nearer the truth", "[filter_normals]")
{
	const TriangleMesh cube = make_cube(3000);
	const FaceGeometry truth = face_geometry(cube.positions, cube.faces);
	const StepFixture f(noisy(cube, 0.2));
	const auto error = [&](const std::vector<Point>& normals) {
		double sum = 0;
		for (std::size_t i = 0; i < normals.size(); ++i)
			sum += (normals[i] - truth.normals[i]).squaredNorm();
		return sum;
	};
	const std::vector<Point> guides = guide_directions(f.workspace, f.geometry, {});
	const std::vector<Point> found = filter_normals(f.workspace, f.geometry.normals, guides, {});
	CHECK(error(found) < 0.15 * error(f.geometry.normals));
}

TEST_CASE(
	"Faces without a normal stay without, faces without votes keep theirs", "[filter_normals]")
{
	const StepFixture f(make_degenerate_face());
	const std::vector<Point> guides = guide_directions(f.workspace, f.geometry, {});
	const std::vector<Point> found = filter_normals(f.workspace, f.geometry.normals, guides, {});
	int without = 0;
	for (std::size_t i = 0; i < found.size(); ++i) {
		CHECK(found[i].isZero(0) == f.geometry.normals[i].isZero(0));
		without += found[i].isZero(0) ? 1 : 0;
	}
	CHECK(without == 2);

	// Guides that no normal is similar to: nobody votes.
	const StepFixture plane(noisy(make_flat_grid(5), 0.1));
	const std::vector<Point> sideways(plane.mesh.faces.size(), Point(1, 0, 0));
	CHECK(same_bits(
		filter_normals(plane.workspace, plane.geometry.normals, sideways, {}),
		plane.geometry.normals));
}

TEST_CASE("Normals are filtered the same on any number of threads", "[filter_normals][parallel]")
{
	const TriangleMesh mesh = noisy(make_torus(10000), 0.2);
	PolynomialFilterOptions options;
	options.fit = {2, 2};
	std::vector<Point> expected;
	for (const int threads : {1, 2, 4}) {
		const StepFixture f(mesh, threads);
		const std::vector<Point> guides = guide_directions(f.workspace, f.geometry, {});
		const std::vector<Point> found =
			filter_normals(f.workspace, f.geometry.normals, guides, options);
		if (threads == 1)
			expected = found;
		CHECK(same_bits(found, expected));
	}
}
