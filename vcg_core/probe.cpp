// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe.h"

#include "local_heights.h"
#include "moves.h"
#include "sampling.h"

#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// A response beyond so many times the probe is another choice of the method's, which says nothing.
constexpr double LARGEST_RESPONSE = 2;

// How far an average moves a value to the mean around it: it raises the correlation over an edge by
// some hundredths. And how many there are at most: noise that goes together as that of
// reconstructions does takes some twenty.
constexpr double AVERAGE_SHARE = 0.15;
constexpr int MOST_AVERAGES = 200;

double edge_correlation_of(const Workspace& workspace, const std::vector<double>& values)
{
	const double squares = sum_over_edges(workspace, [&](std::size_t a, std::size_t b) {
		return (values[a] * values[a] + values[b] * values[b]) / 2;
	});
	const double products = sum_over_edges(
		workspace, [&](std::size_t a, std::size_t b) { return values[a] * values[b]; });
	return squares > 0 ? products / squares : 1;
}

// Averages values until they go together so far over an edge, and scales them to a mean square of
// 1; zeros stay.
void correlate(const Workspace& workspace, double correlation, std::vector<double>& values)
{
	const std::vector<double> drawn = values;
	for (int k = 0; k < MOST_AVERAGES && edge_correlation_of(workspace, values) < correlation;
		 ++k) {
		std::vector<double> means = values;
		average(workspace, 1, means);
		workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
			if (drawn[i] != 0)
				values[i] += AVERAGE_SHARE * (means[i] - values[i]);
		});
	}
	double squares = 0;
	double count = 0;
	for (std::size_t i = 0; i < values.size(); ++i) {
		squares += values[i] * values[i];
		count += drawn[i] != 0 ? 1 : 0;
	}
	if (!(squares > 0))
		return;
	const double scale = std::sqrt(count / squares);
	for (double& value : values)
		value *= scale;
}

} // namespace

Probe::Probe(
	const Workspace& workspace,
	const Deviations& noise,
	const std::vector<Point>& positions,
	double edge_correlation) :
		workspace_(workspace),
		noise_(noise), normals_(vertex_normals(workspace, positions)),
		draws_(signs_by_value(areas_around(workspace, workspace.mesh.positions))),
		is_white_(!(edge_correlation > 0))
{
	for (std::size_t i = 0; i < draws_.size(); ++i) {
		if (normals_[i].isZero(0) || workspace.mesh.is_fixed(static_cast<Index>(i)))
			draws_[i] = 0;
	}
	if (!is_white_)
		correlate(workspace, edge_correlation, draws_);
}

std::vector<Point> Probe::with_probe(const std::vector<Point>& positions) const
{
	std::vector<Point> probed = workspace_.mesh.positions;
	for (std::size_t i = 0; i < probed.size(); ++i) {
		if (draws_[i] == 0)
			continue;
		const double back = (positions[i] - probed[i]).dot(normals_[i]);
		probed[i] += (back + noise_[i] * draws_[i]) * normals_[i];
	}
	return probed;
}

std::vector<Point>
Probe::responses(const std::vector<Point>& positions, const std::vector<Point>& probed) const
{
	std::vector<Point> responses(positions.size());
	workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
		responses[i] = (probed[i] - positions[i]) / noise_.overall();
	});
	return responses;
}

double Probe::bounded_response(const std::vector<Point>& responses, std::size_t vertex) const
{
	const double response = responses[vertex].dot(normals_[vertex]);
	const double largest = LARGEST_RESPONSE * noise_.factor(vertex);
	return std::max(-largest, std::min(largest, response));
}

} // namespace orthopoly
