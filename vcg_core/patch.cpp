// SPDX-License-Identifier: GPL-3.0-or-later
#include "patch.h"

#include <algorithm>
#include <cstdint>

namespace orthopoly {

namespace {

constexpr Index NO_KEY = -1;
constexpr std::size_t LEAST_ENTRIES = 1024;

// Where to look for a key first: multiplied by 2^32 over the golden ratio, neighbours lie apart.
std::size_t place_of(Index key, std::size_t entries)
{
	return (static_cast<std::uint32_t>(key) * 2654435769U >> 8U) & (entries - 1);
}

} // namespace

void Patch::Numbers::clear()
{
	if (entries_.empty())
		entries_.resize(LEAST_ENTRIES);
	std::fill(entries_.begin(), entries_.end(), Entry {NO_KEY, 0});
	used_ = 0;
}

Index Patch::Numbers::number(Index key, Index next)
{
	std::size_t place = place_of(key, entries_.size());
	while (entries_[place].key != key) {
		if (entries_[place].key == NO_KEY) {
			entries_[place] = {key, next};
			if (2 * ++used_ > entries_.size())
				grow();
			return next;
		}
		place = (place + 1) & (entries_.size() - 1);
	}
	return entries_[place].number;
}

Index Patch::Numbers::find(Index key) const
{
	std::size_t place = place_of(key, entries_.size());
	while (entries_[place].key != key && entries_[place].key != NO_KEY)
		place = (place + 1) & (entries_.size() - 1);
	return entries_[place].key == key ? entries_[place].number : -1;
}

void Patch::Numbers::grow()
{
	std::vector<Entry> entries(2 * entries_.size(), Entry {NO_KEY, 0});
	for (const Entry& entry : entries_) {
		if (entry.key == NO_KEY)
			continue;
		std::size_t place = place_of(entry.key, entries.size());
		while (entries[place].key != NO_KEY)
			place = (place + 1) & (entries.size() - 1);
		entries[place] = entry;
	}
	entries_.swap(entries);
}

Index Patch::count(const Workspace& workspace)
{
	return (workspace.mesh.face_count() + OWN_FACES - 1) / OWN_FACES;
}

void Patch::build(const Workspace& workspace, Index number, int rings, const IndexLists* nearby)
{
	mesh_faces_.clear();
	mesh_vertices_.clear();
	faces_.clear();
	face_numbers_.clear();
	vertex_numbers_.clear();
	const Index begin = number * OWN_FACES;
	own_faces_ = std::min<Index>(OWN_FACES, workspace.mesh.face_count() - begin);
	for (Index i = 0; i < own_faces_; ++i) {
		mesh_faces_.push_back(begin + i);
	}
	// Faces before `done` have given numbers to their vertices; these have given numbers to the
	// faces around them.
	std::size_t done = 0;
	for (int ring = 0; ring <= rings; ++ring) {
		const std::size_t end = mesh_faces_.size();
		for (; done < end; ++done)
			add_face(workspace, nearby, mesh_faces_[done], ring < rings);
	}
	link_faces(nearby);
	stamp_ = 0;
	face_stamps_.assign(faces_.size() + 1, stamp_);
	vertex_stamps_.assign(mesh_vertices_.size(), stamp_);
}

void Patch::add_face(
	const Workspace& workspace, const IndexLists* nearby, Index mesh_face, bool with_surroundings)
{
	Face face;
	for (std::size_t k = 0; k < 3; ++k) {
		const Index vertex = workspace.mesh.faces[at(mesh_face)][k];
		const auto next = static_cast<Index>(mesh_vertices_.size());
		face[k] = vertex_numbers_.number(vertex, next);
		if (face[k] != next)
			continue;
		mesh_vertices_.push_back(vertex);
		if (!with_surroundings)
			continue;
		add_faces_around(workspace, vertex);
		if (nearby == nullptr)
			continue;
		for (const Index* it = nearby->begin(vertex); it != nearby->end(vertex); ++it)
			add_faces_around(workspace, *it);
	}
	faces_.push_back(face);
}

void Patch::add_faces_around(const Workspace& workspace, Index mesh_vertex)
{
	const Index* const last = workspace.vertex_faces.end(mesh_vertex);
	for (const Index* it = workspace.vertex_faces.begin(mesh_vertex); it != last; ++it) {
		const Index own = *it - mesh_faces_.front();
		if (own >= 0 && own < own_faces_)
			continue;
		const auto next = static_cast<Index>(mesh_faces_.size());
		if (face_numbers_.number(*it, next) == next)
			mesh_faces_.push_back(*it);
	}
}

void Patch::link_faces(const IndexLists* nearby)
{
	const IndexLists lists = vertex_faces(static_cast<Index>(mesh_vertices_.size()), faces_);
	FaceBlock empty;
	empty.fill(static_cast<Index>(faces_.size()));
	first_blocks_.assign(mesh_vertices_.size(), empty);
	further_blocks_.clear();
	further_offsets_.assign(1, 0);
	std::vector<Index> of_place;
	for (Index vertex = 0; vertex < static_cast<Index>(mesh_vertices_.size()); ++vertex) {
		const Index mesh_vertex = mesh_vertices_[at(vertex)];
		if (nearby == nullptr || nearby->size(mesh_vertex) == 0) {
			link(vertex, lists.begin(vertex), at(lists.size(vertex)));
			continue;
		}
		of_place.assign(lists.begin(vertex), lists.end(vertex));
		for (const Index* it = nearby->begin(mesh_vertex); it != nearby->end(mesh_vertex); ++it) {
			const Index other = vertex_numbers_.find(*it);
			// Beyond the last ring.
			if (other >= 0)
				of_place.insert(of_place.end(), lists.begin(other), lists.end(other));
		}
		std::sort(of_place.begin(), of_place.end());
		of_place.erase(std::unique(of_place.begin(), of_place.end()), of_place.end());
		link(vertex, of_place.data(), of_place.size());
	}
}

// Writes down the faces that a ring has from a vertex on; one vertex after the other.
void Patch::link(Index vertex, const Index* begin, std::size_t count)
{
	std::copy_n(begin, std::min(count, FACES_AT_ONCE), first_blocks_[at(vertex)].begin());
	for (std::size_t k = FACES_AT_ONCE; k < count; k += FACES_AT_ONCE) {
		further_blocks_.emplace_back();
		further_blocks_.back().fill(static_cast<Index>(faces_.size()));
		std::copy_n(begin + k, std::min(count - k, FACES_AT_ONCE), further_blocks_.back().begin());
	}
	further_offsets_.push_back(static_cast<Index>(further_blocks_.size()));
}

void Patch::collect(Index face, int rings)
{
	++stamp_;
	face_stamps_.back() = stamp_;
	face_stamps_[at(face)] = stamp_;
	if (collected_.size() < faces_.size() + 1)
		collected_.resize(faces_.size() + 1);
	if (met_.size() < mesh_vertices_.size() + 1)
		met_.resize(mesh_vertices_.size() + 1);
	collected_[0] = face;
	ring_ends_.assign(1, 1);
	met_ends_.clear();
	for (int ring = 0; ring < rings; ++ring)
		collect_ring();
}

IndexSpan Patch::collect_vertices()
{
	meet_vertices();
	return {met_.data(), met_ends_.back()};
}

// Whether a vertex or face is new is anybody's guess, so no branch depends on it: each is written
// down, and kept by counting it. And locals, since the compiler cannot know that what is written is
// not one of the members.

// The vertices of the ring collected last.
void Patch::meet_vertices()
{
	const Index stamp = stamp_;
	Index* const vertex_stamps = vertex_stamps_.data();
	Index* const met = met_.data();
	const Index* const collected = collected_.data();
	const Face* const faces = faces_.data();
	const std::size_t begin = ring_ends_.size() > 1 ? ring_ends_[ring_ends_.size() - 2] : 0;
	const std::size_t end = ring_ends_.back();
	std::size_t count = met_ends_.empty() ? 0 : met_ends_.back();
	for (std::size_t i = begin; i < end; ++i) {
		for (const Index vertex : faces[collected[i]]) {
			met[count] = vertex;
			count += static_cast<std::size_t>(vertex_stamps[vertex] != stamp);
			vertex_stamps[vertex] = stamp;
		}
	}
	met_ends_.push_back(count);
}

void Patch::collect_ring()
{
	const std::size_t begin = met_ends_.empty() ? 0 : met_ends_.back();
	meet_vertices();
	const std::size_t end = met_ends_.back();
	const Index stamp = stamp_;
	Index* const face_stamps = face_stamps_.data();
	Index* const collected = collected_.data();
	const Index* const met = met_.data();
	const FaceBlock* const first_blocks = first_blocks_.data();
	const Index* const further_offsets = further_offsets_.data();
	std::size_t count = ring_ends_.back();
	const auto take = [&](const FaceBlock& block) {
		for (const Index face : block) {
			collected[count] = face;
			count += static_cast<std::size_t>(face_stamps[face] != stamp);
			face_stamps[face] = stamp;
		}
	};
	for (std::size_t i = begin; i < end; ++i) {
		const Index vertex = met[i];
		take(first_blocks[vertex]);
		for (Index k = further_offsets[vertex]; k < further_offsets[vertex + 1]; ++k)
			take(further_blocks_[at(k)]);
	}
	ring_ends_.push_back(count);
}

} // namespace orthopoly
