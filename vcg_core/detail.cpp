// SPDX-License-Identifier: GPL-3.0-or-later
#include "detail.h"

#include "interpolation.h"
#include "local_heights.h"
#include "move_prediction.h"
#include "moves.h"
#include "sampling.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>

namespace orthopoly {

namespace {

// Averages over vertices and their neighbours, one after the other, of what tells how much the
// moves around a vertex have in common: together a mean over some two hundred vertices.
constexpr int COMMON_AVERAGES = 40;

// Mean product of a move and the average of those around it where they are noise: what a vertex of
// six faces counts in its own average, a third where it is taken once and 0.185 where twice.
constexpr double NOISE_IN_PRODUCT = 0.26;

// Part of the noise variance by which going back along the averages would lower the mean square of
// the moves, up to which that is taken for chance, and from which for detail. Of vertices in noise
// alone one in two hundred is beyond the first.
constexpr double CHANCE = 0.05;
constexpr double CERTAIN = 0.14;

// Averages are less than the detail they are of, so that more than all of them may be given back.
constexpr double LARGEST_GAIN = 1.5;

// Median share of the moves' variance that their neighbours predict, from which there are ridges or
// grooves as narrow as the triangles all over the mesh, and are for certain. Noise alone and smooth
// surfaces leave up to 0.17; a median over so many vertices is steady.
constexpr double RIDGED = 0.2;
constexpr double SURELY_RIDGED = 0.35;
constexpr Index PREDICTIONS = 2000;

// Median share that the directions of neighbours predict of what their plain sum does not, up to
// which they do not count, and from which they do.
constexpr double UNDIRECTED = 0.05;
constexpr double DIRECTED = 0.12;

// Vertices with less than this part of the overall noise do not say how much of it is detail: what
// they have been moved by is none of it.
constexpr double NOISY = 0.5;

// The same of a vertex's surroundings, on a mesh that has them.
constexpr double RIDGE_BEGINS = 0.1;
constexpr double RIDGE = 0.3;

// Averages of the squared moves: together a mean over some forty vertices, which noise alone makes
// vary by a quarter.
constexpr int SQUARE_AVERAGES = 8;

// Noise variances below which moves are taken for noise alone: more than four times that beyond
// one, so that in a million vertices few are not.
constexpr double MARGIN = 2.1;

// Rings of vertices whose median distance is the ordinary one around a vertex.
constexpr int RINGS = 2;

// Ordinary distances up to which a vertex is no outlier, and from which it is taken for one.
constexpr double INLYING = 2.2;
constexpr double OUTLYING = 3.7;

// An ordinary distance counts within these bounds, in mean edge lengths: where many have been moved
// far, outliers are among them that nobody found.
constexpr double LEAST_DISTANCE = 1e-3;
constexpr double LARGEST_DISTANCE = 0.035;

constexpr Index GRAIN = 256;

// Takes vertices back along what their moves have in common with those around them.
void give_back_common(
	const Workspace& workspace, const Deviations& sigma, std::vector<Point>& positions)
{
	const Moves moves = moves_beside_edges(workspace, sigma, positions);
	// Averaged once and twice, half of each: detail is narrow where there is little noise, and as
	// wide as the fits where these are blurred by more.
	std::vector<double> averages = moves.lengths;
	average(workspace, 1, averages);
	std::vector<double> wider = averages;
	average(workspace, 1, wider);
	// Mean product of moves and averages, and mean square of these.
	std::vector<Eigen::Array2d> means(positions.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		averages[i] = 0.5 * (averages[i] + wider[i]);
		means[i] = averages[i] * Eigen::Array2d(moves.lengths[i], averages[i]);
	});
	average(workspace, COMMON_AVERAGES, means);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const double common = means[i][0] - NOISE_IN_PRODUCT;
		if (!(common > 0) || workspace.mesh.is_fixed(static_cast<Index>(i)))
			return;
		const double gain = std::min(LARGEST_GAIN, common / means[i][1]);
		const double certainty = way_between(CHANCE, CERTAIN, gain * common);
		positions[i] += certainty * gain * averages[i] * sigma[i] * moves.crosses[i].normalized();
	});
}

// What the neighbours of some vertices predict of their moves.
std::vector<PredictedMove> predict_moves(
	const Workspace& workspace,
	const Moves& moves,
	const std::vector<MovePredictor::DirectedMoves>& directed,
	const std::vector<Index>& vertices)
{
	std::vector<MovePredictor> predictors(
		static_cast<std::size_t>(workspace.execution.threads()),
		MovePredictor(workspace, moves, directed));
	std::vector<PredictedMove> result(vertices.size());
	workspace.execution.parallel_for(
		static_cast<Index>(vertices.size()), GRAIN, [&](Index begin, Index end, int worker) {
			for (Index i = begin; i < end; ++i)
				result[at(i)] =
					predictors[static_cast<std::size_t>(worker)].predict(vertices[at(i)]);
		});
	return result;
}

