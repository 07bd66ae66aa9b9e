// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace orthopoly {

/// Steps of a Taubin pair. Their pass band ends at 1/0.5 - 1/0.53 = 0.11 of the umbrella operator's
/// spectrum: waves longer than about ten edges keep their height.
constexpr double TAUBIN_SHRINK = 0.5;
constexpr double TAUBIN_INFLATE = -0.53;

/// Taubin smoothing (Taubin 1995): pairs of a shrinking and an inflating umbrella step. Vertices on
/// an open boundary move along their normal only, so that the outline stays, but for those of
/// `only` with a face turned over: these move along with the outline too.
///
/// @param pairs     number of pairs; a fraction scales the last one's steps
/// @param positions #V, moved in place; fixed vertices stay bit for bit
/// @param only      #V flags of the vertices to move (see `folded_vertices`), or empty for all
void taubin_smooth(
	const Workspace& workspace,
	double pairs,
	std::vector<Point>& positions,
	const std::vector<std::uint8_t>& only = {});

/// How much more near neighbours count than far ones, where triangles are long and thin: smoothing
/// as far along them as across would take the shape away before the noise.
struct NearFirst {
	/// #V, from 0, where all count the same, to 1, where they count by the inverse of their squared
	/// distance.
	const std::vector<double>& shares;
	/// #V, to take the distances from.
	const std::vector<Point>& positions;
};

/// The same with a number of pairs of each vertex's own (#V), no outline moving.
///
/// @param near_first where neighbours do not count the same; nothing: all do
void taubin_smooth(
	const Workspace& workspace,
	const std::vector<double>& pairs,
	std::vector<Point>& positions,
	const NearFirst* near_first = nullptr);

/// Which faces `folded_vertices` takes for folded over.
struct FoldCriterion {
	/// Turned away from the faces around it (those that share a vertex, itself left out) by more
	/// than this cosine.
	double cosine = 0.3;
	/// No higher than this over its longest side, the caller's length unit: what noise can turn
	/// over.
	double height = std::numeric_limits<double>::infinity();
};

/// Flag of a vertex with a folded face.
constexpr std::uint8_t TURNED_AWAY = 1;
/// The same, where it is turned away by more than 90 degrees.
constexpr std::uint8_t TURNED_OVER = 2;

/// #V flags of the corners of faces that are folded over, 0 for the others. The same on any number
/// of threads.
std::vector<std::uint8_t> folded_vertices(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const FoldCriterion& criterion);

} // namespace orthopoly
