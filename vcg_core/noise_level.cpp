// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_level.h"

#include "local_heights.h"
#include "prefilter.h"
#include "sampling.h"

#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// The share of the residual variances that is taken as free of features, which only ever add to
// them.
constexpr double QUANTILE = 0.35;

// Root of that quantile of chi-square over nine degrees of freedom (a 2-ring of 19 vertices), over
// its mean.
constexpr double QUANTILE_RATIO = 0.89;

// The quantile of so many variances is steady to about one per cent.
constexpr Index SAMPLES = 20000;

// Taubin pairs after which the normals of a mesh with noise of half an edge length are steady.
constexpr double SMOOTHING_PAIRS = 4;

constexpr Index GRAIN = 64;

// Rings of vertices of a polynomial.
constexpr int RINGS = 2;

} // namespace

double estimate_noise_level(const Workspace& workspace, const std::vector<Point>& positions)
{
	std::vector<Point> smooth = positions;
	taubin_smooth(workspace, SMOOTHING_PAIRS, smooth);
	const std::vector<Index> sample = sample_by_value(areas_around(workspace, positions), SAMPLES);
	std::vector<double> variances(sample.size());
	std::vector<LocalHeights> heights(
		static_cast<std::size_t>(workspace.execution.threads()),
		LocalHeights(workspace, positions, smooth));
	workspace.execution.parallel_for(
		static_cast<Index>(sample.size()), GRAIN, [&](Index begin, Index end, int worker) {
			LocalHeights& local = heights[static_cast<std::size_t>(worker)];
			for (Index i = begin; i < end; ++i) {
				const auto at = static_cast<std::size_t>(i);
				variances[at] = local.fit(sample[at], RINGS) ? local.variance() : -1;
			}
		});
	variances.erase(
		std::remove_if(variances.begin(), variances.end(), [](double v) { return v < 0; }),
		variances.end());
	// Noise lengthens the edges: those of the smoothed mesh are closer to the true ones.
	const double length = mean_edge_length(smooth, workspace.mesh.faces);
	return length > 0 ? std::sqrt(quantile(variances, QUANTILE)) / (QUANTILE_RATIO * length) : 0;
}

} // namespace orthopoly
