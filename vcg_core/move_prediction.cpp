// SPDX-License-Identifier: GPL-3.0-or-later
#include "move_prediction.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>

namespace orthopoly {

namespace {

// Rings of vertices that a prediction is fitted over: some sixty, fifteen a coefficient, and still
// near enough for ridges to keep their direction.
constexpr int RINGS = 4;

// Part of its trace added to the diagonal of the normal equations: where neighbours lie in two
// directions only, these do not tell all coefficients.
constexpr double RIDGE_REGRESSION = 1e-9;

constexpr int TERMS = 4;
using Terms = Eigen::Matrix<double, TERMS, 1>;
using Gram = Eigen::Matrix<double, TERMS, TERMS>;

// A product of two directions that a symmetric matrix stored as DirectedMoves is multiplied by.
MovePredictor::DirectedMoves product(const Point& a, const Point& b)
{
	MovePredictor::DirectedMoves result;
	result << a.x() * b.x(), a.y() * b.y(), a.z() * b.z(), a.x() * b.y() + a.y() * b.x(),
		a.y() * b.z() + a.z() * b.y(), a.z() * b.x() + a.x() * b.z();
	return result;
}

} // namespace

std::vector<MovePredictor::DirectedMoves> MovePredictor::directed_moves(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<double>& lengths)
{
	std::vector<DirectedMoves> result(positions.size(), DirectedMoves::Zero());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const auto vertex = static_cast<Index>(i);
		const Index* const end = workspace.vertex_faces.end(vertex);
		for (const Index* it = workspace.vertex_faces.begin(vertex); it != end; ++it) {
			for (const Index corner : workspace.mesh.faces[at(*it)]) {
				const Point way = positions[at(corner)] - positions[i];
				const double square = way.squaredNorm();
				if (!(square > 0))
					continue;
				DirectedMoves directions;
				directions << way.cwiseAbs2(), way.x() * way.y(), way.y() * way.z(),
					way.z() * way.x();
				result[i] += lengths[at(corner)] / square * directions;
			}
		}
		result[i] /= std::max<double>(1, workspace.vertex_faces.size(vertex));
	});
	return result;
}

PredictedMove MovePredictor::predict(Index vertex)
{
	rings_.collect(vertex, RINGS);
	const auto count = static_cast<double>(rings_.vertices().size());
	const Point& cross = moves_.crosses[at(vertex)];
	if (cross.isZero(0) || !(count > TERMS))
		return {};
	const Point tangent = cross.normalized().unitOrthogonal();
	const Point bitangent = cross.normalized().cross(tangent);
	const DirectedMoves along = product(tangent, tangent);
	const DirectedMoves across = product(bitangent, bitangent);
	const DirectedMoves between = product(tangent, bitangent);
	const auto terms_of = [&](Index i) {
		const DirectedMoves& directed = directed_[at(i)];
		const double x = along.dot(directed);
		const double y = across.dot(directed);
		return Terms(x + y, x - y, between.dot(directed), 1);
	};
	Gram gram = Gram::Zero();
	Terms sums = Terms::Zero();
	double squares = 0;
	for (const Index i : rings_.vertices()) {
		const Terms terms = terms_of(i);
		const double length = moves_.lengths[at(i)];
		gram += terms * terms.transpose();
		sums += length * terms;
		squares += length * length;
	}
	const double variance = (squares - sums[3] * sums[3] / count) / (count - 1);
	if (!(variance > 0))
		return {};
	// The variance that is left by a straight line of negative slope through plain sums and moves.
	const double common = std::min(0.0, sums[0] - gram(0, 3) * sums[3] / count);
	const double spread = gram(0, 0) - gram(0, 3) * gram(0, 3) / count;
	const double alternating = spread > 0 ? common * common / spread / (count - 2) : 0;
	gram.diagonal().array() += RIDGE_REGRESSION * gram.trace();
	const Terms coefficients = gram.ldlt().solve(sums);
	const double left = std::max(0.0, squares - coefficients.dot(sums)) / (count - TERMS);
	return {
		coefficients.dot(terms_of(vertex)),
		1 - left / variance,
		1 - left / (variance - alternating),
		squares / count};
}

} // namespace orthopoly
