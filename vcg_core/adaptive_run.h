// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "adaptive_plan.h"
#include "detail.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// What a run took from the vertices (nothing where noise is correlated), and the overall noise
/// that it went by, in the caller's length unit.
struct AdaptiveRun {
	TakenMoves taken;
	double sigma;
};

/// Runs the adaptive method once, as planned: prefilter, normals, heights, vertices, and detail
/// given back.
///
/// @param factors   of the noise, as those of `Deviations`
/// @param positions #V, those of the workspace's mesh at first
/// Reports progress from 0.1 on; throws Cancelled.
AdaptiveRun run_adaptively(
	const Workspace& workspace,
	const AdaptivePlan& plan,
	const std::vector<double>& factors,
	std::vector<Point>& positions);

} // namespace orthopoly
