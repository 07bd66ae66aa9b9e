// SPDX-License-Identifier: GPL-3.0-or-later
#include "broad_detail.h"

#include "interpolation.h"
#include "local_heights.h"

#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// Pairs of the filter, which keep a ninth of the noise. Five keep a third of it, and of the detail
// not more by as much; 40 less of the detail.
constexpr int PAIRS = 30;

// What a method follows of the noise of a mesh, over what it follows on its own result, which lacks
// the detail that it took.
constexpr double OF_MESH = 1.1;

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

// And by this where every vertex has a level of its own, which are less well known: noise higher
// than thought by a seventh makes as much of a gain.
constexpr double GAIN_OF_UNKNOWN = 0.25;

} // namespace

BroadDetail::BroadDetail(
	const Workspace& workspace, const Probe& probe, const std::vector<Point>& positions) :
		workspace_(workspace),
		probe_(probe), moves_(moves_beside_edges(workspace, probe.noise(), positions)),
		kept_(positions.size())
{
	for (std::size_t i = 0; i < kept_.size(); ++i)
		kept_[i] = {moves_.lengths[i], probe.draws()[i]};
	low_pass(workspace, PAIRS, kept_);
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
	const std::vector<Point>& responses, const std::vector<std::uint8_t>& inner) const
{
	const double kept = sum(inner, [&](std::size_t i) { return products(i)[1]; });
	const double followed = sum(inner, [&](std::size_t i) {
		return is_probed(i) ?
				   kept_[i][1] * probe_.bounded_response(responses, i) / probe_.noise().factor(i) :
				   0.0;
	});
	return kept > 0 ? std::max(0.0, std::min(1.0, OF_MESH * followed / kept)) : 0;
}

BroadDetail::Products BroadDetail::products(std::size_t vertex) const
{
	const double kept = kept_[vertex][0];
	const double noise = is_probed(vertex) ? probe_.draws()[vertex] * kept_[vertex][1] : 0;
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

double BroadDetail::certainty_of(const Mean& mean, double share_followed) const
{
	const double chance = mean.count > 0 ? CHANCE / std::sqrt(mean.count) : 1;
	const double unknown = chance + (probe_.noise().differ() ? GAIN_OF_UNKNOWN : 0);
	return way_between(
		GAIN_OF_NOISE + unknown, GAIN_OF_DETAIL + unknown, gain_for(mean.products, share_followed));
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
						probe_.noise()[i] * probe_.normals()[i];
	});
}

} // namespace orthopoly
