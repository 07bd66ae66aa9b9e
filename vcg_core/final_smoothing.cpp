// SPDX-License-Identifier: GPL-3.0-or-later
#include "final_smoothing.h"

#include "interpolation.h"
#include "moves.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace orthopoly {

namespace {

// Pairs of the filter to choose from: a few where surfaces have detail, many where they hardly
// have.
constexpr int PAIRS[] = {1, 3, 10, 20};

// A method has it easier with its own result than with the mesh, which it does not follow as far:
// what it leaves there is 1.5 to 2.5 times what it leaves of the probe.
constexpr double UNDERSTATED = 1.5;

// Shares up to which nothing is smoothed, and from which all of the share is: a little smoothing
// turns the faces beside edges by more than it gains elsewhere, where all are flat.
constexpr double SHARE_OF_EDGES = 0.2;
constexpr double SHARE_OF_DETAIL = 0.4;

// The terms of what goes by what was taken go together over some edges, so that their sum is by so
// much less certain than that of as many terms of no relation: 1.5 to 2 measured by summing over
// blocks.
constexpr double RELATED_TERMS = 2;

// Keeps of #V positions what so many pairs of the filter keep, here one that does not inflate.
void smooth(const Workspace& workspace, int pairs, std::vector<Point>& positions)
{
	low_pass(workspace, pairs, positions, -TAUBIN_SHRINK);
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

// The variance of the noise as it differs over edges, in that of the probe: less than that where
// less was taken than of the probe, since the noise of neighbouring vertices goes together.
double variance_over_edges(
	const Workspace& workspace,
	const Probe& probe,
	const std::vector<double>& taken,
	const std::vector<double>& left,
	const std::vector<std::uint8_t>& inner)
{
	const double squares = sum_over_edges(workspace, inner, [&](std::size_t a, std::size_t b) {
		const double difference = taken[a] - taken[b];
		return difference * difference;
	});
	const double of_probe = sum_over_edges(workspace, inner, [&](std::size_t a, std::size_t b) {
		const double noise = probe.noise().overall() * (probe.noise_at(a) - probe.noise_at(b));
		const double difference = noise - (left[a] - left[b]);
		return difference * difference;
	});
	return of_probe > 0 ? std::min(1.0, squares / of_probe) : 1;
}

// Takes back the moves of vertices whose faces are turned over by them; false where none is.
bool take_back_folds(
	const Workspace& workspace, const std::vector<Point>& before, std::vector<Point>& positions)
{
	const std::vector<Face>& faces = workspace.mesh.faces;
	std::vector<std::uint8_t> turned(faces.size());
	workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
		const Point cross = face_cross_product(before, faces[i]);
		turned[i] = cross.dot(face_cross_product(positions, faces[i])) < 0 ? 1 : 0;
	});
	std::vector<std::uint8_t> back(positions.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const IndexLists& around = workspace.vertex_faces;
		const auto vertex = static_cast<Index>(i);
		const bool turns = std::any_of(around.begin(vertex), around.end(vertex), [&](Index face) {
			return turned[at(face)] != 0;
		});
		if (turns && positions[i] != before[i]) {
			positions[i] = before[i];
			back[i] = 1;
		}
	});
	return std::any_of(back.begin(), back.end(), [](std::uint8_t flag) { return flag != 0; });
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
	const double sigma = probe.noise().overall();
	// Along the normals what was taken and what of the probe was left, and the result of that.
	std::vector<double> taken(positions.size());
	std::vector<double> left(positions.size());
	std::vector<Point> probed = positions;
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		taken[i] = (workspace.mesh.positions[i] - positions[i]).dot(normals[i]);
		left[i] = sigma * responses[i].dot(normals[i]);
		probed[i] += sigma * responses[i];
	});
	const double variance = variance_over_edges(workspace, probe, taken, left, inner);
	FinalSmoothing best;
	double most = 0;
	// What the pairs so far make of both results, and how far that moves vertices.
	std::vector<Point> smoothed = positions;
	std::vector<Point> smoothed_probed = probed;
	std::vector<double> moves(positions.size());
	std::vector<double> moves_probed(positions.size());
	int done = 0;
	for (const int pairs : PAIRS) {
		smooth(workspace, pairs - done, smoothed);
		smooth(workspace, pairs - done, smoothed_probed);
		done = pairs;
		workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
			moves[i] = (smoothed[i] - positions[i]).dot(normals[i]);
			moves_probed[i] = (smoothed_probed[i] - probed[i]).dot(normals[i]);
		});
		const auto square = [&](std::size_t a, std::size_t b) {
			return (moves[a] - moves[b]) * (moves[a] - moves[b]);
		};
		const double squares = sum_over_edges(workspace, inner, square);
		if (!(squares > 0))
			continue;
		const double of_probe = sum_over_edges(workspace, inner, [&](std::size_t a, std::size_t b) {
			return (moves_probed[a] - moves_probed[b]) * (left[b] - left[a]);
		});
		const auto product = [&](std::size_t a, std::size_t b) {
			const double move = moves[a] - moves[b];
			const double follows = moves_probed[a] - moves_probed[b] - move;
			const double noise = sigma * (probe.noise_at(a) - probe.noise_at(b));
			return move * (taken[a] - taken[b]) - variance * noise * follows;
		};
		const double of_taken = sum_over_edges(workspace, inner, product);
		// Edges between two faces are met twice.
		const double scatter = sum_over_edges(workspace, inner, [&](std::size_t a, std::size_t b) {
			const double rest = product(a, b) - of_taken / squares * square(a, b);
			return 2 * rest * rest;
		});
		const double certain = of_taken - RELATED_TERMS * std::sqrt(scatter);
		// Less than all of it comes about by noise that is not white, too.
		const double of_own = certain >= squares ? certain : 0;
		const double least = std::max(UNDERSTATED * of_probe, of_own) / squares;
		const double share = way_between(SHARE_OF_EDGES, SHARE_OF_DETAIL, least) *
							 std::max(0.0, std::min(1.0, least));
		const double gain = share * (2 * least - share) * squares;
		if (gain > most) {
			most = gain;
			best = {pairs, share};
		}
	}
	return best;
}

void smooth_finally(
	const Workspace& workspace, const FinalSmoothing& smoothing, std::vector<Point>& positions)
{
	if (!(smoothing.share > 0))
		return;
	std::vector<Point> smoothed = positions;
	smooth(workspace, smoothing.pairs, smoothed);
	const std::vector<Point> normals = vertex_normals(workspace, positions);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const Point away = smoothed[i] - positions[i];
		smoothed[i] = positions[i];
		if (!workspace.mesh.is_fixed(static_cast<Index>(i)))
			smoothed[i] += smoothing.share * away.dot(normals[i]) * normals[i];
	});
	while (take_back_folds(workspace, positions, smoothed)) {}
	positions = std::move(smoothed);
}

} // namespace orthopoly
