// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Turns back faces that are folded over, by the least moves along the surface that do.
///
/// What a face has to look towards is its target normal, or that of those around it: see
/// `fold_aim`. Folds of the surface itself, such as knife edges, have targets that agree with some
/// around them, and stay.
///
/// The projected area of a face is linear in each of its corners, so the least move that gives it
/// some is a projection: all faces around a fold take it together, alternating with a step of
/// eq. 12. The vertices go back to where they were unless fewer faces are folded then, none of them
/// anew, and all of them together are closer to their targets.
///
/// @param normals   #F target unit normals, zero where there is none
/// @param positions #V, moved in place; fixed vertices, those on an open boundary (but for a
///                  vertex of a single face) and those not near a fold stay bit for bit
/// @return whether any vertex moved
///
/// O(#F) to look for folds, and then in proportion to those found. The same bits on any number of
/// threads. Throws Cancelled.
bool unfold_faces(
	const Workspace& workspace, const std::vector<Point>& normals, std::vector<Point>& positions);

} // namespace orthopoly
