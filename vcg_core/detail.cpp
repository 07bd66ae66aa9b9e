// SPDX-License-Identifier: GPL-3.0-or-later
#include "detail.h"

#include "interpolation.h"
#include "local_heights.h"
#include "sampling.h"

#include <algorithm>
#include <cstddef>

namespace orthopoly {

namespace {

// Averages over vertices and their neighbours, one after the other: together a mean over some forty
// vertices, which noise alone makes vary by a quarter.
constexpr int AVERAGES = 8;

// Noise variances below which moves are taken for noise alone: more than four times that beyond
// one, so that in a million vertices few are not.
constexpr double MARGIN = 2.1;

// Squares count up to so many noise variances, so that a vertex far off, be it an outlier or moved
// on purpose, does not make its surroundings detail.
constexpr double LARGEST = 9;

// Rings of vertices whose median distance is the ordinary one around a vertex.
constexpr int RINGS = 2;

// Ordinary distances up to which a vertex is no outlier, and from which it is taken for one.
constexpr double INLYING = 2.2;
constexpr double OUTLYING = 3.7;

// An ordinary distance counts within these bounds, in mean edge lengths: where many have been moved
// far, outliers are among them that nobody found.
constexpr double LEAST_DISTANCE = 1e-3;
constexpr double LARGEST_DISTANCE = 0.035;

constexpr Index GRAIN = 256;

std::size_t at(Index index)
{
	return static_cast<std::size_t>(index);
}

// Squares of how far vertices were moved along their normals, as far as they count.
std::vector<double>
squared_moves(const Workspace& workspace, double largest, const std::vector<Point>& positions)
{
	std::vector<double> squares(positions.size(), 0.0);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const Point normal = cross_product_around(workspace, positions, static_cast<Index>(i));
		const double length = normal.squaredNorm();
		if (!(length > 0))
			return;
		const double move = (workspace.mesh.positions[i] - positions[i]).dot(normal);
		squares[i] = std::min(largest, move * move / length);
	});
	return squares;
}

// Takes means over each vertex and its neighbours, these weighed by the faces shared, so many
// times.
void average(const Workspace& workspace, int times, std::vector<double>& values)
{
	const std::vector<Face>& faces = workspace.mesh.faces;
	const IndexLists& around = workspace.vertex_faces;
	std::vector<double> sums(faces.size());
	for (int k = 0; k < times; ++k) {
		workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
			const Face& face = faces[i];
			sums[i] = values[at(face[0])] + values[at(face[1])] + values[at(face[2])];
		});
		workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
			const auto vertex = static_cast<Index>(i);
			const Index count = around.size(vertex);
			if (count == 0)
				return;
			double sum = 0;
			for (const Index* face = around.begin(vertex); face != around.end(vertex); ++face)
				sum += sums[at(*face)];
			values[i] = sum / (3.0 * static_cast<double>(count));
		});
	}
}

// The share of a variance that noise of another does not account for.
double share_of_detail(double noise, double variance)
{
	return variance > MARGIN * noise ? 1 - MARGIN * noise / variance : 0;
}

// Takes a vertex a share of the way back to where it was measured.
void give_back(
	const Workspace& workspace, std::size_t i, double share, std::vector<Point>& positions)
{
	if (share > 0 && !workspace.mesh.is_fixed(static_cast<Index>(i)))
		positions[i] += share * (workspace.mesh.positions[i] - positions[i]);
}

} // namespace

void give_back_detail(
	const Workspace& workspace, double sigma, double most, std::vector<Point>& positions)
{
	const double variance = sigma * sigma;
	std::vector<double> squares = squared_moves(workspace, LARGEST * variance, positions);
	average(workspace, AVERAGES, squares);
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		give_back(workspace, i, most * share_of_detail(variance, squares[i]), positions);
	});
}

void give_back_inliers(
	const Workspace& workspace, double sigma, double most, std::vector<Point>& positions)
{
	const double edge = workspace.mean_edge_length;
	std::vector<double> distances(positions.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		distances[i] = (workspace.mesh.positions[i] - positions[i]).norm();
	});
	std::vector<VertexRings> rings(
		static_cast<std::size_t>(workspace.execution.threads()), VertexRings(workspace));
	workspace.execution.parallel_for(
		workspace.mesh.vertex_count(), GRAIN, [&](Index begin, Index end, int worker) {
			VertexRings& ring = rings[static_cast<std::size_t>(worker)];
			std::vector<double> around;
			for (Index i = begin; i < end; ++i) {
				ring.collect(i, RINGS);
				around.clear();
				for (const Index j : ring.vertices())
					around.push_back(distances[at(j)]);
				const double ordinary = std::min(
					LARGEST_DISTANCE * edge,
					std::max(LEAST_DISTANCE * edge, quantile(around, 0.5)));
				const double inlying = way_between(OUTLYING, INLYING, distances[at(i)] / ordinary);
				const double deviation = DEVIATION_PER_MEDIAN * ordinary;
				const double detail = share_of_detail(sigma * sigma, deviation * deviation);
				give_back(workspace, at(i), most * inlying * detail, positions);
			}
		});
}

} // namespace orthopoly
