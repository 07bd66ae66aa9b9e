// SPDX-License-Identifier: GPL-3.0-or-later
#include "prefilter.h"

#include "interpolation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace orthopoly {

namespace {

constexpr Index GRAIN = 2048;

// No neighbour counts as nearer than this, over the mean edge around, both squared.
constexpr double LEAST_DISTANCE = 1e-4;

// The way from a vertex on an open boundary to the middle between those next to it there; zero
// where these are not two.
Point way_into_outline(
	const Workspace& workspace, const std::vector<Point>& positions, Index vertex)
{
	const Index* const begin = workspace.vertex_faces.begin(vertex);
	const Index* const end = workspace.vertex_faces.end(vertex);
	Point sum = Point::Zero();
	int found = 0;
	for (const Index* it = begin; it != end; ++it) {
		for (const Index corner : workspace.mesh.faces[at(*it)]) {
			const auto shared = std::count_if(begin, end, [&](Index other) {
				const Face& face = workspace.mesh.faces[at(other)];
				return std::find(face.begin(), face.end(), corner) != face.end();
			});
			if (corner == vertex || shared != 1)
				continue;
			sum += positions[at(corner)] - positions[at(vertex)];
			++found;
		}
	}
	return found == 2 ? Point(sum / 2) : Point(Point::Zero());
}

/// Ways to the neighbours, weighed and summed up, and the weights.
struct WeighedWays {
	Point sum;
	double weights;
};

// Each weighed by the faces shared, and nearer ones more.
WeighedWays ways_near_first(
	const Workspace& workspace,
	const NearFirst& near_first,
	const std::vector<Point>& positions,
	Index vertex)
{
	const double share = near_first.shares[at(vertex)];
	const Point& from = near_first.positions[at(vertex)];
	const double square = mean_edge_square_around(workspace, near_first.positions, vertex);
	WeighedWays ways = {Point::Zero(), 0};
	const Index* const end = workspace.vertex_faces.end(vertex);
	for (const Index* it = workspace.vertex_faces.begin(vertex); it != end; ++it) {
		for (const Index corner : workspace.mesh.faces[at(*it)]) {
			if (corner == vertex)
				continue;
			const double distance = (near_first.positions[at(corner)] - from).squaredNorm();
			const double near = square / std::max(distance, LEAST_DISTANCE * square);
			const double weight = between(1, near, share);
			ways.sum += weight * (positions[at(corner)] - positions[at(vertex)]);
			ways.weights += weight;
		}
	}
	return ways;
}

WeighedWays ways_around(
	const Workspace& workspace,
	const NearFirst* near_first,
	const std::vector<Point>& positions,
	Index vertex)
{
	if (near_first != nullptr && near_first->shares[at(vertex)] > 0)
		return ways_near_first(workspace, *near_first, positions, vertex);
	return {
		sum_of_ways_around(workspace, positions, vertex),
		2.0 * static_cast<double>(workspace.vertex_faces.size(vertex))};
}

// Where an umbrella step takes a vertex: to the mean of the neighbours.
Point umbrella(
	const Workspace& workspace,
	const NearFirst* near_first,
	double step,
	bool turned_over,
	const std::vector<Point>& positions,
	Index vertex)
{
	const Point& here = positions[at(vertex)];
	if (workspace.vertex_faces.size(vertex) == 0 || workspace.mesh.is_fixed(vertex))
		return here;
	const bool on_boundary = workspace.edges.irregular[at(vertex)] != 0;
	const WeighedWays ways = ways_around(workspace, near_first, positions, vertex);
	Point sum = ways.sum;
	// Neighbours on one side only would pull the outline inwards.
	if (on_boundary) {
		const Point normal = cross_product_around(workspace, positions, vertex);
		sum = normal.isZero(0) ? normal : Point(normal.dot(sum) / normal.squaredNorm() * normal);
	}
	Point moved = ways.weights > 0 ? Point(here + step / ways.weights * sum) : here;
	if (on_boundary && turned_over)
		moved += step * way_into_outline(workspace, positions, vertex);
	return moved;
}

// A step of some of the vertices: vertex k of them goes `length_of(k)`.
template<class LengthOf>
void umbrella_step(
	const Workspace& workspace,
	const NearFirst* near_first,
	const std::vector<Index>& vertices,
	const std::vector<std::uint8_t>& flags,
	const LengthOf& length_of,
	std::vector<Point>& positions)
{
	std::vector<Point> moved(vertices.size());
	const auto count = static_cast<Index>(vertices.size());
	workspace.execution.for_each(count, [&](std::size_t k) {
		const bool turned_over = !flags.empty() && flags[at(vertices[k])] == TURNED_OVER;
		moved[k] =
			umbrella(workspace, near_first, length_of(k), turned_over, positions, vertices[k]);
	});
	workspace.execution.for_each(
		count, [&](std::size_t k) { positions[at(vertices[k])] = moved[k]; });
}

} // namespace

