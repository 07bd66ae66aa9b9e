// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_level.h"

#include "local_heights.h"
#include "sampling.h"

#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

/// A share of the residual variances and the same quantile of the normal distribution.
struct Quantile {
	double share;
	double normal;
};

// The share that is taken as free of features, which only ever add to the variances: low for coarse
// meshes with few flat places, but not so low that it is ruled by the tail of noise that is not
// Gaussian.
constexpr Quantile FLAT = {0.2, -0.8416};

// And one at which there are outliers among the neighbours.
constexpr Quantile ORDINARY = {0.5, 0};

// The quantile of so many variances is steady to about one per cent.
constexpr Index SAMPLES = 20000;

// Polynomials that tell the kind of noise: wide ones, since narrow ones follow an outlier, and a
// few, since they are slow.
constexpr int WIDE_RINGS = 4;
constexpr std::size_t WIDE_SAMPLES = 500;

constexpr Index GRAIN = 64;

// Rings of vertices of a polynomial.
constexpr int RINGS = 2;

// How noise across the normals lengthens edges, per square of it in edge lengths: an edge takes
// half of the noise of both ends across itself, 2 / 2, and a little more in the next order.
constexpr double LENGTHENING = 1.2;

// The quantile of the mean of squares over so many degrees of freedom, for noise of variance one
// (Wilson and Hilferty 1931).
double quantile_of_variance(const Quantile& quantile, double free)
{
	const double spread = 2 / (9 * free);
	return std::pow(1 - spread + quantile.normal * std::sqrt(spread), 3);
}

// The mean edge length of the surface below the noise, whose deviation along the normals is given
// in the caller's length unit.
//
// Smoothing takes the noise out of the edges, but evens irregular triangles out and shortens the
// mean so. The noisy edges without their part along the normals keep the irregularity, and the
// noise across the normals, if there is any, lengthens them. Both err to one side then, if the
// latter are shortened by what noise in all directions would lengthen them.
double clean_edge_length(
	const Workspace& workspace,
	const std::vector<Point>& noisy,
	const std::vector<Point>& smooth,
	double sigma)
{
	std::vector<Point> flattened = noisy;
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const Point normal = cross_product_around(workspace, smooth, static_cast<Index>(i));
		const double square = normal.squaredNorm();
		if (square > 0)
			flattened[i] += (smooth[i] - noisy[i]).dot(normal) / square * normal;
	});
	const double smoothed = mean_edge_length(workspace, smooth);
	if (!(smoothed > 0))
		return 0;
	const double relative = sigma / smoothed;
	return std::max(
		smoothed, mean_edge_length(workspace, flattened) / (1 + LENGTHENING * relative * relative));
}

} // namespace

NoiseLevels estimate_noise_levels(const Workspace& workspace, const std::vector<Point>& positions)
{
	const std::vector<Point> smooth = surface_below_heights(workspace, positions);
	const std::vector<Index> sample = sample_by_value(areas_around(workspace, positions), SAMPLES);
	struct Variance {
		double value = -1;
		double free = 0;
	};
	std::vector<Variance> variances(sample.size());
	std::vector<LocalHeights> heights(
		static_cast<std::size_t>(workspace.execution.threads()),
		LocalHeights(workspace, positions, smooth));
	workspace.execution.parallel_for(
		static_cast<Index>(sample.size()), GRAIN, [&](Index begin, Index end, int worker) {
			LocalHeights& local = heights[static_cast<std::size_t>(worker)];
			for (Index i = begin; i < end; ++i) {
				const auto at = static_cast<std::size_t>(i);
				if (local.fit(sample[at], RINGS))
					variances[at] = {local.variance(), local.free()};
			}
		});
	const std::size_t every = std::max<std::size_t>(1, sample.size() / WIDE_SAMPLES);
	std::vector<double> ratios(sample.size() / every, -1);
	workspace.execution.parallel_for(
		static_cast<Index>(ratios.size()), 4, [&](Index begin, Index end, int worker) {
			LocalHeights& local = heights[static_cast<std::size_t>(worker)];
			for (Index i = begin; i < end; ++i) {
				const auto at = static_cast<std::size_t>(i);
				if (local.fit(sample[every * at], WIDE_RINGS))
					ratios[at] = local.median_ratio();
			}
		});
	ratios.erase(std::remove(ratios.begin(), ratios.end(), -1), ratios.end());
	const auto level = [&](const Quantile& wanted) {
		std::vector<double> values;
		for (const Variance& variance : variances) {
			if (variance.value >= 0)
				values.push_back(variance.value / quantile_of_variance(wanted, variance.free));
		}
		return std::sqrt(quantile(values, wanted.share));
	};
	NoiseLevels result;
	if (!ratios.empty())
		result.median_ratio = quantile(ratios, 0.5);
	const double flat = level(FLAT);
	const double length = clean_edge_length(workspace, positions, smooth, flat);
	if (length > 0) {
		result.flat = flat / length;
		result.ordinary = level(ORDINARY) / length;
	}
	return result;
}

double estimate_noise_level(const Workspace& workspace, const std::vector<Point>& positions)
{
	return estimate_noise_levels(workspace, positions).flat;
}

} // namespace orthopoly
