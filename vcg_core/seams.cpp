// SPDX-License-Identifier: GPL-3.0-or-later
#include "seams.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <tuple>

namespace orthopoly {

namespace {

// For every vertex on an open edge the first such vertex at its place, for the others -1; empty
// where no two are at the same.
std::vector<Index>
places_of(const std::vector<Point>& positions, const std::vector<std::uint8_t>& boundary)
{
	std::vector<Index> open;
	for (std::size_t i = 0; i < boundary.size(); ++i) {
		if (boundary[i] != 0)
			open.push_back(static_cast<Index>(i));
	}
	std::sort(open.begin(), open.end(), [&](Index a, Index b) {
		const Point& left = positions[at(a)];
		const Point& right = positions[at(b)];
		return left == right ? a < b : comes_before(left, right);
	});
	std::vector<Index> places(positions.size(), -1);
	bool any_shared = false;
	for (std::size_t k = 0; k < open.size(); ++k) {
		const bool shared = k > 0 && positions[at(open[k])] == positions[at(open[k - 1])];
		places[at(open[k])] = shared ? places[at(open[k - 1])] : open[k];
		any_shared |= shared;
	}
	if (!any_shared)
		places.clear();
	return places;
}

// An edge that belongs to one face only.
struct OpenEdge {
	// Places of its ends, in ascending order, and the vertices there.
	std::array<Index, 2> places;
	std::array<Index, 2> ends;
	// The corner of its face that is not on it.
	Index opposite;

	bool operator<(const OpenEdge& other) const
	{
		return std::tie(places, ends, opposite) <
			   std::tie(other.places, other.ends, other.opposite);
	}
};

bool is_open(const TriangleMesh& mesh, const IndexLists& around, Index a, Index b)
{
	return std::count_if(around.begin(a), around.end(a), [&](Index i) {
			   const Face& face = mesh.faces[at(i)];
			   return has_three_vertices(face) &&
					  std::find(face.begin(), face.end(), b) != face.end();
		   }) == 1;
}

std::vector<OpenEdge>
open_edges(const TriangleMesh& mesh, const IndexLists& around, const std::vector<Index>& places)
{
	std::vector<OpenEdge> edges;
	for (const Face& face : mesh.faces) {
		for (std::size_t k = 0; k < 3 && has_three_vertices(face); ++k) {
			std::array<Index, 2> ends = {face[k], face[(k + 1) % 3]};
			if (places[at(ends[0])] > places[at(ends[1])])
				std::swap(ends[0], ends[1]);
			const std::array<Index, 2> at_places = {places[at(ends[0])], places[at(ends[1])]};
			// An edge without length would make one of its ends, and so of its face's corners.
			if (at_places[0] < 0 || at_places[0] == at_places[1] ||
				!is_open(mesh, around, ends[0], ends[1]))
				continue;
			edges.push_back({at_places, ends, face[(k + 2) % 3]});
		}
	}
	std::sort(edges.begin(), edges.end());
	return edges;
}

// Sets of vertices, each known by its first.
class VertexSets {
public:
	explicit VertexSets(std::size_t vertex_count) : parents_(vertex_count)
	{
		std::iota(parents_.begin(), parents_.end(), Index(0));
	}

	Index first_of(Index vertex)
	{
		while (parents_[at(vertex)] != vertex) {
			parents_[at(vertex)] = parents_[at(parents_[at(vertex)])];
			vertex = parents_[at(vertex)];
		}
		return vertex;
	}

	void unite(Index a, Index b)
	{
		const Index a_first = first_of(a);
		const Index b_first = first_of(b);
		parents_[at(std::max(a_first, b_first))] = std::min(a_first, b_first);
	}

private:
	std::vector<Index> parents_;
};

} // namespace

Seams find_seams(const TriangleMesh& mesh, const IndexLists& around, const EdgeDefects& edges)
{
	Seams seams;
	const std::vector<Index> places = places_of(mesh.positions, edges.boundary);
	if (places.empty())
		return seams;
	const std::vector<OpenEdge> open = open_edges(mesh, around, places);
	VertexSets sets(mesh.positions.size());
	for (std::size_t k = 0; k < open.size();) {
		std::size_t next = k + 1;
		while (next < open.size() && open[next].places == open[k].places)
			++next;
		const bool are_two_sides = next - k == 2 && mesh.positions[at(open[k].opposite)] ==
														mesh.positions[at(open[k + 1].opposite)];
		for (std::size_t other = k + 1; other < next && !are_two_sides; ++other) {
			for (std::size_t end = 0; end < 2; ++end)
				sets.unite(open[k].ends[end], open[other].ends[end]);
		}
		k = next;
	}
	seams.vertices.reserve(mesh.positions.size());
	for (Index i = 0; i < mesh.vertex_count(); ++i) {
		const Index first = sets.first_of(i);
		seams.vertices.push_back(first < i ? seams.vertices[at(first)] : i - seams.repeated);
		seams.repeated += first < i ? 1 : 0;
	}
	return seams;
}

Seams find_seams(const TriangleMesh& mesh)
{
	Progress silent;
	Execution execution(1, silent);
	const IndexLists around = vertex_faces(mesh.vertex_count(), mesh.faces);
	return find_seams(mesh, around, find_edge_defects(mesh.faces, around, execution));
}

TriangleMesh sew(const TriangleMesh& mesh, const Seams& seams)
{
	TriangleMesh sewn;
	sewn.positions.resize(mesh.positions.size() - at(seams.repeated));
	if (!mesh.fixed.empty())
		sewn.fixed.resize(sewn.positions.size(), 0);
	for (Index i = 0; i < mesh.vertex_count(); ++i) {
		sewn.positions[at(seams.sewn(i))] = mesh.positions[at(i)];
		if (mesh.is_fixed(i))
			sewn.fixed[at(seams.sewn(i))] = 1;
	}
	sewn.faces.reserve(mesh.faces.size());
	for (const Face& face : mesh.faces)
		sewn.faces.push_back({seams.sewn(face[0]), seams.sewn(face[1]), seams.sewn(face[2])});
	return sewn;
}

} // namespace orthopoly
