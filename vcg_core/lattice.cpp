// SPDX-License-Identifier: GPL-3.0-or-later
#include "lattice.h"

#include "sampling.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace orthopoly {

namespace {

// Faces whose edges are looked at.
constexpr Index FACES = 7000;

// Squares of edges, in squares of their mean, that differ by less are equal but for rounding:
// single precision a thousand edges off makes a tenth of it. Those of an edge below it count as no
// edge.
constexpr double EQUAL = 1e-3;

// Most squares in a row differ by the lattice's one, and where few edges are different a part of
// them does.
constexpr double SHARE_OF_STEPS = 0.1;

// Multiples up to which a step is fitted, one after the other, each time by the last.
constexpr std::array<double, 4> NARROWING = {2, 8, 32, 128};

// Multiples of the square that are looked at, how far off they may be, and the share that has to be
// on the lattice.
constexpr double MOST = 300;
constexpr double OFF = 0.1;
constexpr double ON_LATTICE = 0.99;

// Half-edges below which what is on a lattice was rather drawn there.
constexpr std::size_t FEWEST_EDGES = 600;

// Whether an edge between points of a cubic lattice may have so many times its squared step
// (Legendre 1798: all numbers are sums of three squares but seven more than a multiple of eight,
// times any power of four).
bool is_sum_of_three_squares(double multiple)
{
	auto number = static_cast<std::int64_t>(multiple);
	while (number > 0 && number % 4 == 0)
		number /= 4;
	return number % 8 != 7;
}

// The squares of the edges of a sample of faces in that of a length, in their order.
std::vector<double>
squares_of_edges(const Workspace& workspace, const std::vector<Point>& positions, double length)
{
	std::vector<double> squares;
	for (const Index i : sample_by_value(face_geometry(workspace, positions).areas, FACES)) {
		const Face& face = workspace.mesh.faces[at(i)];
		for (std::size_t corner = 0; corner < 3; ++corner) {
			const Point edge = positions[at(face[(corner + 1) % 3])] - positions[at(face[corner])];
			const double square = (edge / length).squaredNorm();
			if (square > EQUAL)
				squares.push_back(square);
		}
	}
	std::sort(squares.begin(), squares.end());
	return squares;
}

} // namespace

double lattice_step(const Workspace& workspace, const std::vector<Point>& positions)
{
	const double length = mean_edge_length(workspace, positions);
	if (!(length > 0))
		return 0;
	const std::vector<double> squares = squares_of_edges(workspace, positions, length);
	if (squares.size() < FEWEST_EDGES)
		return 0;
	std::vector<double> differences;
	for (std::size_t k = 1; k < squares.size(); ++k) {
		const double difference = squares[k] - squares[k - 1];
		if (difference > EQUAL)
			differences.push_back(difference);
	}
	double unit = quantile(differences, SHARE_OF_STEPS);
	if (!(unit > 0))
		return 0;
	const auto each_multiple = [&](double most, auto visit) {
		for (const double square : squares) {
			const double multiple = std::round(square / unit);
			if (multiple > most)
				break;
			visit(square, multiple);
		}
	};
	for (const double most : NARROWING) {
		double products = 0;
		double sum = 0;
		each_multiple(most, [&](double square, double multiple) {
			products += multiple * square;
			sum += multiple * multiple;
		});
		if (sum > 0)
			unit = products / sum;
	}
	double on = 0;
	double all = 0;
	each_multiple(MOST, [&](double square, double multiple) {
		all += 1;
		if (std::abs(square / unit - multiple) < OFF && is_sum_of_three_squares(multiple))
			on += 1;
	});
	const double step = std::sqrt(unit);
	return on > ON_LATTICE * all && step > LEAST_LATTICE_STEP ? step : 0;
}

} // namespace orthopoly