// Takes vertices back as far as their neighbours predict it, on a mesh that has ridges.
TakenMoves
give_back_ridges(const Workspace& workspace, const Deviations& sigma, std::vector<Point>& positions)
{
	const Moves moves = moves_beside_edges(workspace, sigma, positions);
	const std::vector<MovePredictor::DirectedMoves> directed =
		MovePredictor::directed_moves(workspace, positions, moves.lengths);
	const std::vector<Index> sample =
		sample_vertices(workspace, workspace.mesh.positions, PREDICTIONS);
	std::vector<double> shares;
	std::vector<double> directed_shares;
	std::vector<double> squares;
	const std::vector<PredictedMove> sampled = predict_moves(workspace, moves, directed, sample);
	for (std::size_t k = 0; k < sampled.size(); ++k) {
		if (sigma.factor(at(sample[k])) < NOISY)
			continue;
		shares.push_back(sampled[k].share);
		directed_shares.push_back(sampled[k].directed_share);
		squares.push_back(sampled[k].square);
	}
	const double counts = way_between(UNDIRECTED, DIRECTED, quantile(directed_shares, 0.5));
	const TakenMoves taken = {quantile(squares, 0.5), counts * quantile(shares, 0.5)};
	const double ridged = way_between(RIDGED, SURELY_RIDGED, taken.predicted);
	if (ridged == 0)
		return taken;
	std::vector<Index> all;
	for (Index i = 0; i < workspace.mesh.vertex_count(); ++i) {
		if (moves.lengths[at(i)] != 0 && !workspace.mesh.is_fixed(i))
			all.push_back(i);
	}
	const std::vector<PredictedMove> predicted = predict_moves(workspace, moves, directed, all);
	workspace.execution.for_each(static_cast<Index>(all.size()), [&](std::size_t k) {
		const double certainty = ridged * way_between(RIDGE_BEGINS, RIDGE, predicted[k].share);
		positions[at(all[k])] += certainty * predicted[k].length * sigma[at(all[k])] *
								 moves.crosses[at(all[k])].normalized();
	});
	return taken;
}

} // namespace

TakenMoves give_back_detail(
	const Workspace& workspace, const Deviations& sigma, double most, std::vector<Point>& positions)
{
	std::vector<Point> given = positions;
	give_back_common(workspace, sigma, given);
	const TakenMoves taken = give_back_ridges(workspace, sigma, given);
	const std::vector<double> squares = mean_squares(
		workspace, SQUARE_AVERAGES, moves_along_normals(workspace, sigma, given).lengths);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		if (workspace.mesh.is_fixed(static_cast<Index>(i)))
			return;
		give_back(workspace, i, share_beyond(MARGIN, squares[i]), given);
		positions[i] += most * (given[i] - positions[i]);
	});
	return taken;
}

void give_back_inliers(
	const Workspace& workspace, double sigma, double most, std::vector<Point>& positions)
{
	const double edge = workspace.mean_edge_length;
	std::vector<double> distances(positions.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		distances[i] = (workspace.mesh.positions[i] - positions[i]).norm();
	});
	std::vector<VertexRings> rings(
		static_cast<std::size_t>(workspace.execution.threads()), VertexRings(workspace));
	workspace.execution.parallel_for(
		workspace.mesh.vertex_count(), GRAIN, [&](Index begin, Index end, int worker) {
			VertexRings& ring = rings[static_cast<std::size_t>(worker)];
			std::vector<double> around;
			for (Index i = begin; i < end; ++i) {
				ring.collect(i, RINGS);
				around.clear();
				for (const Index j : ring.vertices())
					around.push_back(distances[at(j)]);
				const double ordinary = std::min(
					LARGEST_DISTANCE * edge,
					std::max(LEAST_DISTANCE * edge, quantile(around, 0.5)));
				const double inlying = way_between(OUTLYING, INLYING, distances[at(i)] / ordinary);
				const double deviation = DEVIATION_PER_MEDIAN * ordinary;
				const double detail = share_beyond(MARGIN * (sigma * sigma), deviation * deviation);
				give_back(workspace, at(i), most * inlying * detail, positions);
			}
		});
}

} // namespace orthopoly
