// SPDX-License-Identifier: GPL-3.0-or-later
#include "correlated_moves.h"

#include "interpolation.h"
#include "moves.h"
#include "sampling.h"

#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// Averages of the squared moves: together a mean over some two hundred vertices.
constexpr int SQUARE_AVERAGES = 40;

// Chance alone makes those means differ, the more the further the moves go together and the fewer
// of them are their own. Of noise the spreads are 1.08 and 1.14 where the moves of neighbours do
// not correlate, 1.13 and 1.20 by 0.35, 1.22 to 1.28 and 1.3 to 1.5 by 0.65. Of detail as fine as
// horns and faces have they are more than that by 0.07 to 0.3 and by 0.1 to 0.8; the second is
// allowed some of it, which is given back (see UNEVEN).
constexpr double SPREAD = 1.10;
constexpr double SPREAD_PER_CORRELATION = 0.28;
constexpr double TOO_MUCH_SPREAD = 0.04;
constexpr double FAR_SPREAD = 1.23;
constexpr double FAR_SPREAD_PER_CORRELATION = 0.5;
constexpr double TOO_MUCH_FAR_SPREAD = 0.3;

// The share of the vertices around which what was taken is noise alone, at least, and how many
// times the mean square that is most of theirs may be noise elsewhere: chance makes it up to 2.2
// times, and what goes along at the edges of a volume or a reconstruction up to 4 times.
constexpr double NOISE_ALONE = 0.2;
constexpr double UNEVEN = 4;

// #V moves along the normals, in mean edge lengths.
std::vector<double> moves_in_edges(const Workspace& workspace, const std::vector<Point>& positions)
{
	const Deviations edge(workspace.mean_edge_length);
	return moves_along_normals(workspace, edge, positions).lengths;
}

// Values of those vertices that moved.
std::vector<double> where_moved(
	const std::vector<double>& values,
	const std::vector<double>& moves,
	const std::vector<std::uint8_t>& inner = {})
{
	std::vector<double> result;
	for (std::size_t i = 0; i < values.size(); ++i) {
		if (moves[i] != 0 && (inner.empty() || inner[i] != 0))
			result.push_back(values[i]);
	}
	return result;
}

} // namespace

double CorrelatedMoves::are_alike() const
{
	if (!(spread > 0))
		return 0;
	const double ordinary = SPREAD + SPREAD_PER_CORRELATION * edge_correlation;
	const double far = FAR_SPREAD + FAR_SPREAD_PER_CORRELATION * edge_correlation;
	return way_between(ordinary + TOO_MUCH_SPREAD, ordinary, spread) *
		   way_between(far + TOO_MUCH_FAR_SPREAD, far, far_spread);
}

CorrelatedMoves measure_correlated_moves(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<std::uint8_t>& inner)
{
	const std::vector<double> moves = moves_in_edges(workspace, positions);
	const std::vector<double> squares = mean_squares(workspace, SQUARE_AVERAGES, moves);
	std::vector<double> counted = where_moved(squares, moves, inner);
	CorrelatedMoves result;
	const double low = quantile(counted, NOISE_ALONE);
	if (!(low > 0))
		return result;
	result.spread = std::sqrt(quantile(counted, 0.8) / low);
	result.far_spread = std::sqrt(quantile(counted, 0.95) / low);
	const double half = quantile(counted, 0.5);
	double products = 0;
	double own = 0;
	for (const Face& face : workspace.mesh.faces) {
		for (std::size_t corner = 0; corner < 3; ++corner) {
			const std::size_t from = at(face[corner]);
			const std::size_t to = at(face[(corner + 1) % 3]);
			if (!inner.empty() && (inner[from] == 0 || inner[to] == 0))
				continue;
			if (std::max(squares[from], squares[to]) > half)
				continue;
			products += 2 * moves[from] * moves[to];
			own += moves[from] * moves[from] + moves[to] * moves[to];
		}
	}
	result.edge_correlation = own > 0 ? products / own : 0;
	return result;
}

void give_back_uneven(const Workspace& workspace, double most, std::vector<Point>& positions)
{
	const std::vector<double> moves = moves_in_edges(workspace, positions);
	const std::vector<double> squares = mean_squares(workspace, SQUARE_AVERAGES, moves);
	std::vector<double> counted = where_moved(squares, moves);
	const double noise = UNEVEN * quantile(counted, NOISE_ALONE);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		give_back(workspace, i, most * share_beyond(noise, squares[i]), positions);
	});
}

} // namespace orthopoly
