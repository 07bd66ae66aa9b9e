// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "lanes.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace orthopoly {

/// Number of terms of a polynomial of that total degree in two variables: 1, 3, 6, 10.
constexpr std::size_t term_count(std::size_t degree)
{
	return (degree + 1) * (degree + 2) / 2;
}

/// Powers of x and y in a term.
struct Exponents {
	std::size_t x;
	std::size_t y;
};

/// Those of all terms up to a total degree.
template<std::size_t Degree>
constexpr std::array<Exponents, term_count(Degree)> exponents()
{
	std::array<Exponents, term_count(Degree)> result = {};
	std::size_t term = 0;
	for (std::size_t degree = 0; degree <= Degree; ++degree) {
		for (std::size_t y = 0; y <= degree; ++y)
			result[term++] = {degree - y, y};
	}
	return result;
}

/// The number of the term with these exponents.
constexpr std::size_t term_of(const Exponents& exponents)
{
	const std::size_t degree = exponents.x + exponents.y;
	return term_count(degree) - degree - 1 + exponents.y;
}

/// The monomials up to a total degree at a point of the plane, times a factor; lowest degree first:
/// 1; x, y; x^2, xy, y^2; x^3, x^2 y, x y^2, y^3 and so on.
template<std::size_t Degree, class Scalar>
std::array<Scalar, term_count(Degree)>
monomials(const Scalar& x, const Scalar& y, const Scalar& factor = Scalar(1))
{
	constexpr std::array<Exponents, term_count(Degree)> EXPONENTS = exponents<Degree>();
	std::array<Scalar, term_count(Degree)> terms;
	terms[0] = factor;
#pragma GCC unroll 64
	for (std::size_t k = 1; k < terms.size(); ++k) {
		// The term before the last factor of x, or where there is none, of y.
		const std::size_t degree = EXPONENTS[k].x + EXPONENTS[k].y;
		terms[k] = EXPONENTS[k].x > 0 ? x * terms[k - degree] : y * terms[k - degree - 1];
	}
	return terms;
}

/// Sums over the nodes of a structure from which a fit follows; nodes may be added at any time.
/// @tparam Components number of values at a node.
/// @tparam Scalar     double, or lanes: as many structures side by side, or parts of one.
template<std::size_t Degree, std::size_t Components, class Scalar = double>
struct ScatteredMoments {
	static constexpr std::size_t TERMS = term_count(Degree);
	static constexpr std::size_t COMPONENTS = Components;
	/// A product of two monomials is one of twice the degree, and many products are the same one.
	static constexpr std::size_t POWERS = term_count(2 * Degree);

	std::array<Scalar, POWERS> powers;
	std::array<std::array<Scalar, COMPONENTS>, TERMS> values;
	Scalar energy = Scalar(0);
	/// Number of nodes.
	Scalar count = Scalar(0);

	ScatteredMoments()
	{
		powers.fill(Scalar(0));
		for (auto& value : values)
			value.fill(Scalar(0));
	}

	/// Sum of the weights.
	const Scalar& weight() const { return powers[0]; }

	/// A node of weight zero adds nothing but one to the count.
	void
	add(const Scalar& x,
		const Scalar& y,
		const std::array<Scalar, COMPONENTS>& value,
		const Scalar& node_weight)
	{
		const std::array<Scalar, POWERS> terms = monomials<2 * Degree>(x, y, node_weight);
#pragma GCC unroll 64
		for (std::size_t k = 0; k < POWERS; ++k)
			powers[k] += terms[k];
#pragma GCC unroll 16
		for (std::size_t k = 0; k < TERMS; ++k) {
#pragma GCC unroll 4
			for (std::size_t c = 0; c < COMPONENTS; ++c)
				values[k][c] += terms[k] * value[c];
		}
		Scalar squares = value[0] * value[0];
		for (std::size_t c = 1; c < COMPONENTS; ++c)
			squares += value[c] * value[c];
		energy += node_weight * squares;
		count += Scalar(1);
	}
};

