// SPDX-License-Identifier: GPL-3.0-or-later
#include "outliers.h"

#include "interpolation.h"
#include "local_heights.h"
#include "sampling.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace orthopoly {

namespace {

// Rings of vertices a polynomial is fitted to, and the fewest of them that say anything.
constexpr int RINGS = 2;
constexpr std::size_t FEWEST_NEIGHBORS = 8;

constexpr int TERMS = 6;

// Added to the squares of the second-degree terms (lengths in mean edges): a ring in which most
// are outliers would make them run away.
constexpr double STIFFNESS = 0.05;

// Rounds of fitting and weighing; the weights have settled then.
constexpr int ROUNDS = 6;

// After so many it shows whether there is anything to look for: where outliers make the noise, what
// the weighted polynomials leave in the better fifth of the places is less than this of its level.
// White noise leaves 0.75, if its amplitude varies 0.6; impulsive noise half and mostly much less.
constexpr int TRIAL_ROUNDS = 2;
constexpr double BETTER = 0.2;
constexpr double SUSPICIOUS = 0.56;

// Deviations at which a neighbour counts a quarter.
constexpr double TOLERANCE = 2;

// Deviations from which a vertex is an outlier: past nearly all Gaussian noise, whose deviation is
// known from some twenty values only, and past most vertices beside an edge, where it is less still
// that the others around say.
constexpr double OUTLYING = 6;

// A vertex further off than so many times the ordinary outlier is a feature.
constexpr double FURTHEST = 4;

// Where the surface turns further than this cosine says within the rings, heights mean little, and
// nothing is put back.
constexpr double LEAST_COSINE = 0.5;

// No deviation is less than this, in mean edge lengths, so that an exact surface has no outliers.
constexpr double LEAST_DEVIATION = 0.01;

// Sweeps that put outliers back: each starts from where the last has put their neighbours, which
// counts little beside the vertices that were never off.
constexpr int SWEEPS = 3;
constexpr double OUTLIER_WEIGHT = 0.1;

// Umbrella steps that centre outliers among their neighbours, across the normal.
constexpr int CENTERING_STEPS = 5;

// Median ratio (see NoiseLevels) from which there is no need to look for outliers.
constexpr double NO_OUTLIERS = 0.9;

// Where the level of flat places is less than these parts of that of ordinary ones, the ratio tells
// nothing, since detail has a like one, and neither does the trial: outliers are looked for
// whatever they say.
constexpr double WHITE = 0.8;
constexpr double DETAILED = 0.56;

// What is left of the noise level without the outliers, at which they explain it (fully at the
// second value): white noise loses a twentieth with them, noise whose amplitude varies a seventh,
// impulsive noise nearly all.
constexpr double UNEXPLAINED = 0.7;
constexpr double EXPLAINED = 0.5;

/// The work on one mesh.
class Repair {
public:
	Repair(const Workspace& workspace, const std::vector<Point>& positions) :
			workspace_(workspace), positions_(positions), weights_(positions.size(), 1.0),
			residuals_(positions.size(), 0.0), deviations_(positions.size(), 0.0),
			flags_(positions.size(), 0), workers_(workspace)
	{
	}

