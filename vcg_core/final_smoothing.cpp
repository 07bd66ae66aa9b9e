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
constexpr int PAIRS[] = {1, 3, 10, 20, 40, 80, 160};

// So many times the gain of fewer pairs is worth more: gains are not known better than that, and
// more pairs take more of a shape.
constexpr double WORTH_MORE = 1.05;

// What more pairs than these take of a surface's shape hardly shows in differences over edges.
constexpr int MOST_PAIRS_BY_EDGES = 20;

// A method has it easier with its own result than with the mesh, which it does not follow as far:
// what it leaves there is 1.5 to 2.5 times what it leaves of the probe.
constexpr double UNDERSTATED = 1.5;

// Shares up to which nothing is smoothed, and from which all of the share is: a little smoothing
// turns the faces beside edges by more than it gains elsewhere, where all are flat.
constexpr double SHARE_OF_EDGES = 0.2;
constexpr double SHARE_OF_DETAIL = 0.4;

// So many times these where noise goes together: it rounds edges, which a method then leaves where
// the probe, put on edges that it made, tells nothing of.
constexpr double ROUNDED = 2;

// The terms of what goes by what was taken go together over some edges, so that their sum is by so
// much less certain than that of as many terms of no relation: 1.5 to 2 measured by summing over
// blocks.
constexpr double RELATED_TERMS = 2;

// Keeps of #V positions what so many pairs of the filter keep, here one that does not inflate.
void smooth(const Workspace& workspace, int pairs, std::vector<Point>& positions)
{
	low_pass(workspace, pairs, positions, -TAUBIN_SHRINK);
}

// Chooses the smoothing of a result, by what is along its normals.
class Chooser {
public:
	Chooser(
		const Workspace& workspace,
		const Probe& probe,
		const std::vector<Point>& responses,
		const std::vector<Point>& positions,
		const std::vector<std::uint8_t>& inner) :
			workspace_(workspace),
			probe_(probe), inner_(inner), positions_(positions), probed_(positions),
			taken_(positions.size()), left_(positions.size()), moves_(positions.size()),
			moves_of_probed_(positions.size())
	{
		const double sigma = probe.noise().overall();
		workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
			const Point& normal = probe.normals()[i];
			taken_[i] = (workspace.mesh.positions[i] - positions[i]).dot(normal);
			left_[i] = sigma * responses[i].dot(normal);
			probed_[i] += sigma * responses[i];
		});
	}

	FinalSmoothing choose()
	{
		const double variance = variance_over_edges();
		FinalSmoothing best;
		double most = 0;
		std::vector<Point> smoothed = positions_;
		std::vector<Point> smoothed_probed = probed_;
		int done = 0;
		for (const int pairs : PAIRS) {
			smooth(workspace_, pairs - done, smoothed);
			smooth(workspace_, pairs - done, smoothed_probed);
			done = pairs;
			set_moves(smoothed, smoothed_probed);
			const double squares = over_edges(
				[&](std::size_t a, std::size_t b) { return square(moves_[a] - moves_[b]); });
			if (!(squares > 0))
				continue;
			const double least =
				std::max(UNDERSTATED * least_of_probe(), least_of_own(variance, squares)) / squares;
			const double rounded = probe_.is_white() ? 1 : ROUNDED;
			double share = way_between(rounded * SHARE_OF_EDGES, rounded * SHARE_OF_DETAIL, least) *
						   std::max(0.0, std::min(1.0, least));
			if (pairs > MOST_PAIRS_BY_EDGES)
				share = std::min(share, std::max(0.0, UNDERSTATED * share_by_distances()));
			const double gain = share * (2 * least - share) * squares;
			if (gain > WORTH_MORE * most) {
				most = gain;
				best = {pairs, share};
			}
			// What is left of less smoothing would be smoothed by more, too.
			if (share == 0)
				break;
		}
		return best;
	}

