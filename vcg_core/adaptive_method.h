// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "denoise.h"
#include "workspace.h"

namespace orthopoly {

/// The adaptive method: like the paper's, but structures and polynomials live on the surface
/// itself, and every parameter follows from the estimated noise.
///
/// Moves the positions, which are the mesh's at first; fills in the status, the estimated noise,
/// the resolved options and the iterations done. Reports progress from 0.05 on; throws Cancelled.
void run_adaptive_method(
	const Workspace& workspace,
	const DenoiseOptions& options,
	DenoiseResult& result,
	std::vector<Point>& positions);

} // namespace orthopoly
