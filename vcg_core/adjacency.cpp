// SPDX-License-Identifier: GPL-3.0-or-later
#include "adjacency.h"

#include <algorithm>
#include <tuple>

namespace orthopoly {

namespace {

std::size_t at(Index index)
{
	return static_cast<std::size_t>(index);
}

// A face that names a vertex twice counts once around it.
bool first_mention(const Face& face, std::size_t k)
{
	return (k == 0 || face[k] != face[0]) && (k != 2 || face[2] != face[1]);
}

// An edge as one of its faces runs along it: its ends in ascending order, and whether they were
// swapped.
struct DirectedEdge {
	Index low;
	Index high;
	bool swapped;

	bool same_ends(const DirectedEdge& other) const
	{
		return low == other.low && high == other.high;
	}
};

// Calls visit(begin, end) with the mentions of each edge.
template<class Visit>
void for_each_edge(const std::vector<Face>& faces, Visit visit)
{
	std::vector<DirectedEdge> edges;
	edges.reserve(3 * faces.size());
	for (const Face& face : faces) {
		for (std::size_t k = 0; k < 3; ++k) {
			const Index a = face[k];
			const Index b = face[(k + 1) % 3];
			if (a != b)
				edges.push_back({std::min(a, b), std::max(a, b), a > b});
		}
	}
	std::sort(edges.begin(), edges.end(), [](const DirectedEdge& a, const DirectedEdge& b) {
		return std::tie(a.low, a.high, a.swapped) < std::tie(b.low, b.high, b.swapped);
	});
	for (auto begin = edges.cbegin(); begin != edges.cend();) {
		const auto end = std::find_if(
			begin, edges.cend(), [&](const DirectedEdge& edge) { return !edge.same_ends(*begin); });
		visit(begin, end);
		begin = end;
	}
}

} // namespace

IndexLists vertex_faces(Index vertex_count, const std::vector<Face>& faces)
{
	IndexLists lists;
	lists.offsets.assign(at(vertex_count) + 1, 0);
	for (const Face& face : faces) {
		for (std::size_t k = 0; k < 3; ++k) {
			if (first_mention(face, k))
				++lists.offsets[at(face[k]) + 1];
		}
	}
	for (std::size_t i = 1; i < lists.offsets.size(); ++i)
		lists.offsets[i] += lists.offsets[i - 1];

	lists.values.resize(at(lists.offsets.back()));
	std::vector<Index> next(lists.offsets.begin(), lists.offsets.end() - 1);
	for (std::size_t i = 0; i < faces.size(); ++i) {
		for (std::size_t k = 0; k < 3; ++k) {
			if (first_mention(faces[i], k))
				lists.values[at(next[at(faces[i][k])]++)] = static_cast<Index>(i);
		}
	}
	return lists;
}

std::vector<std::uint8_t> boundary_vertices(Index vertex_count, const std::vector<Face>& faces)
{
	std::vector<std::uint8_t> flags(at(vertex_count), 0);
	for_each_edge(faces, [&](auto begin, auto end) {
		if (end - begin != 2)
			flags[at(begin->low)] = flags[at(begin->high)] = 1;
	});
	return flags;
}

Index count_non_manifold_edges(const std::vector<Face>& faces)
{
	Index count = 0;
	for_each_edge(faces, [&](auto begin, auto end) {
		if (end - begin > 2 || (end - begin == 2 && begin->swapped == (begin + 1)->swapped))
			++count;
	});
	return count;
}

RingCollector::RingCollector(const std::vector<Face>& faces, const IndexLists& vertex_faces) :
		mesh_faces_(faces), vertex_faces_(vertex_faces), face_stamps_(faces.size(), 0),
		vertex_stamps_(vertex_faces.offsets.size() - 1, 0)
{
}

void RingCollector::collect(Index face, int rings)
{
	if (++stamp_ == 0) {
		std::fill(face_stamps_.begin(), face_stamps_.end(), 0U);
		std::fill(vertex_stamps_.begin(), vertex_stamps_.end(), 0U);
		stamp_ = 1;
	}
	faces_.clear();
	ends_.clear();
	add(face);
	ends_.push_back(faces_.size());
	for (int ring = 0; ring < rings; ++ring)
		grow();
}

void RingCollector::grow()
{
	const std::size_t begin = ends_.size() > 1 ? ends_[ends_.size() - 2] : 0;
	const std::size_t end = ends_.back();
	for (std::size_t i = begin; i < end; ++i) {
		for (const Index vertex : mesh_faces_[at(faces_[i])]) {
			if (vertex_stamps_[at(vertex)] == stamp_)
				continue;
			vertex_stamps_[at(vertex)] = stamp_;
			const Index* const last = vertex_faces_.end(vertex);
			for (const Index* it = vertex_faces_.begin(vertex); it != last; ++it)
				add(*it);
		}
	}
	ends_.push_back(faces_.size());
}

void RingCollector::add(Index face)
{
	if (face_stamps_[at(face)] == stamp_)
		return;
	face_stamps_[at(face)] = stamp_;
	faces_.push_back(face);
}

} // namespace orthopoly
