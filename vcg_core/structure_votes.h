// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "patch.h"

#include <cstddef>
#include <vector>

namespace orthopoly {

/// Lets the structure of every face vote for the normals of its members, patch by patch.
///
/// @tparam Vote a vector of Eigen's, of whatever is voted for.
/// @param voters one for each worker, with
///               `const Patch& patch() const`;
///               `void enter(Index number)`: makes patch() that patch, and gets ready for it;
///               `void vote(Index face, std::vector<Vote>& sums)`: adds the votes of the structure
///               of an own face to the sums, by the patch's numbers of the faces voted for.
/// @returns #F sums. Those of a patch are added up by one worker, and patches in their order, so
///          the same bits on any number of threads.
template<class Vote, class Voters>
std::vector<Vote> sum_votes(const Workspace& workspace, Voters& voters)
{
	// Votes of a patch for faces around it.
	struct Outside {
		std::vector<Index> faces;
		std::vector<Vote> sums;
	};
	const Index patches = Patch::count(workspace);
	std::vector<Outside> outsides(static_cast<std::size_t>(patches));
	std::vector<Vote> result(workspace.mesh.faces.size(), Vote::Zero());
	std::vector<std::vector<Vote>> sums_of_worker(voters.size());
	workspace.execution.parallel_for(patches, 1, [&](Index begin, Index end, int worker) {
		auto& voter = voters[static_cast<std::size_t>(worker)];
		std::vector<Vote>& sums = sums_of_worker[static_cast<std::size_t>(worker)];
		for (Index number = begin; number < end; ++number) {
			voter.enter(number);
			const Patch& patch = voter.patch();
			const std::vector<Index>& faces = patch.mesh_faces();
			sums.assign(faces.size() + 1, Vote::Zero());
			for (Index i = 0; i < patch.own_faces(); ++i)
				voter.vote(i, sums);
			const auto own = static_cast<std::size_t>(patch.own_faces());
			for (std::size_t i = 0; i < own; ++i)
				result[static_cast<std::size_t>(faces[i])] = sums[i];
			Outside& outside = outsides[static_cast<std::size_t>(number)];
			for (std::size_t i = own; i < faces.size(); ++i) {
				if (sums[i].isZero(0))
					continue;
				outside.faces.push_back(faces[i]);
				outside.sums.push_back(sums[i]);
			}
		}
	});
	for (const Outside& outside : outsides) {
		for (std::size_t i = 0; i < outside.faces.size(); ++i)
			result[static_cast<std::size_t>(outside.faces[i])] += outside.sums[i];
	}
	return result;
}

} // namespace orthopoly