	Outliers run(double noise)
	{
		frame();
		for (int round = 1; round <= ROUNDS; ++round) {
			fit();
			weigh();
			if (round == TRIAL_ROUNDS && noise > 0) {
				std::vector<double> deviations = deviations_;
				if (quantile(deviations, BETTER) > SUSPICIOUS * noise)
					return {std::move(flags_), std::move(positions_), 0};
			}
		}
		Outliers result;
		result.count = flag();
		if (result.count > 0) {
			for (int sweep = 0; sweep < SWEEPS; ++sweep) {
				if (sweep > 0)
					frame();
				fit();
				for (std::size_t i = 0; i < positions_.size(); ++i) {
					if (flags_[i] != 0)
						positions_[i] -= edge_ * residuals_[i] * normals_[i];
				}
			}
			frame();
			for (int step = 0; step < CENTERING_STEPS; ++step)
				center();
		}
		result.flags = std::move(flags_);
		result.positions = std::move(positions_);
		return result;
	}

private:
	// Flags the outliers; returns how many there are. What looked like one and is none after all is
	// far off still, and goes on weighing less.
	Index flag()
	{
		std::vector<double> distances;
		for (std::size_t i = 0; i < residuals_.size(); ++i) {
			flags_[i] = std::abs(residuals_[i]) > OUTLYING * deviations_[i] ? 1 : 0;
			weights_[i] = flags_[i] != 0 ? OUTLIER_WEIGHT : 1;
			if (flags_[i] != 0)
				distances.push_back(std::abs(residuals_[i]));
		}
		const double furthest = FURTHEST * quantile(distances, 0.5);
		workers_.for_each_vertex([&](Index i, VertexRings& rings) {
			if (flags_[at(i)] == 0)
				return;
			rings.collect(i, RINGS);
			const bool turns =
				std::any_of(rings.vertices().begin(), rings.vertices().end(), [&](Index j) {
					return normals_[at(i)].dot(normals_[at(j)]) < LEAST_COSINE;
				});
			if (turns || std::abs(residuals_[at(i)]) > furthest || workspace_.mesh.is_fixed(i))
				flags_[at(i)] = 0;
		});
		return static_cast<Index>(std::count(flags_.begin(), flags_.end(), 1));
	}

	// What heights are measured from, read off the positions as they are now.
	void frame()
	{
		smooth_ = surface_below_heights(workspace_, positions_);
		edge_ = mean_edge_length(workspace_, smooth_);
		normals_.resize(positions_.size());
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			const Point sum = cross_product_around(workspace_, smooth_, static_cast<Index>(i));
			const double length = sum.norm();
			normals_[i] = length > 0 ? Point(sum / length) : sum;
		});
	}

	// How far every vertex is above what the others around it say, in mean edge lengths.
	void fit()
	{
		workers_.for_each_vertex([&](Index i, VertexRings& rings) {
			residuals_[at(i)] = 0;
			const Point& normal = normals_[at(i)];
			rings.collect(i, RINGS);
			const std::vector<Index>& ring = rings.vertices();
			if (ring.size() <= FEWEST_NEIGHBORS || normal.isZero(0))
				return;
			using Terms = Eigen::Matrix<double, TERMS, 1>;
			using Gram = Eigen::Matrix<double, TERMS, TERMS>;
			const Point tangent = normal.unitOrthogonal();
			const Point bitangent = normal.cross(tangent);
			double lowest = std::numeric_limits<double>::infinity();
			double highest = -lowest;
			Gram gram = Gram::Zero();
			Terms moments = Terms::Zero();
			for (std::size_t k = 1; k < ring.size(); ++k) {
				const std::size_t j = at(ring[k]);
				const Point node = (smooth_[j] - smooth_[at(i)]) / edge_;
				const double x = node.dot(tangent);
				const double y = node.dot(bitangent);
				const double height = (positions_[j] - smooth_[at(i)]).dot(normal) / edge_;
				// Outliers do not say how far the others reach.
				if (flags_[j] == 0) {
					lowest = std::min(lowest, height);
					highest = std::max(highest, height);
				}
				Terms terms;
				terms << 1, x, y, x * x, x * y, y * y;
				gram.selfadjointView<Eigen::Lower>().rankUpdate(terms, weights_[j]);
				moments += weights_[j] * height * terms;
			}
			// The sum of squares of the second derivatives, whichever way the axes lie.
			gram.diagonal().tail<3>() += STIFFNESS * Eigen::Vector3d(1, 0.5, 1);
			const Eigen::LLT<Gram> cholesky(gram);
			if (cholesky.info() != Eigen::Success)
				return;
			if (!(lowest <= highest))
				return;
			// No further out than the surroundings, whatever the polynomial says.
			const double expected = std::min(highest, std::max(lowest, cholesky.solve(moments)[0]));
			const double height = (positions_[at(i)] - smooth_[at(i)]).dot(normal) / edge_;
			const double residual = height - expected;
			if (std::isfinite(residual))
				residuals_[at(i)] = residual;
		});
	}

	// The deviations of the noise as the vertices around each show them, and from them the weights.
	void weigh()
	{
		workers_.for_each_vertex([&](Index i, VertexRings& rings) {
			rings.collect(i, RINGS);
			std::vector<double> sizes;
			sizes.reserve(rings.vertices().size());
			for (std::size_t k = 1; k < rings.vertices().size(); ++k)
				sizes.push_back(std::abs(residuals_[at(rings.vertices()[k])]));
			deviations_[at(i)] =
				std::max(LEAST_DEVIATION, DEVIATION_PER_MEDIAN * quantile(sizes, 0.5));
			const double relative = residuals_[at(i)] / (TOLERANCE * deviations_[at(i)]);
			weights_[at(i)] = 1 / ((1 + relative * relative) * (1 + relative * relative));
		});
	}

	// Moves outliers to the middle of their neighbours, across the normal.
	void center()
	{
		std::vector<Point> moved = positions_;
		workers_.for_each_vertex([&](Index i, VertexRings& rings) {
			if (flags_[at(i)] == 0 || workspace_.edges.irregular[at(i)] != 0)
				return;
			rings.collect(i, 1);
			Point sum = Point::Zero();
			for (const Index j : rings.vertices())
				sum += positions_[at(j)] - positions_[at(i)];
			const auto neighbors = static_cast<double>(rings.vertices().size() - 1);
			if (!(neighbors > 0))
				return;
			const Point& normal = normals_[at(i)];
			moved[at(i)] += (sum - sum.dot(normal) * normal) / neighbors;
		});
		positions_.swap(moved);
	}

	const Workspace& workspace_;
	std::vector<Point> positions_;
	std::vector<Point> smooth_;
	std::vector<Point> normals_;
	double edge_ = 0;
	std::vector<double> weights_;
	std::vector<double> residuals_;
	std::vector<double> deviations_;
	std::vector<std::uint8_t> flags_;
	RingWorkers workers_;
};

} // namespace

