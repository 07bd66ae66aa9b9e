// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "adjacency.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Some consecutive faces of a mesh with all faces within some rings of them, under numbers of
/// their own: what a structure reads fits into the cache, and takes memory that does not grow with
/// the mesh. To be used again and again, one a thread.
class Patch {
public:
	/// Faces a patch has for its own. More would have relatively fewer around them, but outgrow
	/// the cache.
	static constexpr Index OWN_FACES = 1024;

	/// Patches a mesh is cut up into.
	static Index count(const Workspace& workspace);

	/// Takes over patch `number` and as many rings around it. O(number of faces in it).
	void build(const Workspace& workspace, Index number, int rings);

	/// Number of own faces, which come first.
	Index own_faces() const { return own_faces_; }
	/// The mesh's numbers of the patch's faces and vertices.
	const std::vector<Index>& mesh_faces() const { return mesh_faces_; }
	const std::vector<Index>& mesh_vertices() const { return mesh_vertices_; }
	/// Faces, by the patch's numbers of their vertices.
	const std::vector<Face>& faces() const { return faces_; }
	/// The patch's faces around its vertices; for vertices on its rim, not all that the mesh has.
	const IndexLists& vertex_faces() const { return vertex_faces_; }

private:
	/// The patch's number for each number of the mesh that was given one: a hash table with open
	/// addresses.
	class Numbers {
	public:
		void clear();
		/// The number given to a key; `next` if it is new.
		Index number(Index key, Index next);

	private:
		struct Entry {
			Index key;
			Index number;
		};
		void grow();

		std::vector<Entry> entries_;
		std::size_t used_ = 0;
	};

	void add_face(const Workspace& workspace, Index mesh_face, bool with_surroundings);

	Index own_faces_ = 0;
	std::vector<Index> mesh_faces_;
	std::vector<Index> mesh_vertices_;
	std::vector<Face> faces_;
	IndexLists vertex_faces_;
	Numbers face_numbers_;
	Numbers vertex_numbers_;
};

} // namespace orthopoly
