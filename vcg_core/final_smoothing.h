// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "probe.h"
#include "workspace.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// How much a denoised mesh is smoothed in the end.
struct FinalSmoothing {
	/// Pairs of the filter (Taubin 1995).
	int pairs = 0;
	/// Of the way to what the filter makes of it, 0 to 1.
	double share = 0;
};

/// Where surfaces curve a method is left with few faces to average over, so that its result is
/// rougher than the surface; where they have edges, smoothing costs more than it gains. This
/// chooses what leaves the least square error of the vertices' distances along the normals, as they
/// differ over the edges, which is what normals go by; of a broad smoothing no more than leaves the
/// least in the distances themselves, too. The error is what the method leaves of a probe, which is
/// known. What it makes of its own, such as facets, it would make of the probe again: that goes by
/// what was taken from the measured mesh (Stein's unbiased estimate, 1981), where it is certain
/// that all of the smoothing would not be too much and the noise is white.
///
/// @param workspace its mesh as measured
/// @param probe     of the result
/// @param responses #V of the method to the probe
/// @param positions #V denoised
/// @param inner     #V flags of the vertices to look at, or empty for all
FinalSmoothing choose_smoothing(
	const Workspace& workspace,
	const Probe& probe,
	const std::vector<Point>& responses,
	const std::vector<Point>& positions,
	const std::vector<std::uint8_t>& inner = {});

/// Moves the positions (#V) along their normals, in place, unless a face is turned over by that;
/// fixed vertices stay bit for bit. O(#V); the same bits on any number of threads. Throws
/// Cancelled.
void smooth_finally(
	const Workspace& workspace, const FinalSmoothing& smoothing, std::vector<Point>& positions);

} // namespace orthopoly
