// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace orthopoly {

/// Number of terms of a polynomial of that total degree in two variables: 1, 3, 6, 10.
constexpr int term_count(int degree)
{
	return (degree + 1) * (degree + 2) / 2;
}

/// The monomials up to a total degree at a point of the plane, lowest degree first:
/// 1; x, y; x^2, xy, y^2; x^3, x^2 y, x y^2, y^3.
template<int Degree>
std::array<double, term_count(Degree)> monomials(double x, double y)
{
	static_assert(Degree == 2 || Degree == 3, "only these two are in use");
	if constexpr (Degree == 2)
		return {1, x, y, x * x, x * y, y * y};
	else
		return {1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y};
}

/// Sums over the nodes of a structure from which a fit follows; nodes may be added at any time.
/// @tparam Components number of values at a node.
template<int Degree, int Components>
struct ScatteredMoments {
	static constexpr std::size_t TERMS = term_count(Degree);
	static constexpr std::size_t COMPONENTS = Components;

	/// Lower triangle, row by row.
	std::array<double, TERMS*(TERMS + 1) / 2> gram = {};
	std::array<std::array<double, COMPONENTS>, TERMS> values = {};
	double energy = 0;
	double weight = 0;
	int count = 0;

	void add(double x, double y, const std::array<double, COMPONENTS>& value, double node_weight)
	{
		const std::array<double, TERMS> terms = monomials<Degree>(x, y);
		double* sum = gram.data();
		for (std::size_t row = 0; row < TERMS; ++row) {
			const double weighted = node_weight * terms[row];
			for (std::size_t column = 0; column <= row; ++column)
				*sum++ += weighted * terms[column];
			for (std::size_t c = 0; c < COMPONENTS; ++c)
				values[row][c] += weighted * value[c];
		}
		for (std::size_t c = 0; c < COMPONENTS; ++c)
			energy += node_weight * value[c] * value[c];
		weight += node_weight;
		++count;
	}
};

/// Discrete orthogonal polynomials on scattered nodes, and a least-squares fit by them.
///
/// The polynomials are orthonormal over the very nodes (with their weights, scaled to a mean of
/// one): Gram-Schmidt of the monomials in their order, by the Cholesky factor L of the Gram matrix.
/// So the coefficients do not interfere: each is what it is whether or not the others are kept.
template<int Degree, int Components>
class ScatteredFit {
public:
	using Moments = ScatteredMoments<Degree, Components>;
	static constexpr std::size_t TERMS = Moments::TERMS;
	static constexpr std::size_t COMPONENTS = Moments::COMPONENTS;
	using Terms = std::array<double, TERMS>;
	using Coefficients = std::array<std::array<double, COMPONENTS>, TERMS>;

	/// Fits a polynomial of at most that degree; of a lower one where the nodes do not fix it.
	/// There has to be a node with a weight.
	ScatteredFit(const Moments& moments, int degree)
	{
		const double scale = static_cast<double>(moments.count) / moments.weight;
		for (int tried = 0; tried <= degree; ++tried) {
			if (!factorise(moments, scale, tried))
				break;
			terms_ = static_cast<std::size_t>(term_count(tried));
		}
		double rest = moments.energy * scale;
		for (std::size_t k = 0; k < terms_; ++k) {
			for (std::size_t c = 0; c < COMPONENTS; ++c) {
				double value = moments.values[k][c] * scale;
				for (std::size_t j = 0; j < k; ++j)
					value -= lower_[k][j] * coefficients_[j][c];
				coefficients_[k][c] = value / lower_[k][k];
			}
			rest -= energy(k);
		}
		residual_ = rest > 0 ? rest : 0;
	}

	/// Number of terms of the degree that was fitted.
	std::size_t terms() const { return terms_; }
	/// Coefficients of the orthonormal polynomials.
	const Coefficients& coefficients() const { return coefficients_; }
	/// Sum of squares a polynomial's coefficients stand for.
	double energy(std::size_t term) const
	{
		double sum = 0;
		for (std::size_t c = 0; c < COMPONENTS; ++c)
			sum += coefficients_[term][c] * coefficients_[term][c];
		return sum;
	}
	/// Sum of squares that all terms together leave over.
	double residual() const { return residual_; }

	/// Coefficients of the monomials, of the orthonormal polynomials whose bit is set.
	Coefficients polynomial(std::uint32_t kept) const
	{
		Coefficients result = {};
		for (std::size_t k = terms_; k-- > 0;) {
			for (std::size_t c = 0; c < COMPONENTS; ++c) {
				double value = (kept >> k & 1U) != 0 ? coefficients_[k][c] : 0.0;
				for (std::size_t j = k + 1; j < terms_; ++j)
					value -= lower_[j][k] * result[j][c];
				result[k][c] = value / lower_[k][k];
			}
		}
		return result;
	}

	/// Values of the orthonormal polynomials, from those of the monomials (or of a derivative of
	/// both).
	Terms orthonormal(const Terms& monomial_values) const
	{
		Terms result = {};
		for (std::size_t k = 0; k < terms_; ++k) {
			double value = monomial_values[k];
			for (std::size_t j = 0; j < k; ++j)
				value -= lower_[k][j] * result[j];
			result[k] = value / lower_[k][k];
		}
		return result;
	}

private:
	// A pivot below this part of its diagonal is rounding: the nodes lie on a curve of that degree.
	static constexpr double LEAST_PIVOT = 1e-9;

	// The rows of the Cholesky factor that belong to a degree. False where the nodes do not fix it.
	bool factorise(const Moments& moments, double scale, int degree)
	{
		const auto end = static_cast<std::size_t>(term_count(degree));
		for (auto row = static_cast<std::size_t>(term_count(degree - 1)); row < end; ++row) {
			const double* gram = moments.gram.data() + row * (row + 1) / 2;
			for (std::size_t column = 0; column < row; ++column) {
				double value = gram[column] * scale;
				for (std::size_t j = 0; j < column; ++j)
					value -= lower_[row][j] * lower_[column][j];
				lower_[row][column] = value / lower_[column][column];
			}
			double pivot = gram[row] * scale;
			for (std::size_t j = 0; j < row; ++j)
				pivot -= lower_[row][j] * lower_[row][j];
			if (!(pivot > LEAST_PIVOT * gram[row] * scale))
				return false;
			lower_[row][row] = std::sqrt(pivot);
		}
		return true;
	}

	std::array<std::array<double, TERMS>, TERMS> lower_;
	Coefficients coefficients_ = {};
	std::size_t terms_ = 0;
	double residual_ = 0;
};

} // namespace orthopoly
