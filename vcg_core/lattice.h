// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Steps from which a lattice is looked for, in mean edge lengths: rounding to finer ones is less
/// than any noise worth removing.
constexpr double LEAST_LATTICE_STEP = 0.08;

/// The step of the cubic lattice that all vertices lie on, turned and moved any way, in mean edge
/// lengths: that of coordinates that were rounded to few digits or bits. Zero where there is none
/// or a finer one.
///
/// All squares of edges are whole multiples of its square then, and of hardly any other mesh are
/// more than a fifth within a tenth of one. What was drawn on a lattice has one too. The surface of
/// a volume of insides and outsides (a segmented one) has its vertices half way along the edges of
/// cubes: its steps are the half diagonals of their faces. O(#F) time.
double lattice_step(const Workspace& workspace, const std::vector<Point>& positions);

} // namespace orthopoly