/// The moments of as many structures, side by side.
template<class Lanes, std::size_t Degree, std::size_t Components>
ScatteredMoments<Degree, Components, Lanes>
side_by_side(const std::array<ScatteredMoments<Degree, Components>, LANES>& moments)
{
	const auto gather = [&](auto value_of) {
		return Lanes(
			{value_of(moments[0]),
			 value_of(moments[1]),
			 value_of(moments[2]),
			 value_of(moments[3])});
	};
	ScatteredMoments<Degree, Components, Lanes> result;
	for (std::size_t k = 0; k < result.powers.size(); ++k)
		result.powers[k] = gather([k](const auto& m) { return m.powers[k]; });
	for (std::size_t k = 0; k < result.values.size(); ++k) {
		for (std::size_t c = 0; c < Components; ++c)
			result.values[k][c] = gather([k, c](const auto& m) { return m.values[k][c]; });
	}
	result.energy = gather([](const auto& m) { return m.energy; });
	result.count = gather([](const auto& m) { return m.count; });
	return result;
}

/// Adds up the lanes of the moments of one structure; the count is the caller's to give, since
/// lanes that were filled up with nodes of no weight would count them.
template<class Lanes, std::size_t Degree, std::size_t Components>
void add_up(
	const ScatteredMoments<Degree, Components, Lanes>& lanes,
	double count,
	ScatteredMoments<Degree, Components>& sums)
{
	for (std::size_t k = 0; k < sums.powers.size(); ++k)
		sums.powers[k] = sum_of_lanes(lanes.powers[k]);
	for (std::size_t k = 0; k < sums.values.size(); ++k) {
		for (std::size_t c = 0; c < Components; ++c)
			sums.values[k][c] = sum_of_lanes(lanes.values[k][c]);
	}
	sums.energy = sum_of_lanes(lanes.energy);
	sums.count = count;
}

/// Discrete orthogonal polynomials on scattered nodes, and a least-squares fit by them.
///
/// The polynomials are orthonormal over the very nodes (with their weights, scaled to a mean of
/// one): Gram-Schmidt of the monomials in their order, by the Cholesky factor L of the Gram matrix.
/// So the coefficients do not interfere: each is what it is whether or not the others are kept.
///
/// With lanes, as many structures are fitted at once; those without a node with a weight come out
/// without terms.
template<std::size_t Degree, std::size_t Components, class Scalar = double>
class ScatteredFit {
public:
	using Moments = ScatteredMoments<Degree, Components, Scalar>;
	static constexpr std::size_t TERMS = Moments::TERMS;
	static constexpr std::size_t COMPONENTS = Moments::COMPONENTS;
	using Terms = std::array<double, TERMS>;
	using Coefficients = std::array<std::array<double, COMPONENTS>, TERMS>;

	explicit ScatteredFit(const Moments& moments)
	{
		const Scalar has_weight = moments.weight();
		const Scalar scale = where_positive(
			has_weight,
			moments.count / where_positive(has_weight, has_weight, Scalar(1)),
			Scalar(0));
		factorise(moments, scale);
		total_ = moments.energy * scale;
		for (std::size_t k = 0; k < TERMS; ++k) {
			for (std::size_t c = 0; c < COMPONENTS; ++c) {
				Scalar value = moments.values[k][c] * scale;
				for (std::size_t j = 0; j < k; ++j)
					value -= lower_[k][j] * coefficients_[j][c];
				coefficients_[k][c] = value * inverse_[k];
			}
			energies_[k] = coefficients_[k][0] * coefficients_[k][0];
			for (std::size_t c = 1; c < COMPONENTS; ++c)
				energies_[k] += coefficients_[k][c] * coefficients_[k][c];
		}
	}

	/// Number of terms of the highest degree, not above the one given, that the nodes fix.
	std::size_t terms(std::size_t degree, std::size_t lane = 0) const
	{
		std::size_t fixed = 0;
		for (std::size_t tried = 0; tried <= degree; ++tried) {
			const std::size_t end = term_count(tried);
			for (std::size_t k = fixed; k < end; ++k) {
				if (!(lane_of(inverse_[k], lane) > 0))
					return fixed;
			}
			fixed = end;
		}
		return fixed;
	}

