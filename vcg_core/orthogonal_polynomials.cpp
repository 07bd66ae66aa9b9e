// SPDX-License-Identifier: GPL-3.0-or-later
#include "orthogonal_polynomials.h"

#include "errors.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace orthopoly {

Eigen::MatrixXd orthonormal_polynomials(int size, int order)
{
	if (size < 1 || order < 0)
		throw InvalidParameter(
			"there are no polynomials of order " + std::to_string(order) + " on " +
			std::to_string(size) + " nodes; give an order of 0 or more and 1 node or more");
	const int degrees = std::min(order, size - 1) + 1;

	Eigen::MatrixXd basis(size, degrees);
	basis.col(0).setConstant(1.0 / std::sqrt(static_cast<double>(size)));
	if (degrees == 1)
		return basis;
	const Eigen::VectorXd x = Eigen::VectorXd::LinSpaced(size, -1.0, 1.0);
	for (int k = 1; k < degrees; ++k) {
		// In exact arithmetic only the two last columns would be subtracted, which is the
		// three-term recurrence. All of them, twice, take out what rounding leaves of the lower
		// degrees.
		Eigen::VectorXd next = x.cwiseProduct(basis.col(k - 1));
		for (int pass = 0; pass < 2; ++pass) {
			const Eigen::VectorXd lower = basis.leftCols(k).transpose() * next;
			next -= basis.leftCols(k) * lower;
		}
		basis.col(k) = next / next.norm();
	}
	return basis;
}

const Eigen::MatrixXd& PolynomialTable::basis(int size)
{
	const auto place = static_cast<std::size_t>(size);
	if (bases_.size() <= place)
		bases_.resize(place + 1);
	if (bases_[place].size() == 0)
		bases_[place] = orthonormal_polynomials(size, order_);
	return bases_[place];
}

} // namespace orthopoly
