// SPDX-License-Identifier: GPL-3.0-or-later
#include "final_smoothing.h"

#include "interpolation.h"
#include "moves.h"

#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// Pairs of the filter where surfaces have detail; and those where they hardly have, the most first,
// for where twice all of the smoothing would not be too much.
constexpr int PAIRS = 3;
constexpr int WIDE_PAIRS[] = {20, 10};
constexpr double WIDE_SHARE = 2;

// Shares up to which nothing is smoothed, and from which all of the share is: the probe, which is
// no small one, makes them a fifth too large, and a little smoothing turns the faces beside edges
// by more than it gains elsewhere, where all are flat.
constexpr double SHARE_OF_EDGES = 0.3;
constexpr double SHARE_OF_DETAIL = 0.5;

// The estimate's terms go together over some edges, so that their sum is by so much less certain
// than that of as many terms of no relation: 1.5 to 2 measured by summing over blocks.
constexpr double RELATED_TERMS = 2;

// #V positions after the filter, less those before.
std::vector<Point>
smoothed_away(const Workspace& workspace, int pairs, const std::vector<Point>& positions)
{
	std::vector<Point> moves = positions;
	low_pass(workspace, pairs, moves, -TAUBIN_SHRINK);
	workspace.execution.for_each(
		workspace.mesh.vertex_count(), [&](std::size_t i) { moves[i] -= positions[i]; });
	return moves;
}

// Over the edges of a face, each edge that two faces share being met twice.
template<class Value>
double sum_over_edges(
	const Workspace& workspace, const std::vector<std::uint8_t>& inner, const Value& value)
{
	const std::vector<Face>& faces = workspace.mesh.faces;
	return workspace.execution.sum(workspace.mesh.face_count(), [&](Index index) {
		const Face& face = faces[at(index)];
		double sum = 0;
		for (std::size_t k = 0; k < 3; ++k) {
			const std::size_t from = at(face[k]);
			const std::size_t to = at(face[(k + 1) % 3]);
			if (inner.empty() || (inner[from] != 0 && inner[to] != 0))
				sum += value(from, to);
		}
		return sum;
	});
}

// The square of the overall deviation of the noise as it differs over edges: the given one, or less
// where less was taken than the responses say, since the noise of neighbouring vertices goes
// together.
double variance_of(
	const Workspace& workspace,
	const Probe& probe,
	const std::vector<Point>& responses,
	const std::vector<double>& moves,
	const std::vector<std::uint8_t>& inner)
{
	const double taken = sum_over_edges(workspace, inner, [&](std::size_t a, std::size_t b) {
		const double difference = moves[a] - moves[b];
		return difference * difference;
	});
	// Of the probe, if the method is a filter, or if what it follows are choices.
	const double filtered = sum_over_edges(workspace, inner, [&](std::size_t a, std::size_t b) {
		const auto left = [&](std::size_t i) {
			return probe.noise_at(i) - probe.bounded_response(responses, i);
		};
		const double difference = left(a) - left(b);
		return difference * difference;
	});
	const double chosen = sum_over_edges(workspace, inner, [&](std::size_t a, std::size_t b) {
		const double noise = probe.noise_at(a) - probe.noise_at(b);
		const auto response = [&](std::size_t i) { return responses[i].dot(probe.normals()[i]); };
		return noise * (noise - (response(a) - response(b)));
	});
	const double told = std::min(filtered, chosen);
	const double variance = probe.noise().overall() * probe.noise().overall();
	return told > 0 ? std::min(variance, taken / told) : variance;
}

} // namespace

FinalSmoothing choose_smoothing(
	const Workspace& workspace,
	const Probe& probe,
	const std::vector<Point>& responses,
	const std::vector<Point>& positions,
	const std::vector<std::uint8_t>& inner)
{
	const std::vector<Point>& normals = probe.normals();
	std::vector<double> moves(positions.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		moves[i] = (workspace.mesh.positions[i] - positions[i]).dot(normals[i]);
	});
	const double variance = variance_of(workspace, probe, responses, moves, inner);
	// The share of the smoothing that leaves the least, less what of it may be chance.
	const auto certain_share = [&](int pairs) {
		std::vector<double> heights(positions.size());
		std::vector<double> follows(positions.size());
		const std::vector<Point> away = smoothed_away(workspace, pairs, positions);
		const std::vector<Point> responses_away = smoothed_away(workspace, pairs, responses);
		workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
			heights[i] = away[i].dot(normals[i]);
			follows[i] = responses_away[i].dot(normals[i]);
		});
		const auto product = [&](std::size_t a, std::size_t b) {
			return (heights[a] - heights[b]) * (moves[a] - moves[b]) -
				   variance * (probe.noise_at(a) - probe.noise_at(b)) * (follows[a] - follows[b]);
		};
		const auto square = [&](std::size_t a, std::size_t b) {
			return (heights[a] - heights[b]) * (heights[a] - heights[b]);
		};
		const double squares = sum_over_edges(workspace, inner, square);
		if (!(squares > 0))
			return 0.0;
		const double likely = sum_over_edges(workspace, inner, product) / squares;
		// Edges between two faces are met twice.
		const double scatter = sum_over_edges(workspace, inner, [&](std::size_t a, std::size_t b) {
			const double rest = product(a, b) - likely * square(a, b);
			return 2 * rest * rest;
		});
		return likely - RELATED_TERMS * std::sqrt(scatter) / squares;
	};
	for (const int pairs : WIDE_PAIRS) {
		if (certain_share(pairs) >= WIDE_SHARE)
			return {pairs, 1};
	}
	const double share = std::min(1.0, certain_share(PAIRS));
	return {PAIRS, way_between(SHARE_OF_EDGES, SHARE_OF_DETAIL, share) * std::max(0.0, share)};
}

void smooth_finally(
	const Workspace& workspace, const FinalSmoothing& smoothing, std::vector<Point>& positions)
{
	if (!(smoothing.share > 0))
		return;
	const std::vector<Point> away = smoothed_away(workspace, smoothing.pairs, positions);
	const std::vector<Point> normals = vertex_normals(workspace, positions);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		if (!workspace.mesh.is_fixed(static_cast<Index>(i)))
			positions[i] += smoothing.share * away[i].dot(normals[i]) * normals[i];
	});
}

} // namespace orthopoly
