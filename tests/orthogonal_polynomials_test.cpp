// SPDX-License-Identifier: GPL-3.0-or-later
#include "orthogonal_polynomials.h"

#include "errors.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

double legendre(int degree, double x)
{
	double before = 1;
	double value = x;
	if (degree == 0)
		return before;
	for (int n = 1; n < degree; ++n) {
		const double next = ((2 * n + 1) * x * value - n * before) / (n + 1); // eq. 9
		before = value;
		value = next;
	}
	return value;
}

// Largest difference to the orthonormal Legendre polynomials sampled at the nodes.
double distance_to_legendre(int size, int degree)
{
	const Eigen::MatrixXd basis = orthonormal_polynomials(size, degree);
	double largest = 0;
	for (int i = 0; i < size; ++i) {
		const double x = -1 + 2.0 * i / (size - 1);
		const double expected = std::sqrt((2 * degree + 1) / 2.0) * legendre(degree, x);
		largest = std::max(largest, std::abs(std::sqrt(size / 2.0) * basis(i, degree) - expected));
	}
	return largest;
}

} // namespace

TEST_CASE("Discrete polynomials are orthonormal on their nodes", "[orthogonal_polynomials]")
{
	double worst = 0;
	for (int size = 1; size <= 200; ++size) {
		for (int order = 0; order <= 10; ++order) {
			const Eigen::MatrixXd basis = orthonormal_polynomials(size, order);
			REQUIRE(basis.rows() == size);
			REQUIRE(basis.cols() == std::min(order, size - 1) + 1);
			const Eigen::MatrixXd gram = basis.transpose() * basis;
			worst = std::max(
				worst,
				(gram - Eigen::MatrixXd::Identity(gram.rows(), gram.cols())).cwiseAbs().maxCoeff());
		}
	}
	CHECK(worst < 1e-12);
}

TEST_CASE("A polynomial up to the order is reproduced", "[orthogonal_polynomials]")
{
	double worst = 0;
	for (const int size : {1, 2, 3, 7, 11, 12, 50, 200}) {
		for (int order = 0; order <= 10; ++order) {
			const Eigen::MatrixXd basis = orthonormal_polynomials(size, order);
			for (int power = 0; power <= order; ++power) {
				Eigen::VectorXd values(size);
				for (int i = 0; i < size; ++i)
					values(i) = std::pow(size > 1 ? -1 + 2.0 * i / (size - 1) : 1.0, power);
				const Eigen::VectorXd fitted = basis * (basis.transpose() * values);
				worst = std::max(worst, (fitted - values).cwiseAbs().maxCoeff());
			}
		}
	}
	CHECK(worst < 1e-12);
}

TEST_CASE("A polynomial above the order is not reproduced", "[orthogonal_polynomials]")
{
	const Eigen::MatrixXd basis = orthonormal_polynomials(20, 2);
	const Eigen::VectorXd cubic = Eigen::VectorXd::LinSpaced(20, -1, 1).array().cube();
	const Eigen::VectorXd residual = cubic - basis * (basis.transpose() * cubic);
	CHECK(residual.norm() > 0.1);
	CHECK((basis.transpose() * residual).norm() < 1e-14);
}

TEST_CASE("Column k has degree k and is positive at the last node", "[orthogonal_polynomials]")
{
	const Eigen::MatrixXd basis = orthonormal_polynomials(30, 10);
	for (int k = 0; k <= 10; ++k) {
		CHECK(basis(29, k) > 0);
		// Even degrees are even functions, odd ones odd.
		const double sign = k % 2 == 0 ? 1 : -1;
		CHECK((basis.col(k).reverse() - sign * basis.col(k)).norm() < 1e-12);
		int sign_changes = 0;
		for (int i = 1; i < 30; ++i)
			sign_changes += basis(i - 1, k) * basis(i, k) < 0 ? 1 : 0;
		CHECK(sign_changes == k);
	}
}

TEST_CASE("Dense nodes lead to the Legendre polynomials", "[orthogonal_polynomials]")
{
	for (int degree = 0; degree <= 6; ++degree) {
		INFO("degree " << degree);
		const double coarse = distance_to_legendre(1000, degree);
		const double fine = distance_to_legendre(10000, degree);
		CHECK(fine < 1e-2);
		// The distance falls with the spacing of the nodes.
		CHECK(fine <= 0.11 * coarse + 1e-12);
	}
}

TEST_CASE("Sampled Legendre polynomials would not be orthogonal", "[orthogonal_polynomials]")
{
	// The reason for the discrete ones: 1 and x^2 - 1/3 on seven nodes.
	double product = 0;
	for (int i = 0; i < 7; ++i)
		product += legendre(2, -1 + 2.0 * i / 6);
	CHECK(std::abs(product) > 0.5);
	CHECK(
		std::abs(orthonormal_polynomials(7, 2).col(0).dot(orthonormal_polynomials(7, 2).col(2))) <
		1e-15);
}

TEST_CASE("An order as high as the number of nodes interpolates", "[orthogonal_polynomials]")
{
	const Eigen::VectorXd values = (Eigen::VectorXd(5) << 3, -1, 4, 1, -5).finished();
	for (const int order : {4, 5, 10}) {
		const Eigen::MatrixXd basis = orthonormal_polynomials(5, order);
		REQUIRE(basis.cols() == 5);
		CHECK((basis * (basis.transpose() * values) - values).norm() < 1e-14);
	}
}

TEST_CASE("Sizes and orders that make no sense are refused", "[orthogonal_polynomials]")
{
	CHECK_THROWS_AS(orthonormal_polynomials(0, 2), InvalidParameter);
	CHECK_THROWS_AS(orthonormal_polynomials(-3, 2), InvalidParameter);
	CHECK_THROWS_AS(orthonormal_polynomials(3, -1), InvalidParameter);
}

TEST_CASE("The table hands out the same polynomials", "[orthogonal_polynomials]")
{
	PolynomialTable table(3);
	for (const int size : {9, 2, 40, 9, 1, 41})
		CHECK(table.basis(size) == orthonormal_polynomials(size, 3));
}
