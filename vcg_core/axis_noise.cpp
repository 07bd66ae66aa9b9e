// SPDX-License-Identifier: GPL-3.0-or-later
#include "axis_noise.h"

#include "interpolation.h"
#include "noise_level.h"
#include "sampling.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace orthopoly {

namespace {

// Vertices from which there are enough on each side.
constexpr std::size_t FEWEST_VERTICES = 700;

// The quantile of the variances that the form is fitted to: low, since features add to them, but
// not so low that it is told by few.
constexpr double SHARE = 0.35;

// Rounds of the regression, and the part of the median of the variances that counts as no residual.
constexpr int ROUNDS = 30;
constexpr double LEAST_RESIDUAL = 0.02;

// Holds the form to the same in all directions where few normals tell it, as on a cube.
constexpr double EVEN_WEIGHT = 0.005;

// Squared cosines to the axis up to which the surface counts as seen edge on, and from which as
// seen face on.
constexpr double EDGE_ON = 0.1;
constexpr double FACE_ON = 0.6;

// Shares of the vertices that each of both has to have, for nothing and for all.
constexpr double FEW = 0.07;
constexpr double ENOUGH = 0.1;

// How many times the level edge on is the one face on, for nothing and for all: detail makes it
// up to 1.5 on clean meshes, or more where it is other than the following asks.
constexpr double EVEN = 1.55;
constexpr double UNEVEN = 1.8;

// What there is more face on has to be noise, the same over three and four rings as over two,
// but for what curvature adds: growth of the square, for all and for nothing. Less than the same
// tells that detail hides it.
constexpr std::array<double, 2> NOISE_GROWS = {1.35, 1.55};
constexpr std::array<double, 2> DETAIL_GROWS = {1.5, 1.75};
constexpr double SHRINKS = 0.55;
constexpr double STAYS = 0.7;

// Between both it has to be what the form says, to within these factors, for nothing and for all.
constexpr double TOO_LOW = 0.65;
constexpr double LOW_ENOUGH = 0.72;
constexpr double HIGH_ENOUGH = 1.3;
constexpr double TOO_HIGH = 1.45;
constexpr double FEWEST_BETWEEN = 0.1;

// A symmetric form by its six terms, such that the product of two is the forms' own.
using Terms = Eigen::Matrix<double, 6, 1>;
using Gram = Eigen::Matrix<double, 6, 6>;

Terms terms_of(const Point& n)
{
	const double root = std::sqrt(2.0);
	Terms terms;
	terms << n.x() * n.x(), n.y() * n.y(), n.z() * n.z(), root * n.x() * n.y(),
		root * n.x() * n.z(), root * n.y() * n.z();
	return terms;
}

// The direction in which the variances are highest; zero where none tells.
Point longest_axis(const std::vector<Point>& normals, const NoiseSample& sample)
{
	std::vector<Terms> terms;
	std::vector<double> values;
	for (std::size_t i = 0; i < sample.vertices.size(); ++i) {
		const Point& normal = normals[at(sample.vertices[i])];
		const double variance = sample.whole[0][i].value;
		if (variance < 0 || normal.isZero(0))
			continue;
		terms.push_back(terms_of(normal));
		values.push_back(variance);
	}
	std::vector<double> sorted = values;
	const double median = quantile(sorted, 0.5);
	if (!(median > 0))
		return Point::Zero();
	Terms even = Terms::Zero();
	even.head<3>().setConstant(1);
	const Gram uneven = Gram::Identity() - even * even.transpose() / 3;
	Terms form = Terms::Zero();
	for (int round = 0; round < ROUNDS; ++round) {
		Gram gram = Gram::Zero();
		Terms moments = Terms::Zero();
		double weights = 0;
		for (std::size_t i = 0; i < values.size(); ++i) {
			const double value = values[i] / median;
			const double residual = value - terms[i].dot(form);
			const double side = residual > 0 ? SHARE : 1 - SHARE;
			const double weight =
				round == 0 ? 1 : side / std::max(LEAST_RESIDUAL, std::abs(residual));
			gram.selfadjointView<Eigen::Lower>().rankUpdate(terms[i], weight);
			moments += weight * value * terms[i];
			weights += weight;
		}
		gram = gram.selfadjointView<Eigen::Lower>();
		form = (gram + EVEN_WEIGHT * weights * uneven).ldlt().solve(moments);
	}
	const double half = std::sqrt(0.5);
	Eigen::Matrix3d matrix;
	matrix << form[0], half * form[3], half * form[4], half * form[3], form[1], half * form[5],
		half * form[4], half * form[5], form[2];
	const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(matrix);
	return solver.info() == Eigen::Success ? Point(solver.eigenvectors().col(2)) : Point::Zero();
}

/// The vertices whose normals are at certain angles to the axis.
struct Group {
	std::vector<Index> vertices;
	VariancesByRings variances;
	double square_cosines = 0;

