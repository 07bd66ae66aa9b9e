// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>
#include <vector>

namespace orthopoly {

/// Discrete orthonormal polynomials on `size` uniform nodes of [-1, 1] (Gram polynomials).
///
/// Legendre polynomials sampled at uniform nodes are not orthogonal as vectors; these are, by their
/// three-term recurrence with re-orthogonalisation (O'Leary and Harker 2010), and tend to the
/// Legendre polynomials as the nodes grow dense. O(size order^2).
///
/// @param size  number of nodes, 1 or more
/// @param order highest degree, 0 or more; `size` nodes carry degrees up to size - 1 only
/// @return size x (min(order, size - 1) + 1) matrix B with B^T B = I; column k has degree k and is
///         positive at the last node
/// Throws InvalidParameter where size or order is too small.
Eigen::MatrixXd orthonormal_polynomials(int size, int order);

/// Orthonormal polynomials of one order for all sizes asked for so far. Use one object per thread.
class PolynomialTable {
public:
	explicit PolynomialTable(int order) : order_(order) {}

	/// `orthonormal_polynomials(size, order)`, computed by the first call with that size. The
	/// reference is good until the next call.
	const Eigen::MatrixXd& basis(int size);

private:
	int order_;
	std::vector<Eigen::MatrixXd> bases_;
};

} // namespace orthopoly