void taubin_smooth(
	const Workspace& workspace,
	double pairs,
	std::vector<Point>& positions,
	const std::vector<std::uint8_t>& only)
{
	std::vector<Index> vertices;
	for (Index i = 0; i < workspace.mesh.vertex_count(); ++i) {
		if (only.empty() || only[at(i)] != 0)
			vertices.push_back(i);
	}
	for (double left = pairs; left > 0; left -= 1) {
		const double share = std::min(1.0, left);
		for (const double step : {TAUBIN_SHRINK, TAUBIN_INFLATE})
			umbrella_step(
				workspace,
				nullptr,
				vertices,
				only,
				[=](std::size_t) { return share * step; },
				positions);
	}
}

void taubin_smooth(
	const Workspace& workspace,
	const std::vector<double>& pairs,
	std::vector<Point>& positions,
	const NearFirst* near_first)
{
	std::vector<Index> vertices(positions.size());
	std::iota(vertices.begin(), vertices.end(), 0);
	for (double done = 0;; done += 1) {
		const auto is_done = [&](Index i) { return !(pairs[at(i)] > done); };
		vertices.erase(std::remove_if(vertices.begin(), vertices.end(), is_done), vertices.end());
		if (vertices.empty())
			return;
		for (const double step : {TAUBIN_SHRINK, TAUBIN_INFLATE})
			umbrella_step(
				workspace,
				near_first,
				vertices,
				{},
				[&](std::size_t k) { return std::min(1.0, pairs[at(vertices[k])] - done) * step; },
				positions);
	}
}

std::vector<std::uint8_t> folded_vertices(
	const Workspace& workspace, const std::vector<Point>& positions, const FoldCriterion& criterion)
{
	const std::vector<Face>& faces = workspace.mesh.faces;
	const IndexLists& around = workspace.vertex_faces;
	const std::vector<Point> sums = cross_products_around(workspace, positions);
	std::vector<std::uint8_t> folded(faces.size(), 0);
	workspace.execution.parallel_for(
		workspace.mesh.face_count(), GRAIN, [&](Index begin, Index end, int) {
			for (std::size_t k = at(begin); k < at(end); ++k) {
				const Face& face = faces[k];
				const Point cross = face_cross_product(positions, face);
				double longest = 0;
				const Point surroundings = cross_product_beside(face, cross, sums);
				for (std::size_t corner = 0; corner < 3; ++corner) {
					const Point& here = positions[at(face[corner])];
					const Point& next = positions[at(face[(corner + 1) % 3])];
					longest = std::max(longest, (next - here).norm());
				}
				const double length = cross.norm();
				const double along = cross.dot(surroundings);
				if (length <= criterion.height * longest &&
					along < criterion.cosine * length * surroundings.norm())
					folded[k] = along < 0 ? TURNED_OVER : TURNED_AWAY;
			}
		});
	std::vector<std::uint8_t> flags(positions.size(), 0);
	workspace.execution.parallel_for(
		workspace.mesh.vertex_count(), GRAIN, [&](Index begin, Index end, int) {
			for (Index i = begin; i < end; ++i)
				for (const Index* it = around.begin(i); it != around.end(i); ++it)
					flags[at(i)] = std::max(flags[at(i)], folded[at(*it)]);
		});
	return flags;
}

} // namespace orthopoly
