// SPDX-License-Identifier: GPL-3.0-or-later
#include "prefilter.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

namespace orthopoly {

namespace {

constexpr Index GRAIN = 2048;

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

// Where an umbrella step takes a vertex: to the mean of the neighbours, each weighed by the faces
// shared.
Point umbrella(
	const Workspace& workspace,
	double step,
	bool turned_over,
	const std::vector<Point>& positions,
	Index vertex)
{
	const Point& here = positions[at(vertex)];
	const Index count = workspace.vertex_faces.size(vertex);
	if (count == 0 || workspace.mesh.is_fixed(vertex))
		return here;
	const bool on_boundary = workspace.edges.irregular[at(vertex)] != 0;
	Point sum = sum_of_ways_around(workspace, positions, vertex);
	// Neighbours on one side only would pull the outline inwards.
	if (on_boundary) {
		const Point normal = cross_product_around(workspace, positions, vertex);
		sum = normal.isZero(0) ? normal : Point(normal.dot(sum) / normal.squaredNorm() * normal);
	}
	Point moved = here + step / (2.0 * static_cast<double>(count)) * sum;
	if (on_boundary && turned_over)
		moved += step * way_into_outline(workspace, positions, vertex);
	return moved;
}

// A step of some of the vertices: vertex k of them goes `length_of(k)`.
template<class LengthOf>
void umbrella_step(
	const Workspace& workspace,
	const std::vector<Index>& vertices,
	const std::vector<std::uint8_t>& flags,
	const LengthOf& length_of,
	std::vector<Point>& positions)
{
	std::vector<Point> moved(vertices.size());
	const auto count = static_cast<Index>(vertices.size());
	workspace.execution.for_each(count, [&](std::size_t k) {
		const bool turned_over = !flags.empty() && flags[at(vertices[k])] == TURNED_OVER;
		moved[k] = umbrella(workspace, length_of(k), turned_over, positions, vertices[k]);
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
				workspace, vertices, only, [=](std::size_t) { return share * step; }, positions);
	}
}

void taubin_smooth(
	const Workspace& workspace, const std::vector<double>& pairs, std::vector<Point>& positions)
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
