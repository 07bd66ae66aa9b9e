// SPDX-License-Identifier: GPL-3.0-or-later
#include "broad_detail.h"

#include "interpolation.h"
#include "local_heights.h"
#include "prefilter.h"
#include "sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// Pairs of the filter, which keep a ninth of the noise. Five keep a third of it, and of the detail
// not more by as much; 40 less of the detail.
constexpr int PAIRS = 30;

// Deviations of the noise that the probe moves vertices by: as little as leaves the method's
// choices as they are, mostly, and far above rounding.
constexpr double PROBE = 0.1;

// A response beyond so many times the probe is another choice of the method's, which says nothing.
constexpr double LARGEST_RESPONSE = 2;

// Averages that gains are reckoned over: some two hundred vertices. These alone tell them to within
// 0.3, too little, so that those of all count with the weight of so many such surroundings.
constexpr int AVERAGES = 40;
constexpr double WEIGHT_OF_ALL = 4;

// What is kept of detail is less than it, so that a little more may be given back.
constexpr double LARGEST_GAIN = 1.2;

// Gains up to which nothing is given back, and from which all of what was reckoned is: where little
// is detail, normals lose more by the noise that comes with it than vertices gain. Both are higher
// by what is likely chance among so many vertices: this over the root of their number.
constexpr double GAIN_OF_NOISE = 0.25;
constexpr double GAIN_OF_DETAIL = 0.45;
constexpr double CHANCE = 20;

// The filter (see taubin_smooth) of values at the vertices.
void keep_broad(const Workspace& workspace, std::vector<Eigen::Array2d>& values)
{
	for (int pair = 0; pair < PAIRS; ++pair) {
		for (const double step : {TAUBIN_SHRINK, TAUBIN_INFLATE}) {
			std::vector<Eigen::Array2d> means = values;
			average(workspace, 1, means);
			// Of the mean's three thirds the vertex itself is one.
			workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
				values[i] += 1.5 * step * (means[i] - values[i]);
			});
		}
	}
}

} // namespace

BroadDetail::BroadDetail(
	const Workspace& workspace, double sigma, const std::vector<Point>& positions) :
		workspace_(workspace),
		sigma_(sigma), moves_(moves_beside_edges(workspace, sigma, positions)),
		signs_(signs_by_value(areas_around(workspace, workspace.mesh.positions))),
		kept_(positions.size(), Eigen::Array2d::Zero())
{
	for (std::size_t i = 0; i < signs_.size(); ++i) {
		if (moves_.crosses[i].isZero(0) || workspace.mesh.is_fixed(static_cast<Index>(i)))
			signs_[i] = 0;
		kept_[i] = {moves_.lengths[i], signs_[i]};
	}
	keep_broad(workspace, kept_);
}

std::vector<Point> BroadDetail::with_probe() const
{
	std::vector<Point> positions = workspace_.mesh.positions;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (signs_[i] != 0)
			positions[i] += PROBE * sigma_ * signs_[i] * moves_.crosses[i].normalized();
	}
	return positions;
}

template<class Value>
double BroadDetail::sum(const std::vector<std::uint8_t>& inner, const Value& value) const
{
	return workspace_.execution.sum(workspace_.mesh.vertex_count(), [&](Index vertex) {
		const std::size_t i = at(vertex);
		const bool counts = !moves_.crosses[i].isZero(0) && (inner.empty() || inner[i] != 0);
		return counts ? value(i) : 0.0;
	});
}

double BroadDetail::share_followed(
	const std::vector<Point>& positions,
	const std::vector<Point>& probed,
	const std::vector<std::uint8_t>& inner) const
{
	const double kept = sum(inner, [&](std::size_t i) { return products(i)[1]; });
	const double followed = sum(inner, [&](std::size_t i) {
		if (!is_probed(i))
			return 0.0;
		const Point normal = moves_.crosses[i].normalized();
		const double response = (probed[i] - positions[i]).dot(normal) / (PROBE * sigma_);
		return kept_[i][1] * std::max(-LARGEST_RESPONSE, std::min(LARGEST_RESPONSE, response));
	});
	return kept > 0 ? std::max(0.0, std::min(1.0, followed / kept)) : 0;
}

BroadDetail::Products BroadDetail::products(std::size_t vertex) const
{
	const double kept = kept_[vertex][0];
	const double noise = is_probed(vertex) ? signs_[vertex] * kept_[vertex][1] : 0;
	return {moves_.lengths[vertex] * kept, noise, kept * kept};
}

BroadDetail::Mean BroadDetail::mean_of(const std::vector<std::uint8_t>& inner) const
{
	Mean mean = {Products::Zero(), sum(inner, [](std::size_t) { return 1.0; })};
	for (Eigen::Index k = 0; mean.count > 0 && k < mean.products.size(); ++k)
		mean.products[k] = sum(inner, [&](std::size_t i) { return products(i)[k]; }) / mean.count;
	return mean;
}

double BroadDetail::gain_for(const Products& products, double share_followed)
{
	return products[2] > 0 ? (products[0] - (1 - share_followed) * products[1]) / products[2] : 0;
}

double BroadDetail::certainty_of(const Mean& mean, double share_followed)
{
	const double chance = mean.count > 0 ? CHANCE / std::sqrt(mean.count) : 1;
	return way_between(
		GAIN_OF_NOISE + chance, GAIN_OF_DETAIL + chance, gain_for(mean.products, share_followed));
}

double BroadDetail::certainty(double share_followed, const std::vector<std::uint8_t>& inner) const
{
	return certainty_of(mean_of(inner), share_followed);
}

void BroadDetail::give_back(double share_followed, std::vector<Point>& positions) const
{
	const Mean all = mean_of({});
	const double certainty = certainty_of(all, share_followed);
	if (certainty == 0)
		return;
	std::vector<Products> means(positions.size());
	for (std::size_t i = 0; i < means.size(); ++i)
		means[i] = products(i);
	average(workspace_, AVERAGES, means);
	workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
		if (workspace_.mesh.is_fixed(static_cast<Index>(i)))
			return;
		const double gain = gain_for(means[i] + WEIGHT_OF_ALL * all.products, share_followed);
		positions[i] += certainty * std::max(0.0, std::min(LARGEST_GAIN, gain)) * kept_[i][0] *
						sigma_ * moves_.crosses[i].normalized();
	});
}

} // namespace orthopoly
