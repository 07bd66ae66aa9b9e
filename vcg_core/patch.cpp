// SPDX-License-Identifier: GPL-3.0-or-later
#include "patch.h"

#include <algorithm>
#include <cstdint>

namespace orthopoly {

namespace {

constexpr Index NO_KEY = -1;
constexpr std::size_t LEAST_ENTRIES = 1024;

std::size_t at(Index index)
{
	return static_cast<std::size_t>(index);
}

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

void Patch::build(const Workspace& workspace, Index number, int rings)
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
			add_face(workspace, mesh_faces_[done], ring < rings);
	}
	vertex_faces_ = orthopoly::vertex_faces(static_cast<Index>(mesh_vertices_.size()), faces_);
}

void Patch::add_face(const Workspace& workspace, Index mesh_face, bool with_surroundings)
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
		const Index* const last = workspace.vertex_faces.end(vertex);
		for (const Index* it = workspace.vertex_faces.begin(vertex); it != last; ++it) {
			const Index own = *it - mesh_faces_.front();
			if (own >= 0 && own < own_faces_)
				continue;
			const auto next_face = static_cast<Index>(mesh_faces_.size());
			if (face_numbers_.number(*it, next_face) == next_face)
				mesh_faces_.push_back(*it);
		}
	}
	faces_.push_back(face);
}

} // namespace orthopoly
