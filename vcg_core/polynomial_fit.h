// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "orthogonal_polynomials.h"
#include "similar_structures.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Options of `PolynomialFit`.
///
/// The defaults are measured on the four models of Table 2 (r = 1, R = 2, five noises each): from
/// order 0 to order 2 along the rows E_v falls by 7 % on the Fandisk, 8 % on CAD, 16 % on the
/// Octaflower, and rises by 5 % on the cube. Orders across the columns change E_v by 2 % at most,
/// but MSAE of the Fandisk and CAD rises by a tenth: more folded faces stay.
struct PolynomialFitOptions {
	/// Order a along the rows of the matrix of eq. 11, 0 or more: from structure to structure, the
	/// most similar first. 0 fits the mean; more follows the normals, and their noise, more
	/// closely.
	int order_x = 2;
	/// Order b along its columns, 0 or more: within a structure or a few of them.
	int order_y = 0;
};

/// Size of a matrix.
struct MatrixShape {
	int rows = 0;
	int columns = 0;
};

/// The near-square matrix that `count` values are reshaped into: floor(sqrt(count)) rows and as
/// many full columns as there are values for. The last values, fewer than a column, are left out:
/// they are the least similar ones, and filling up the column by reflection instead made E_v 1 to
/// 2 % larger on all four models of Table 2.
MatrixShape near_square_shape(int count);

/// Fits orthogonal polynomials to lists of normals (eq. 11), one list after the other.
///
/// Keeps scratch memory, so use one object per thread.
class PolynomialFit {
public:
	explicit PolynomialFit(const PolynomialFitOptions& options);

	/// Reshapes each component of the normals of these faces, column by column, into a near-square
	/// matrix of its own, and projects it on the polynomials: Z = B_y B_y^T R B_x B_x^T. Orders too
	/// high for the matrix interpolate. O(#rows (order_y + 1)).
	///
	/// @param normals #F
	/// @param rows    the faces whose normals are the rows of the matrix M
	void fit(const std::vector<Point>& normals, const std::vector<Index>& rows);

	/// The fitted normals, not normalised, in the order of the rows: one for every row that found
	/// its place in the matrix.
	const std::vector<Point>& values() const { return values_; }

private:
	PolynomialTable bases_x_;
	PolynomialTable bases_y_;
	std::vector<Point> values_;
	/// The (a + 1) x (b + 1) coefficients B_y^T R B_x, those of one degree in x after the other.
	std::vector<Point> coefficients_;
	/// Coefficients in y of one column.
	std::vector<Point> column_;
};

/// Options of `filter_normals`.
struct PolynomialFilterOptions {
	SimilarStructureOptions structures;
	PolynomialFitOptions fit;
};

/// Filters normals by orthogonal polynomials over non-local similar structures (sections 2.2
/// to 3.2): every row of every fit is a vote for its face, repeated ones count as often, and a face
/// takes the direction of the mean of its votes.
///
/// @param normals #F unit normals
/// @param guides  #F guide directions
/// @return #F unit normals. A face without a normal stays without; one without votes keeps its own.
/// Throws Cancelled.
std::vector<Point> filter_normals(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const std::vector<Point>& guides,
	const PolynomialFilterOptions& options);

} // namespace orthopoly