Outliers
put_back_outliers(const Workspace& workspace, const std::vector<Point>& positions, double noise)
{
	if (!(mean_edge_length(positions, workspace.mesh.faces) > 0))
		return {std::vector<std::uint8_t>(positions.size(), 0), positions, 0};
	return Repair(workspace, positions).run(noise);
}

OutlierRepair repair_outliers(const Workspace& workspace, const NoiseLevels& levels)
{
	const double noise = levels.ordinary;
	const bool may_be_detail = levels.flat < WHITE * noise;
	if (noise < LEAST_NOISE || (levels.median_ratio > NO_OUTLIERS && !may_be_detail))
		return {};
	const std::vector<Point>& measured = workspace.mesh.positions;
	const Outliers outliers =
		put_back_outliers(workspace, measured, levels.flat < DETAILED * noise ? 0 : noise);
	if (outliers.count == 0)
		return {};
	const NoiseLevels after = estimate_noise_levels(workspace, outliers.positions);
	// What is left without them is noise of all vertices, and detail.
	const double removed = noise * noise - after.ordinary * after.ordinary;
	const double level = std::sqrt(std::max(0.0, removed + after.flat * after.flat));
	if (level < LEAST_NOISE)
		return {};
	const double share = way_between(UNEXPLAINED, EXPLAINED, after.flat / level);
	if (share == 0)
		return {};
	const double found = static_cast<double>(outliers.count) / workspace.mesh.vertex_count();
	OutlierRepair result = {share, level, after.flat, found, measured};
	for (std::size_t i = 0; i < measured.size(); ++i) {
		if (outliers.flags[i] != 0)
			result.positions[i] += share * (outliers.positions[i] - measured[i]);
	}
	return result;
}

} // namespace orthopoly
