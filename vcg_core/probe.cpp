// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe.h"

#include "local_heights.h"
#include "sampling.h"

#include <algorithm>

namespace orthopoly {

namespace {

// A response beyond so many times the probe is another choice of the method's, which says nothing.
constexpr double LARGEST_RESPONSE = 2;

} // namespace

Probe::Probe(
	const Workspace& workspace, const Deviations& noise, const std::vector<Point>& positions) :
		workspace_(workspace),
		noise_(noise), normals_(vertex_normals(workspace, positions)),
		signs_(signs_by_value(areas_around(workspace, workspace.mesh.positions)))
{
	for (std::size_t i = 0; i < signs_.size(); ++i) {
		if (normals_[i].isZero(0) || workspace.mesh.is_fixed(static_cast<Index>(i)))
			signs_[i] = 0;
	}
}

std::vector<Point> Probe::with_probe(const std::vector<Point>& positions) const
{
	std::vector<Point> probed = workspace_.mesh.positions;
	for (std::size_t i = 0; i < probed.size(); ++i) {
		if (signs_[i] == 0)
			continue;
		const double back = (positions[i] - probed[i]).dot(normals_[i]);
		probed[i] += (back + noise_[i] * signs_[i]) * normals_[i];
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
