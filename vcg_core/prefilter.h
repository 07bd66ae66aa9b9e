// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// Taubin smoothing (Taubin 1995): pairs of a shrinking and an inflating umbrella step. Vertices on
/// an open boundary move along their normal only, so that the outline stays.
///
/// @param pairs     number of pairs; a fraction scales the last one's steps
/// @param positions #V, moved in place; fixed vertices stay bit for bit
/// @param only      #V flags of the vertices to move, or empty for all
void taubin_smooth(
	const Workspace& workspace,
	double pairs,
	std::vector<Point>& positions,
	const std::vector<std::uint8_t>& only = {});

/// #V flags: one where a face around the vertex is turned away from the area-weighted mean normal
/// by more than its cosine says.
std::vector<std::uint8_t>
folded_vertices(const Workspace& workspace, const std::vector<Point>& positions, double cosine);

} // namespace orthopoly
