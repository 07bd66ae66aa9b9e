// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "adjacency.h"
#include "workspace.h"

#include <array>
#include <cstddef>
#include <vector>

namespace orthopoly {

/// Some consecutive faces of a mesh with all faces within some rings of them, under numbers of
/// their own: what a structure reads fits into the cache, and takes memory that does not grow with
/// the mesh. To be used again and again, one a thread.
class Patch {
public:
	/// Faces a patch has for its own. More would have relatively fewer around them, but outgrow
	/// the cache.
	static constexpr Index OWN_FACES = 2048;

	/// Patches a mesh is cut up into.
	static Index count(const Workspace& workspace);

	/// Takes over patch `number` and as many rings around it. O(number of faces in it).
	///
	/// @param nearby #V lists of vertices that are one place with a vertex, so that a ring has the
	///               faces around all of them; or nothing, where each is a place of its own
	void
	build(const Workspace& workspace, Index number, int rings, const IndexLists* nearby = nullptr);

	/// Number of own faces, which come first.
	Index own_faces() const { return own_faces_; }
	/// The mesh's numbers of the patch's faces and vertices.
	const std::vector<Index>& mesh_faces() const { return mesh_faces_; }
	const std::vector<Index>& mesh_vertices() const { return mesh_vertices_; }
	/// Faces, by the patch's numbers of their vertices.
	const std::vector<Face>& faces() const { return faces_; }

	/// Collects as many rings around an own face, which is ring 0; no more than the patch was built
	/// with. As RingCollector does.
	void collect(Index face, int rings);
	/// What was collected last, nearest rings first, until the next time.
	IndexSpan collected() const { return {collected_.data(), ring_ends_.back()}; }
	/// How many of them lie within a ring.
	std::size_t count_within(int ring) const { return ring_ends_[static_cast<std::size_t>(ring)]; }

	/// The vertices of what was collected last, in the order of the first face that has them. To be
	/// called at most once for a collection.
	IndexSpan collect_vertices();
	/// How many of them are of faces within a ring.
	std::size_t vertex_count_within(int ring) const
	{
		return met_ends_[static_cast<std::size_t>(ring)];
	}

private:
	/// Faces around a vertex: all but few have no more, and lists of one length are gone through
	/// without a guess where they end.
	static constexpr std::size_t FACES_AT_ONCE = 8;
	using FaceBlock = std::array<Index, FACES_AT_ONCE>;

	/// The patch's number for each number of the mesh that was given one: a hash table with open
	/// addresses.
	class Numbers {
	public:
		void clear();
		/// The number given to a key; `next` if it is new.
		Index number(Index key, Index next);
		/// The number given to a key; -1 if there is none.
		Index find(Index key) const;

	private:
		struct Entry {
			Index key;
			Index number;
		};
		void grow();

		std::vector<Entry> entries_;
		std::size_t used_ = 0;
	};

	void add_face(
		const Workspace& workspace,
		const IndexLists* nearby,
		Index mesh_face,
		bool with_surroundings);
	void add_faces_around(const Workspace& workspace, Index mesh_vertex);
	void link_faces(const IndexLists* nearby);
	void link(Index vertex, const Index* begin, std::size_t count);
	void collect_ring();
	void meet_vertices();

	Index own_faces_ = 0;
	std::vector<Index> mesh_faces_;
	std::vector<Index> mesh_vertices_;
	std::vector<Face> faces_;
	/// The first faces around every vertex, those after them in `further_blocks_`; filled up with
	/// the number of no face, faces_.size().
	std::vector<FaceBlock> first_blocks_;
	std::vector<FaceBlock> further_blocks_;
	/// Where those of a vertex begin and end: in most cases, in the same place.
	std::vector<Index> further_offsets_;
	Numbers face_numbers_;
	Numbers vertex_numbers_;

	/// The collection a face or a vertex was last reached in; no face always counts as reached.
	Index stamp_ = 0;
	std::vector<Index> face_stamps_;
	std::vector<Index> vertex_stamps_;
	/// Larger than what it holds, which ring_ends_ says.
	std::vector<Index> collected_;
	std::vector<std::size_t> ring_ends_;
	/// Vertices of the faces collected, but for the last ring; larger than what it holds, too.
	std::vector<Index> met_;
	std::vector<std::size_t> met_ends_;
};

} // namespace orthopoly
