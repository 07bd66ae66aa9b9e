// SPDX-License-Identifier: GPL-3.0-or-later
#include "moves.h"

#include "local_heights.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace orthopoly {

namespace {

constexpr double LARGEST_MOVE = 3;

// Vertices whose faces' normals add up to less than this (as two at 64 degrees do) lie on an edge.
// Those slide along it, which no normal of theirs tells.
constexpr double EDGE = 0.85;

} // namespace

Moves moves_along_normals(
	const Workspace& workspace, const Deviations& sigma, const std::vector<Point>& positions)
{
	Moves moves {
		std::vector<double>(positions.size(), 0.0),
		std::vector<Point>(positions.size(), Point::Zero())};
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const Point cross = cross_product_around(workspace, positions, static_cast<Index>(i));
		const double length = cross.norm();
		if (!(length > 0))
			return;
		moves.crosses[i] = cross;
		const Point normal = cross / length;
		const double move = (workspace.mesh.positions[i] - positions[i]).dot(normal) / sigma[i];
		moves.lengths[i] = std::max(-LARGEST_MOVE, std::min(LARGEST_MOVE, move));
	});
	return moves;
}

Moves moves_beside_edges(
	const Workspace& workspace, const Deviations& sigma, const std::vector<Point>& positions)
{
	Moves moves = moves_along_normals(workspace, sigma, positions);
	const std::vector<double> areas = areas_around(workspace, positions);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		if (moves.crosses[i].norm() < EDGE * areas[i])
			moves.lengths[i] = 0;
	});
	return moves;
}

double share_beyond(double noise, double square)
{
	return square > noise ? 1 - noise / square : 0;
}

void give_back(
	const Workspace& workspace, std::size_t vertex, double share, std::vector<Point>& positions)
{
	if (share > 0 && !workspace.mesh.is_fixed(static_cast<Index>(vertex)))
		positions[vertex] += share * (workspace.mesh.positions[vertex] - positions[vertex]);
}

std::vector<double>
mean_squares(const Workspace& workspace, int times, const std::vector<double>& values)
{
	std::vector<double> squares = values;
	for (double& value : squares)
		value *= value;
	average(workspace, times, squares);
	return squares;
}

} // namespace orthopoly
