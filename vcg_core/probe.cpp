// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe.h"

#include "local_heights.h"
#include "sampling.h"

namespace orthopoly {

namespace {

// Deviations of the noise that the probe moves vertices by: enough that the method's choices, which
// jump, average out (with a tenth they scatter five times as much), and hardly more noise than is.
constexpr double PROBE = 0.5;

} // namespace

Probe::Probe(const Workspace& workspace, double sigma, const std::vector<Point>& positions) :
		workspace_(workspace), sigma_(sigma), normals_(positions.size(), Point::Zero()),
		signs_(signs_by_value(areas_around(workspace, workspace.mesh.positions)))
{
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const auto vertex = static_cast<Index>(i);
		const Point cross = cross_product_around(workspace, positions, vertex);
		const double length = cross.norm();
		if (length > 0)
			normals_[i] = cross / length;
		if (!(length > 0) || workspace.mesh.is_fixed(vertex))
			signs_[i] = 0;
	});
}

std::vector<Point> Probe::with_probe() const
{
	std::vector<Point> positions = workspace_.mesh.positions;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		if (signs_[i] != 0)
			positions[i] += PROBE * sigma_ * signs_[i] * normals_[i];
	}
	return positions;
}

std::vector<Point>
Probe::responses(const std::vector<Point>& positions, const std::vector<Point>& probed) const
{
	std::vector<Point> responses(positions.size());
	workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
		responses[i] = (probed[i] - positions[i]) / (PROBE * sigma_);
	});
	return responses;
}

} // namespace orthopoly
