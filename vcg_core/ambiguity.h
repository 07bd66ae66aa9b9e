// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// How clear it is, around a face, which faces belong to the same smooth piece of the surface.
struct LocalAmbiguity {
	/// 0 where all normals around agree or are plainly apart (flat, or a sharp edge) to 1 where
	/// they lie in between (a blurred edge, or detail finer than the structures).
	double ambiguity = 0;
	/// Mean area of the faces around.
	double mean_area = 0;
};

/// Measures the ambiguity over the 2-ring of every face.
///
/// @param normals #F unit normals, already filtered
/// @param areas   #F
/// @returns #F
std::vector<LocalAmbiguity> measure_ambiguity(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const std::vector<double>& areas);

} // namespace orthopoly