private:
	static double square(double value) { return value * value; }

	bool counts(std::size_t vertex) const { return inner_.empty() || inner_[vertex] != 0; }

	template<class Value>
	double over_edges(const Value& value) const
	{
		return sum_over_edges(workspace_, [&](std::size_t from, std::size_t to) {
			return counts(from) && counts(to) ? value(from, to) : 0.0;
		});
	}

	template<class Value>
	double over_vertices(const Value& value) const
	{
		return workspace_.execution.sum(workspace_.mesh.vertex_count(), [&](Index index) {
			return counts(at(index)) ? value(at(index)) : 0.0;
		});
	}

	// The noise of the probe, as it differs over an edge.
	double noise(std::size_t a, std::size_t b) const
	{
		return probe_.noise().overall() * (probe_.noise_at(a) - probe_.noise_at(b));
	}

	// The variance of the noise as it differs over edges, in that of the probe: less than that
	// where less was taken than of the probe, since the noise of neighbouring vertices goes
	// together.
	double variance_over_edges() const
	{
		const double squares =
			over_edges([&](std::size_t a, std::size_t b) { return square(taken_[a] - taken_[b]); });
		const double of_probe = over_edges([&](std::size_t a, std::size_t b) {
			return square(noise(a, b) - (left_[a] - left_[b]));
		});
		return of_probe > 0 ? std::min(1.0, squares / of_probe) : 1;
	}

	// How far smoothing moves the vertices of both results.
	void set_moves(const std::vector<Point>& smoothed, const std::vector<Point>& smoothed_probed)
	{
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			const Point& normal = probe_.normals()[i];
			moves_[i] = (smoothed[i] - positions_[i]).dot(normal);
			moves_of_probed_[i] = (smoothed_probed[i] - probed_[i]).dot(normal);
		});
	}

	// The share of the moves that leaves the least of the probe, times their squares.
	double least_of_probe() const
	{
		return over_edges([&](std::size_t a, std::size_t b) {
			return (moves_of_probed_[a] - moves_of_probed_[b]) * (left_[b] - left_[a]);
		});
	}

	// The same of what the method made, by what was taken; 0 where it is not certain that this is
	// all of the squares. Less than that comes about by noise that is not white, too, so that it
	// tells nothing of noise that goes together.
	double least_of_own(double variance, double squares) const
	{
		if (!probe_.is_white())
			return 0;
		const auto product = [&](std::size_t a, std::size_t b) {
			const double move = moves_[a] - moves_[b];
			const double follows = moves_of_probed_[a] - moves_of_probed_[b] - move;
			return move * (taken_[a] - taken_[b]) - variance * noise(a, b) * follows;
		};
		const double least = over_edges(product);
		// Edges between two faces are met twice.
		const double scatter = over_edges([&](std::size_t a, std::size_t b) {
			const double move = moves_[a] - moves_[b];
			return 2 * square(product(a, b) - least / squares * square(move));
		});
		const double certain = least - RELATED_TERMS * std::sqrt(scatter);
		return certain >= squares ? certain : 0;
	}

	// The share that leaves the least of the probe in the distances themselves.
	double share_by_distances() const
	{
		const double squares = over_vertices([&](std::size_t i) { return square(moves_[i]); });
		const double least =
			over_vertices([&](std::size_t i) { return -moves_of_probed_[i] * left_[i]; });
		return squares > 0 ? least / squares : 0;
	}

	const Workspace& workspace_;
	const Probe& probe_;
	const std::vector<std::uint8_t>& inner_;
	const std::vector<Point>& positions_;
	// The result with what was left of the probe.
	std::vector<Point> probed_;
	// What was taken from the mesh, what was left of the probe, and what smoothing moves of either
	// result.
	std::vector<double> taken_;
	std::vector<double> left_;
	std::vector<double> moves_;
	std::vector<double> moves_of_probed_;
};

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
	return Chooser(workspace, probe, responses, positions, inner).choose();
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
