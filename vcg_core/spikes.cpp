// SPDX-License-Identifier: GPL-3.0-or-later
#include "spikes.h"

#include "local_heights.h"
#include "sampling.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace orthopoly {

namespace {

// Rings of vertices a polynomial is fitted to, and the fewest of them that say anything.
constexpr int RINGS = 2;
constexpr std::size_t FEWEST_OTHERS = 9;

constexpr int TERMS = 6;

// Rounds of fitting and weighing; the weights have settled then.
constexpr int ROUNDS = 5;

// Deviations at which a neighbour counts a quarter, and the least that one is, in local edges.
constexpr double TOLERANCE = 2;
constexpr double LEAST_DEVIATION = 0.01;

// Edge lengths that a spike stands out at least, deviations of the noise, and how many times as far
// as most of those around it. Clean meshes have hardly a vertex that does, and Gaussian noise of
// 0.2 none in thousands.
constexpr double FAR = 0.35;
constexpr double BEYOND_NOISE = 6;
constexpr double TIMES_AS_FAR = 6;
constexpr double MOST = 0.8;
constexpr double LEAST_DISTANCE = 0.02;

// The same of its neighbours, all but so many: on the far side of an edge these are as far off.
constexpr double TIMES_AS_FAR_AS_NEIGHBORS = 3;
constexpr std::size_t OTHER_SPIKES = 1;

// What is worth a closer look: vertices as far from the middle of their neighbours as this part of
// what a spike stands out at least, and so many times as far as the ordinary one of these is.
constexpr double SUSPICIOUS = 0.8;
constexpr double SUSPICIOUSLY_OFTEN = 3;

// Where the surface turns further than this cosine says within the rings, heights mean little.
constexpr double LEAST_COSINE = 0.7;

// Sweeps; each starts from where the last has put the neighbours.
constexpr int SWEEPS = 2;

// Fewer spikes than this, of the vertices and at all, may be there on purpose.
constexpr double LEAST_SHARE = 5e-4;
constexpr std::size_t FEWEST_SPIKES = 8;

/// The work on one mesh.
class Search {
public:
	Search(const Workspace& workspace, double noise) :
			workspace_(workspace), least_(std::max(FAR, BEYOND_NOISE * noise)),
			positions_(workspace.mesh.positions), moves_(positions_.size(), Point::Zero()),
			workers_(workspace)
	{
	}

	Spikes run()
	{
		for (int sweep = 0; sweep < SWEEPS; ++sweep) {
			look();
			bool any = false;
			for (std::size_t i = 0; i < positions_.size(); ++i) {
				if (moves_[i].isZero(0))
					continue;
				positions_[i] += moves_[i];
				any = true;
			}
			if (!any)
				break;
		}
		Spikes spikes;
		for (std::size_t i = 0; i < positions_.size(); ++i) {
			if (is_spike(i))
				spikes.vertices.push_back(static_cast<Index>(i));
		}
		const auto least = LEAST_SHARE * static_cast<double>(positions_.size());
		if (spikes.vertices.size() < FEWEST_SPIKES ||
			static_cast<double>(spikes.vertices.size()) < least)
			return {};
		unfold();
		spikes.positions = std::move(positions_);
		return spikes;
	}

private:
	using Terms = Eigen::Matrix<double, TERMS, 1>;
	using Gram = Eigen::Matrix<double, TERMS, TERMS>;

	// One of the others: where it is in the polynomial's plane, and how high, in local edges.
	struct Node {
		Terms terms;
		double height;
		double residual;
	};

	bool is_spike(std::size_t i) const { return positions_[i] != workspace_.mesh.positions[i]; }