	/// Coefficient of an orthonormal polynomial.
	double coefficient(std::size_t term, std::size_t component, std::size_t lane = 0) const
	{
		return lane_of(coefficients_[term][component], lane);
	}
	/// Sum of squares a polynomial's coefficients stand for.
	double energy(std::size_t term, std::size_t lane = 0) const
	{
		return lane_of(energies_[term], lane);
	}
	/// Sum of squares that the first terms together leave over.
	double residual(std::size_t terms, std::size_t lane = 0) const
	{
		double rest = lane_of(total_, lane);
		for (std::size_t k = 0; k < terms; ++k)
			rest -= energy(k, lane);
		return rest > 0 ? rest : 0;
	}

	/// Coefficients of the monomials, of those orthonormal polynomials whose bit is set; none at
	/// or beyond `terms` may be.
	Coefficients polynomial(std::uint32_t kept, std::size_t terms, std::size_t lane = 0) const
	{
		Coefficients result = {};
		for (std::size_t k = terms; k-- > 0;) {
			const double inverse = lane_of(inverse_[k], lane);
			for (std::size_t c = 0; c < COMPONENTS; ++c) {
				double value = (kept >> k & 1U) != 0 ? coefficient(k, c, lane) : 0.0;
				for (std::size_t j = k + 1; j < terms; ++j)
					value -= lane_of(lower_[j][k], lane) * result[j][c];
				result[k][c] = value * inverse;
			}
		}
		return result;
	}

	/// Values of the orthonormal polynomials, from those of the monomials (or of a derivative of
	/// both).
	std::array<Scalar, TERMS> orthonormal(const Terms& monomial_values) const
	{
		std::array<Scalar, TERMS> result;
		for (std::size_t k = 0; k < TERMS; ++k) {
			Scalar value = Scalar(monomial_values[k]);
			for (std::size_t j = 0; j < k; ++j)
				value -= lower_[k][j] * result[j];
			result[k] = value * inverse_[k];
		}
		return result;
	}

private:
	// A pivot below this part of its diagonal is rounding: the nodes lie on a curve of that degree.
	static constexpr double LEAST_PIVOT = 1e-9;

	// The Cholesky factor, row by row. Where the nodes do not fix a term, the inverse of its pivot
	// is zero.
	void factorise(const Moments& moments, const Scalar& scale)
	{
		constexpr std::array<Exponents, TERMS> EXPONENTS = exponents<Degree>();
#pragma GCC unroll 16
		for (std::size_t row = 0; row < TERMS; ++row) {
			const auto gram = [&](std::size_t column) {
				return moments.powers[term_of(
					{EXPONENTS[row].x + EXPONENTS[column].x,
					 EXPONENTS[row].y + EXPONENTS[column].y})];
			};
#pragma GCC unroll 16
			for (std::size_t column = 0; column < row; ++column) {
				Scalar value = gram(column) * scale;
#pragma GCC unroll 16
				for (std::size_t j = 0; j < column; ++j)
					value -= lower_[row][j] * lower_[column][j];
				lower_[row][column] = value * inverse_[column];
			}
			const Scalar diagonal = gram(row) * scale;
			Scalar pivot = diagonal;
#pragma GCC unroll 16
			for (std::size_t j = 0; j < row; ++j)
				pivot -= lower_[row][j] * lower_[row][j];
			const Scalar excess = pivot - Scalar(LEAST_PIVOT) * diagonal;
			inverse_[row] = where_positive(
				excess,
				Scalar(1) / square_root(where_positive(excess, pivot, Scalar(1))),
				Scalar(0));
		}
	}

	/// Of the Cholesky factor, below the diagonal.
	std::array<std::array<Scalar, TERMS>, TERMS> lower_;
	/// Of its diagonal.
	std::array<Scalar, TERMS> inverse_;
	std::array<std::array<Scalar, COMPONENTS>, TERMS> coefficients_;
	std::array<Scalar, TERMS> energies_;
	/// Sum of squares of all values.
	Scalar total_;
};

} // namespace orthopoly
