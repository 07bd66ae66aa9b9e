// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// What a method that takes noise away which goes together over several edges took from the
/// vertices, along their normals.
///
/// Noise is alike everywhere and detail is not. Where it goes together over several edges what was
/// taken does as well, which that of white noise does not.
struct CorrelatedMoves {
	/// Root mean square of the moves around a vertex: its 80 % and its 95 % quantile over the 20 %
	/// one. 0 where nothing was taken.
	double spread = 0;
	double far_spread = 0;
	/// Of the moves of vertices that an edge joins, over the half of the mesh that was moved less,
	/// where detail contributes least.
	double edge_correlation = 0;

	/// From 0 to 1: how surely the moves are as alike as those of noise.
	double are_alike() const;
};

/// Of the workspace's mesh, as measured, to `positions` (#V). O(#V) time; the same bits on any
/// number of threads. Throws Cancelled.
/// @param inner #V flags of the vertices to look at, or empty for all
CorrelatedMoves measure_correlated_moves(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<std::uint8_t>& inner = {});

/// Gives back detail that such a method took along. Where moves are further than the noise accounts
/// for, which is alike everywhere, vertices go that share of the way back to where they were
/// measured which is not noise, as a Wiener filter has it.
///
/// @param most      share of the way at most, 0 to 1
/// @param positions #V denoised, moved in place; fixed vertices stay bit for bit
///
/// O(#V); the same bits on any number of threads. Throws Cancelled.
void give_back_uneven(const Workspace& workspace, double most, std::vector<Point>& positions);

} // namespace orthopoly
