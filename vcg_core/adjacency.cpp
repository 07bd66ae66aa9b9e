// SPDX-License-Identifier: GPL-3.0-or-later
#include "adjacency.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace orthopoly {

namespace {

// A face that names a vertex twice counts once around it.
bool first_mention(const Face& face, std::size_t k)
{
	return (k == 0 || face[k] != face[0]) && (k != 2 || face[2] != face[1]);
}

// An edge seen from one of its ends, as one of its faces runs along it.
struct EdgeMention {
	Index other;
	bool leaves;

	bool operator<(const EdgeMention& mention) const
	{
		return std::tie(other, leaves) < std::tie(mention.other, mention.leaves);
	}
};

constexpr Index GRAIN = 1024;

// The edges of a face that end in the vertex. A face that names a vertex twice has none: its
// edges would be there once too often.
void add_mentions(const Face& face, Index vertex, std::vector<EdgeMention>& mentions)
{
	if (!has_three_vertices(face))
		return;
	for (std::size_t k = 0; k < 3; ++k) {
		const Index a = face[k];
		const Index b = face[(k + 1) % 3];
		if (a == vertex)
			mentions.push_back({b, true});
		if (b == vertex)
			mentions.push_back({a, false});
	}
}

// Makes room without giving any up.
void reserve(std::vector<Index>& values, std::size_t size)
{
	if (values.size() < size)
		values.resize(size + size / 2);
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

EdgeDefects find_edge_defects(
	const std::vector<Face>& faces, const IndexLists& vertex_faces, Execution& execution)
{
	EdgeDefects defects;
	const std::size_t vertex_count = vertex_faces.offsets.size() - 1;
	defects.boundary.resize(vertex_count, 0);
	defects.irregular.resize(vertex_count, 0);
	const auto workers = static_cast<std::size_t>(execution.threads());
	std::vector<std::vector<EdgeMention>> mentions_of_worker(workers);
	std::vector<Index> non_manifold(workers, 0);
	execution.parallel_for(
		static_cast<Index>(vertex_count), GRAIN, [&](Index first, Index last, int worker) {
			std::vector<EdgeMention>& mentions = mentions_of_worker[at(worker)];
			for (Index vertex = first; vertex < last; ++vertex) {
				mentions.clear();
				const Index* const end = vertex_faces.end(vertex);
				for (const Index* it = vertex_faces.begin(vertex); it != end; ++it)
					add_mentions(faces[at(*it)], vertex, mentions);
				std::sort(mentions.begin(), mentions.end());
				for (std::size_t k = 0; k < mentions.size();) {
					const EdgeMention& mention = mentions[k];
					std::size_t next = k;
					while (next < mentions.size() && mentions[next].other == mention.other)
						++next;
					if (next - k == 1)
						defects.boundary[at(vertex)] = 1;
					if (next - k != 2)
						defects.irregular[at(vertex)] = 1;
					// Counted from one of its ends.
					const bool is_manifold =
						next - k == 1 ||
						(next - k == 2 && mention.leaves != mentions[k + 1].leaves);
					if (!is_manifold && vertex < mention.other)
						++non_manifold[at(worker)];
					k = next;
				}
			}
		});
	defects.non_manifold = std::accumulate(non_manifold.begin(), non_manifold.end(), Index(0));
	return defects;
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
	face_stamps_[at(face)] = stamp_;
	reserve(faces_, 1);
	faces_[0] = face;
	ends_.assign(1, 1);
	for (int ring = 0; ring < rings; ++ring)
		grow();
}

void RingCollector::grow()
{
	const std::size_t begin = ends_.size() > 1 ? ends_[ends_.size() - 2] : 0;
	const std::size_t end = ends_.back();
	// Locals, since the compiler cannot know that what is written is not one of the members.
	const std::uint32_t stamp = stamp_;
	std::uint32_t* const vertex_stamps = vertex_stamps_.data();
	std::uint32_t* const face_stamps = face_stamps_.data();
	const Index* const offsets = vertex_faces_.offsets.data();
	const Index* const values = vertex_faces_.values.data();
	const Face* const mesh_faces = mesh_faces_.data();
	// Whether a vertex or face is new is anybody's guess, so no branch depends on it: each is
	// written down, and kept by counting it.
	reserve(vertices_, 3 * (end - begin));
	Index* const vertices = vertices_.data();
	const Index* const faces = faces_.data();
	std::size_t vertex_count = 0;
	std::size_t mentions = 0;
	for (std::size_t i = begin; i < end; ++i) {
		const Face& face = mesh_faces[at(faces[i])];
		for (std::size_t k = 0; k < 3; ++k) {
			const std::size_t vertex = at(face[k]);
			const std::size_t is_new = vertex_stamps[vertex] != stamp ? 1 : 0;
			vertex_stamps[vertex] = stamp;
			vertices[vertex_count] = face[k];
			vertex_count += is_new;
			mentions += is_new * at(offsets[vertex + 1] - offsets[vertex]);
		}
	}
	reserve(faces_, end + mentions + 1);
	Index* const found = faces_.data();
	std::size_t count = end;
	for (std::size_t i = 0; i < vertex_count; ++i) {
		const std::size_t vertex = at(vertices[i]);
		const Index* const last = values + offsets[vertex + 1];
		for (const Index* it = values + offsets[vertex]; it != last; ++it) {
			const std::size_t face = at(*it);
			const std::size_t is_new = face_stamps[face] != stamp ? 1 : 0;
			face_stamps[face] = stamp;
			found[count] = *it;
			count += is_new;
		}
	}
	ends_.push_back(count);
}

Components number_components(const std::vector<Face>& faces, const IndexLists& around)
{
	Components components;
	components.numbers.assign(around.offsets.size() - 1, -1);
	std::vector<Index> open;
	for (const Face& seed : faces) {
		if (components.numbers[at(seed[0])] >= 0)
			continue;
		const Index number = components.count++;
		components.numbers[at(seed[0])] = number;
		open.push_back(seed[0]);
		while (!open.empty()) {
			const Index vertex = open.back();
			open.pop_back();
			for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it) {
				for (const Index corner : faces[at(*it)]) {
					if (components.numbers[at(corner)] >= 0)
						continue;
					components.numbers[at(corner)] = number;
					open.push_back(corner);
				}
			}
		}
	}
	return components;
}

} // namespace orthopoly