	void add(std::size_t i, double square_cosine, const NoiseSample& sample)
	{
		vertices.push_back(sample.vertices[i]);
		square_cosines += square_cosine;
		for (std::size_t k = 0; k < variances.size(); ++k)
			variances[k].push_back(sample.whole[k][i]);
	}

	/// The square of the level over narrow rings and wider ones, in mean edge lengths.
	std::array<double, 3> squares(double edge_length) const
	{
		std::array<double, 3> squares;
		for (std::size_t k = 0; k < squares.size(); ++k) {
			const double level = level_of(variances[k], FLAT) / edge_length;
			squares[k] = level * level;
		}
		return squares;
	}

	double mean_square_cosine() const
	{
		return square_cosines / static_cast<double>(std::max<std::size_t>(1, vertices.size()));
	}
};

// One within the bounds, falling to zero outside.
double certainty_within(double nothing, double low, double high, double none, double value)
{
	return way_between(nothing, low, value) * way_between(none, high, value);
}

} // namespace

double AxisNoise::level_along(const Point& normal) const
{
	const double cosine = normal.dot(axis);
	return std::sqrt(beside * beside + along * along * cosine * cosine);
}

AxisNoise find_axis_noise(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& normals,
	const NoiseSample& sample)
{
	if (sample.vertices.size() < FEWEST_VERTICES || !(sample.edge_length > 0))
		return {};
	AxisNoise result;
	result.axis = longest_axis(normals, sample);
	if (result.axis.isZero(0))
		return {};
	Group edge_on;
	Group between_both;
	Group face_on;
	for (std::size_t i = 0; i < sample.vertices.size(); ++i) {
		const Point& normal = normals[at(sample.vertices[i])];
		if (normal.isZero(0))
			continue;
		const double cosine = normal.dot(result.axis);
		const double square = cosine * cosine;
		Group& group = square < EDGE_ON ? edge_on : square > FACE_ON ? face_on : between_both;
		group.add(i, square, sample);
	}
	const auto share = [&](const Group& group) {
		return static_cast<double>(group.vertices.size()) /
			   static_cast<double>(sample.vertices.size());
	};
	result.certainty = way_between(FEW, ENOUGH, std::min(share(edge_on), share(face_on)));
	if (result.certainty == 0)
		return {};
	const std::array<double, 3> low = edge_on.squares(sample.edge_length);
	const std::array<double, 3> high = face_on.squares(sample.edge_length);
	const double more = high[0] - low[0];
	if (!(more > 0))
		return {};
	const double rise = more / (face_on.mean_square_cosine() - edge_on.mean_square_cosine());
	const double rest = std::max(0.0, low[0] - rise * edge_on.mean_square_cosine());
	// Levels below the least there is to remove are all alike.
	const double least = std::max(LEAST_NOISE, std::sqrt(low[0]));
	result.certainty *= way_between(EVEN, UNEVEN, std::sqrt(high[0]) / least);
	const double wider = (high[1] - low[1]) / more;
	const double widest = (high[2] - low[2]) / more;
	result.certainty *= certainty_within(SHRINKS, STAYS, NOISE_GROWS[0], NOISE_GROWS[1], wider) *
						way_between(DETAIL_GROWS[1], DETAIL_GROWS[0], widest);
	if (share(between_both) > FEWEST_BETWEEN) {
		const double expected = rest + rise * between_both.mean_square_cosine();
		const double found = between_both.squares(sample.edge_length)[0];
		result.certainty *= certainty_within(
			TOO_LOW, LOW_ENOUGH, HIGH_ENOUGH, TOO_HIGH, std::sqrt(found / expected));
	}
	if (result.certainty == 0)
		return {};
	result.certainty *=
		1 - share_drawn(
				workspace, positions, face_on.vertices, std::sqrt(high[0]) * sample.edge_length);
	const double white = share_of_noise(edge_on.variances);
	result.along = std::sqrt(rise);
	result.beside = std::sqrt(white * rest);
	result.detail = std::sqrt((1 - white) * rest);
	return result;
}

} // namespace orthopoly
