// SPDX-License-Identifier: GPL-3.0-or-later
#include "similar_structures.h"

#include "errors.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>

namespace orthopoly {

namespace {

// Faces a thread takes at a time.
constexpr Index GRAIN = 256;

// Turns lengths, kept one place further on, into offsets.
void accumulate_lengths(std::vector<Index>& offsets, int ring)
{
	std::int64_t total = 0;
	for (Index& offset : offsets) {
		total += offset;
		if (total > std::numeric_limits<Index>::max())
			throw InvalidParameter(
				"the local structures of " + std::to_string(ring) + " rings have more than " +
				std::to_string(std::numeric_limits<Index>::max()) +
				" faces in all; lower the guide ring for a mesh of this size");
		offset = static_cast<Index>(total);
	}
}

} // namespace

IndexLists isotropic_structures(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const std::vector<Point>& guides,
	const SimilarStructureOptions& options)
{
	const Index face_count = workspace.mesh.face_count();
	std::vector<RingCollector> rings = workspace.ring_collectors();
	const auto for_each_member = [&](auto visit) {
		workspace.execution.parallel_for(
			face_count, GRAIN, [&](Index begin, Index end, int worker) {
				RingCollector& ring = rings[at(worker)];
				for (Index i = begin; i < end; ++i) {
					const Point& v = guides[at(i)];
					if (v.isZero(0))
						continue;
					ring.collect(i, options.local_ring);
					for (const Index j : ring.faces()) {
						const Point& n = normals[at(j)];
						// Negative thresholds would let in a face without a normal.
						if (n.dot(v) > options.cos_threshold && !n.isZero(0))
							visit(i, j);
					}
				}
			});
	};

	// The rings are walked twice, first to count: cheaper than lists that grow.
	IndexLists lists;
	lists.offsets.assign(at(face_count) + 1, 0);
	for_each_member([&](Index i, Index) { ++lists.offsets[at(i) + 1]; });
	accumulate_lengths(lists.offsets, options.local_ring);
	lists.values.resize(at(lists.offsets.back()));
	std::vector<Index> next(lists.offsets.begin(), lists.offsets.end() - 1);
	for_each_member([&](Index i, Index j) { lists.values[at(next[at(i)]++)] = j; });
	return lists;
}

SimilarStructures::SimilarStructures(
	const Workspace& workspace,
	const std::vector<Point>& guides,
	const IndexLists& structures,
	const SimilarStructureOptions& options) :
		ring_(workspace.ring_collector()),
		guides_(guides), structures_(structures), options_(options)
{
}

void SimilarStructures::collect(Index face)
{
	faces_.clear();
	similar_.clear();
	const Point& v = guides_[at(face)];
	if (v.isZero(0))
		return;
	ring_.collect(face, options_.search_ring);
	for (const Index l : ring_.faces()) {
		const double similarity = v.dot(guides_[at(l)]);
		if (similarity > options_.cos_threshold)
			similar_.emplace_back(-similarity, l);
	}
	std::sort(similar_.begin(), similar_.end());
	for (const auto& [similarity, l] : similar_) {
		if (faces_.size() >= MAX_ROWS)
			break;
		faces_.insert(faces_.end(), structures_.begin(l), structures_.end(l));
	}
}

} // namespace orthopoly
