// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <utility>
#include <vector>

namespace orthopoly {

/// Options of `isotropic_structures` and `SimilarStructures`.
struct SimilarStructureOptions {
	/// Rings r of the local structures, in face rings, 1 or more.
	int local_ring = 1;
	/// Rings R searched for similar structures, in face rings, 1 or more. More averages over a
	/// wider surrounding.
	int search_ring = 2;
	/// cos theta_th, -1 to 1: directions whose cosine is above it are similar. More keeps shallower
	/// edges, less removes more noise.
	double cos_threshold = 0.65;
};

/// The isotropic structure S_i^iso of every face (section 2.2): the faces of its r-ring whose
/// normal is similar to its guide direction, nearest rings first.
///
/// @param normals #F unit normals; a face whose vector is zero is in no structure
/// @param guides  #F guide directions; a face whose vector is zero has an empty structure
/// @return #F lists
/// Throws InvalidParameter where the ring is so wide that the lists pass 2^31 entries; Cancelled.
IndexLists isotropic_structures(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const std::vector<Point>& guides,
	const SimilarStructureOptions& options);

/// Puts together the non-local similar structure S_i^nls (section 2.3) of one face after the other.
///
/// Keeps scratch memory, so use one object per thread. Workspace, guides and structures must
/// outlive it.
class SimilarStructures {
public:
	/// @param guides     #F guide directions
	/// @param structures what `isotropic_structures` gave for them
	SimilarStructures(
		const Workspace& workspace,
		const std::vector<Point>& guides,
		const IndexLists& structures,
		const SimilarStructureOptions& options);

	/// Fills faces() with the isotropic structures of all faces of the R-ring whose guide direction
	/// is similar to that of this face: one after the other, the most similar first, equally
	/// similar ones by index. A face that belongs to several structures is repeated as often.
	///
	/// Empty for a face without a guide direction. No structure is added once there are MAX_ROWS
	/// rows.
	void collect(Index face);

	const std::vector<Index>& faces() const { return faces_; }

	/// A regular mesh has about 13^2 rows at r = 1, R = 1, 500 at r = 1, R = 2 and 13,000 at r = 3,
	/// R = 5; without a limit a vertex with a thousand faces would make a million for each of them.
	static constexpr std::size_t MAX_ROWS = 65536;

private:
	RingCollector ring_;
	const std::vector<Point>& guides_;
	const IndexLists& structures_;
	SimilarStructureOptions options_;
	/// Similarity with its sign turned, so that ascending pairs are in the order wanted, and the
	/// face.
	std::vector<std::pair<double, Index>> similar_;
	std::vector<Index> faces_;
};

} // namespace orthopoly