	void measure_ways()
	{
		ways_.resize(positions_.size());
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			const auto vertex = static_cast<Index>(i);
			const double count = std::max(1, workspace_.vertex_faces.size(vertex));
			ways_[i] = sum_of_ways_around(workspace_, positions_, vertex) / (2 * count);
		});
	}

	// The positions with those vertices among their neighbours that are further from there than
	// any of these: a spike many edges high turns the surface below the heights.
	std::vector<Point> without_peaks()
	{
		std::vector<Point> result = positions_;
		workers_.for_each_vertex([&](Index i, VertexRings& rings) {
			const double distance = ways_[at(i)].norm();
			if (!(distance > SUSPICIOUS * least_ * workspace_.mean_edge_length))
				return;
			rings.collect(i, 1);
			const std::vector<Index>& ring = rings.vertices();
			if (std::all_of(ring.begin() + 1, ring.end(), [&](Index j) {
					return ways_[at(j)].norm() < distance;
				}))
				result[at(i)] += ways_[at(i)];
		});
		return result;
	}

	// Fills moves_: what puts each spike back, zero for the others.
	void look()
	{
		measure_ways();
		smooth_ = surface_below_heights(workspace_, without_peaks());
		crosses_ = cross_products_around(workspace_, smooth_);
		edges_.resize(positions_.size());
		offsets_.resize(positions_.size());
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			const auto vertex = static_cast<Index>(i);
			edges_[i] = std::sqrt(mean_edge_square_around(workspace_, smooth_, vertex));
			const double length = crosses_[i].norm();
			offsets_[i] = length > 0 ? std::abs(ways_[i].dot(crosses_[i])) / length : 0;
		});
		workers_.for_each_vertex([&](Index i, VertexRings& rings) {
			moves_[at(i)] = Point::Zero();
			if (offsets_[at(i)] > SUSPICIOUS * least_ * edges_[at(i)] &&
				!workspace_.mesh.is_fixed(i) && workspace_.edges.irregular[at(i)] == 0)
				examine(i, rings);
		});
	}

	// Moves spikes that fold a face still to the middle of their neighbours, along the surface.
	void unfold()
	{
		measure_ways();
		const std::vector<Point> before = positions_;
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			if (!is_spike(i) || !folds(before, static_cast<Index>(i)))
				return;
			const Point normal = crosses_[i].normalized();
			positions_[i] += ways_[i] - ways_[i].dot(normal) * normal;
		});
	}

	bool folds(const std::vector<Point>& positions, Index vertex) const
	{
		const IndexLists& around = workspace_.vertex_faces;
		return std::any_of(around.begin(vertex), around.end(vertex), [&](Index face) {
			const Point cross = face_cross_product(positions, workspace_.mesh.faces[at(face)]);
			return !(cross.dot(crosses_[at(vertex)]) > 0);
		});
	}

	void examine(Index vertex, VertexRings& rings)
	{
		const std::vector<Index>& ring = rings.vertices();
		rings.collect(vertex, 1);
		const std::size_t neighbors = ring.size() - 1;
		rings.collect(vertex, RINGS);
		if (ring.size() <= FEWEST_OTHERS)
			return;
		std::vector<double> sizes;
		for (std::size_t k = 1; k < ring.size(); ++k)
			sizes.push_back(offsets_[at(ring[k])]);
		if (!(offsets_[at(vertex)] > SUSPICIOUSLY_OFTEN * quantile(sizes, 0.5)))
			return;
		const Point normal = crosses_[at(vertex)].normalized();
		const bool turns = std::any_of(ring.begin(), ring.end(), [&](Index j) {
			return normal.dot(crosses_[at(j)].normalized()) < LEAST_COSINE;
		});
		if (turns)
			return;
		const double edge = edges_[at(vertex)];
		std::vector<Node> nodes = nodes_around(ring, normal, edge);
		double expected = 0;
		if (!fit(nodes, expected))
			return;
		const double height = (positions_[at(vertex)] - smooth_[at(vertex)]).dot(normal) / edge;
		const double residual = height - expected;
		sizes.clear();
		for (const Node& node : nodes)
			sizes.push_back(std::abs(node.residual));
		const double ordinary = std::max(LEAST_DISTANCE, quantile(sizes, MOST));
		sizes.clear();
		for (std::size_t k = 0; k < neighbors; ++k)
			sizes.push_back(std::abs(nodes[k].residual));
		std::sort(sizes.begin(), sizes.end());
		const double beside = sizes[std::max(neighbors, OTHER_SPIKES + 1) - OTHER_SPIKES - 1];
		if (std::abs(residual) >
			std::max({least_, TIMES_AS_FAR * ordinary, TIMES_AS_FAR_AS_NEIGHBORS * beside}))
			moves_[at(vertex)] = -edge * residual * normal;
	}

	std::vector<Node>
	nodes_around(const std::vector<Index>& ring, const Point& normal, double edge) const
	{
		const Point& center = smooth_[at(ring.front())];
		const Point tangent = normal.unitOrthogonal();
		const Point bitangent = normal.cross(tangent);
		std::vector<Node> nodes(ring.size() - 1);
		for (std::size_t k = 0; k < nodes.size(); ++k) {
			const std::size_t j = at(ring[k + 1]);
			const Point way = (smooth_[j] - center) / edge;
			const double x = way.dot(tangent);
			const double y = way.dot(bitangent);
			nodes[k].terms << 1, x, y, x * x, x * y, y * y;
			nodes[k].height = (positions_[j] - center).dot(normal) / edge;
			nodes[k].residual = 0;
		}
		return nodes;
	}

	// Fits the polynomial and fills in what it leaves; `expected` is its height at the centre, no
	// further out than the nodes that agree with it. False where the nodes do not fix it.
	static bool fit(std::vector<Node>& nodes, double& expected)
	{
		double deviation = 0;
		for (int round = 0; round <= ROUNDS; ++round) {
			Gram gram = Gram::Zero();
			Terms moments = Terms::Zero();
			double lowest = std::numeric_limits<double>::infinity();
			double highest = -lowest;
			for (const Node& node : nodes) {
				const double relative = deviation > 0 ? node.residual / (TOLERANCE * deviation) : 0;
				const double root = 1 / (1 + relative * relative);
				gram.selfadjointView<Eigen::Lower>().rankUpdate(node.terms, root * root);
				moments += root * root * node.height * node.terms;
				if (std::abs(relative) <= 1) {
					lowest = std::min(lowest, node.height);
					highest = std::max(highest, node.height);
				}
			}
			const Eigen::LLT<Gram> cholesky(gram);
			if (cholesky.info() != Eigen::Success || !(lowest <= highest))
				return false;
			const Terms coefficients = cholesky.solve(moments);
			if (!coefficients.allFinite())
				return false;
			expected = std::min(highest, std::max(lowest, coefficients[0]));
			std::vector<double> sizes;
			for (Node& node : nodes) {
				node.residual = node.height - node.terms.dot(coefficients);
				sizes.push_back(std::abs(node.residual));
			}
			deviation = std::max(LEAST_DEVIATION, DEVIATION_PER_MEDIAN * quantile(sizes, 0.5));
		}
		return true;
	}

	const Workspace& workspace_;
	// In the edges around.
	double least_;
	std::vector<Point> positions_;
	std::vector<Point> moves_;
	RingWorkers workers_;
	// Of the surface below the heights.
	std::vector<Point> smooth_;
	std::vector<Point> crosses_;
	std::vector<double> edges_;
	// From each vertex to the middle of its neighbours, each weighed by the faces shared.
	std::vector<Point> ways_;
	// How far each vertex is above or below the middle of its neighbours.
	std::vector<double> offsets_;
};

} // namespace

Spikes find_spikes(const Workspace& workspace, double noise)
{
	return Search(workspace, noise).run();
}

} // namespace orthopoly
