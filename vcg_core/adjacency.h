// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "execution.h"
#include "triangle_mesh.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace orthopoly {

/// Some consecutive indices of an array, which has to outlive it.
class IndexSpan {
public:
	IndexSpan(const Index* begin, std::size_t size) : begin_(begin), size_(size) {}

	const Index* begin() const { return begin_; }
	const Index* end() const { return begin_ + size_; }
	std::size_t size() const { return size_; }
	Index front() const { return *begin_; }
	Index operator[](std::size_t k) const { return begin_[k]; }

private:
	const Index* begin_;
	std::size_t size_;
};

/// Lists of indices, one after the other in one array (compressed rows).
struct IndexLists {
	/// #lists + 1
	std::vector<Index> offsets;
	std::vector<Index> values;

	const Index* begin(Index list) const
	{
		return values.data() + offsets[static_cast<std::size_t>(list)];
	}
	const Index* end(Index list) const
	{
		return values.data() + offsets[static_cast<std::size_t>(list) + 1];
	}
	Index size(Index list) const
	{
		return offsets[static_cast<std::size_t>(list) + 1] -
			   offsets[static_cast<std::size_t>(list)];
	}
};

/// The faces around every vertex, in ascending order. A face that names a vertex twice is listed
/// once. #V lists.
IndexLists vertex_faces(Index vertex_count, const std::vector<Face>& faces);

/// The pieces of a mesh that do not share a vertex.
struct Components {
	Index count = 0;
	/// #V: the number of the one that a vertex is of, in the order of their first faces; -1 for a
	/// vertex without a face.
	std::vector<Index> numbers;
};

/// @param around the faces around every vertex. O(#F).
Components number_components(const std::vector<Face>& faces, const IndexLists& around);

/// Edges where a mesh is not a closed surface.
struct EdgeDefects {
	/// #V flags: one where the vertex lies on an open edge, which belongs to one face only.
	std::vector<std::uint8_t> boundary;
	/// #V flags: one where the vertex lies on an edge that does not belong to exactly two faces, so
	/// that those around it are no disc.
	std::vector<std::uint8_t> irregular;
	/// Edges that belong to more than two faces, or to two faces that run along it the same way.
	Index non_manifold = 0;
};

/// Looks at every edge from both its ends; faces that name a vertex twice have none. O(#F), and a
/// logarithm of the faces around a vertex. Throws Cancelled.
EdgeDefects find_edge_defects(
	const std::vector<Face>& faces, const IndexLists& vertex_faces, Execution& execution);

/// Collects k-rings: breadth-first over faces that share a vertex; the face itself is ring 0 and
/// belongs to its k-ring. Each vertex is visited once, so a ring takes time in proportion to its
/// faces however many meet in a vertex. Keeps scratch memory (6 bytes a face), so use one object
/// per thread.
class RingCollector {
public:
	/// Both must outlive the collector.
	RingCollector(const std::vector<Face>& faces, const IndexLists& vertex_faces);

	/// Fills faces() with the k-ring of the face, nearest rings first.
	void collect(Index face, int rings);

	/// Adds one more ring to the one collected last.
	void grow();

	/// Until the next collect or grow.
	IndexSpan faces() const { return {faces_.data(), ends_.empty() ? 0 : ends_.back()}; }
	/// The outermost ring collected.
	int rings() const { return static_cast<int>(ends_.size()) - 1; }
	/// Number of faces within ring k (so k = 0 gives 1).
	std::size_t count_within(int ring) const { return ends_[static_cast<std::size_t>(ring)]; }

private:
	const std::vector<Face>& mesh_faces_;
	const IndexLists& vertex_faces_;
	/// The collection a face or a vertex was last reached in.
	std::vector<std::uint32_t> face_stamps_;
	std::vector<std::uint32_t> vertex_stamps_;
	std::uint32_t stamp_ = 0;
	/// Larger than what it holds, which ends_ says, as is the next.
	std::vector<Index> faces_;
	std::vector<std::size_t> ends_;
	/// First met in the ring collected last.
	std::vector<Index> vertices_;
};

} // namespace orthopoly
