// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "denoise.h"
#include "workspace.h"

namespace orthopoly {

/// The paper's method: normals filtered by discrete orthogonal polynomials over non-local similar
/// structures (sections 2 and 3), then eq. 12; `iterations` times.
///
/// Moves the positions, which are the mesh's at first; fills in the resolved options and the
/// iterations done. Reports progress from 0.05 on; throws Cancelled.
void run_paper_method(
	const Workspace& workspace,
	const DenoiseOptions& options,
	DenoiseResult& result,
	std::vector<Point>& positions);

} // namespace orthopoly
