// SPDX-License-Identifier: GPL-3.0-or-later
#include "anisotropy.h"

#include "interpolation.h"
#include "prefilter.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace orthopoly {

namespace {

// Root mean square edge around a vertex over the edge of the equilateral triangles that noise tilts
// as much, from which triangles count as long and thin, and from which fully so: right triangles
// are at the first with sides of 1 and 1.8, at the second with 1 and 3.2.
constexpr double LONG_FROM = 1.3;
constexpr double LONG_FULLY = 2;

// Taubin pairs that bring out the shapes of the triangles.
constexpr double SMOOTHING_PAIRS = 12;

// Vertices within this share of the mean edge around are one place with a vertex.
constexpr double NEARBY = 0.5;

// No place grows by more steps from vertex to vertex, nor further once it has so many vertices.
constexpr int MOST_STEPS = 8;
constexpr std::size_t MANY_VERTICES = 64;

constexpr Index GRAIN = 1024;

double share_at(const Workspace& workspace, const std::vector<Point>& positions, Index vertex)
{
	const double steady = steady_edge_square_around(workspace, positions, vertex);
	const double square = mean_edge_square_around(workspace, positions, vertex);
	return steady > 0 ? way_between(LONG_FROM, LONG_FULLY, std::sqrt(square / steady)) : 0;
}

// Flags of the vertices among triangles that may be long and thin, and of those beside: noise hides
// some of them.
std::vector<std::uint8_t>
vertices_near_long_triangles(const Workspace& workspace, const std::vector<Point>& positions)
{
	const Index count = workspace.mesh.vertex_count();
	std::vector<std::uint8_t> among(at(count));
	workspace.execution.for_each(count, [&](std::size_t i) {
		const double share = share_at(workspace, positions, static_cast<Index>(i));
		among[i] = share > 0 ? 1 : 0;
	});
	std::vector<std::uint8_t> near(at(count), 0);
	workspace.execution.for_each(count, [&](std::size_t i) {
		const IndexLists& around = workspace.vertex_faces;
		const auto vertex = static_cast<Index>(i);
		for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it)
			for (const Index corner : workspace.mesh.faces[at(*it)])
				near[i] |= among[at(corner)];
	});
	return near;
}

template<class Value>
bool contains_nonzero(const std::vector<Value>& values)
{
	return std::any_of(values.begin(), values.end(), [](Value value) { return value != 0; });
}

/// Finds the vertices that are one place with a vertex. One a thread.
class PlaceFinder {
public:
	PlaceFinder(const Workspace& workspace, const Anisotropy& anisotropy) :
			workspace_(workspace), anisotropy_(anisotropy)
	{
	}

	/// Without itself, until the next time.
	const std::vector<Index>& find(Index vertex)
	{
		found_.clear();
		const double share = anisotropy_.shares[at(vertex)];
		if (share == 0)
			return found_;
		const double radius = share * NEARBY * mean_edge(vertex);
		// Step by step, so that where it ends does not depend on how the mesh is numbered.
		frontier_.assign(1, vertex);
		for (int step = 0; step < MOST_STEPS && found_.size() < MANY_VERTICES; ++step) {
			next_.clear();
			for (const Index from : frontier_)
				for_each_corner(from, [&](Index corner) {
					if (corner != vertex && distance_squared(vertex, corner) <= radius * radius &&
						std::find(found_.begin(), found_.end(), corner) == found_.end()) {
						found_.push_back(corner);
						next_.push_back(corner);
					}
				});
			frontier_.swap(next_);
		}
		std::sort(found_.begin(), found_.end());
		return found_;
	}

private:
	template<class Visit>
	void for_each_corner(Index vertex, Visit visit) const
	{
		const IndexLists& around = workspace_.vertex_faces;
		for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it) {
			for (const Index corner : workspace_.mesh.faces[at(*it)])
				visit(corner);
		}
	}

	double distance_squared(Index a, Index b) const
	{
		return (anisotropy_.smoothed[at(a)] - anisotropy_.smoothed[at(b)]).squaredNorm();
	}

	double mean_edge(Index vertex) const
	{
		const IndexLists& around = workspace_.vertex_faces;
		double sum = 0;
		for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it)
			sum += perimeter(anisotropy_.smoothed, workspace_.mesh.faces[at(*it)]);
		return sum / (3.0 * static_cast<double>(around.size(vertex)));
	}

	const Workspace& workspace_;
	const Anisotropy& anisotropy_;
	std::vector<Index> found_;
	std::vector<Index> frontier_;
	std::vector<Index> next_;
};

// The vertices of each place.
void find_places(const Workspace& workspace, Anisotropy& anisotropy)
{
	std::vector<PlaceFinder> finders(
		static_cast<std::size_t>(workspace.execution.threads()),
		PlaceFinder(workspace, anisotropy));
	const Index count = workspace.mesh.vertex_count();
	const auto for_each_place = [&](auto visit) {
		workspace.execution.parallel_for(count, GRAIN, [&](Index begin, Index end, int worker) {
			for (Index i = begin; i < end; ++i)
				visit(i, finders[at(worker)].find(i));
		});
	};
	// Found twice, first to count: cheaper than lists that grow.
	IndexLists& nearby = anisotropy.nearby;
	nearby.offsets.assign(at(count) + 1, 0);
	for_each_place([&](Index i, const std::vector<Index>& place) {
		nearby.offsets[at(i) + 1] = static_cast<Index>(place.size());
	});
	for (std::size_t i = 1; i < nearby.offsets.size(); ++i)
		nearby.offsets[i] += nearby.offsets[i - 1];
	nearby.values.resize(at(nearby.offsets.back()));
	for_each_place([&](Index i, const std::vector<Index>& place) {
		std::copy(place.begin(), place.end(), nearby.values.begin() + nearby.offsets[at(i)]);
	});
}

// Vertices next to each other along a row have about half of their faces in common.
double crowding_of(const Anisotropy& anisotropy)
{
	return 1 + 0.5 * static_cast<double>(anisotropy.nearby.values.size()) /
				   static_cast<double>(anisotropy.shares.size());
}

} // namespace

double steady_edge_square_around(
	const Workspace& workspace, const std::vector<Point>& positions, Index vertex)
{
	const IndexLists& around = workspace.vertex_faces;
	double sum = 0;
	double weights = 0;
	for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it) {
		const Face& face = workspace.mesh.faces[at(*it)];
		const double edges = edge_squares(positions, face);
		if (!(edges > 0))
			continue;
		// Twice the area.
		const double cross = face_cross_product(positions, face).norm();
		sum += cross * (4 * cross * cross / edges);
		weights += cross;
	}
	return weights > 0 ? sum / weights : 0;
}

Anisotropy find_anisotropy(const Workspace& workspace, const std::vector<Point>& positions)
{
	const Index count = workspace.mesh.vertex_count();
	Anisotropy result;
	const std::vector<std::uint8_t> near_long = vertices_near_long_triangles(workspace, positions);
	if (!contains_nonzero(near_long))
		return result;
	std::vector<Point> smoothed = positions;
	taubin_smooth(workspace, SMOOTHING_PAIRS, smoothed, near_long);
	std::vector<double> shares(at(count), 0);
	workspace.execution.for_each(count, [&](std::size_t i) {
		if (near_long[i] != 0)
			shares[i] = share_at(workspace, smoothed, static_cast<Index>(i));
	});
	if (!contains_nonzero(shares))
		return result;
	result.shares = std::move(shares);
	result.smoothed = std::move(smoothed);
	find_places(workspace, result);
	result.crowding = crowding_of(result);
	return result;
}

} // namespace orthopoly
