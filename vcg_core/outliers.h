// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "noise_level.h"
#include "workspace.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// A mesh with its outliers put back.
struct Outliers {
	/// #V flags: one where a vertex stands out of what its surroundings say.
	std::vector<std::uint8_t> flags;
	/// #V positions: outliers where their surroundings expect them, the others bit for bit as
	/// given.
	std::vector<Point> positions;
	Index count = 0;
};

/// Finds the vertices that are further off than the noise around them, as impulsive noise leaves
/// them, and puts them back.
///
/// Every vertex is compared with a quadratic height polynomial fitted to the others within two
/// rings, each weighed by how well it agrees with its own surroundings (iteratively reweighted
/// least squares with the weights of Geman and McClure). Edges and corners are far off too, but so
/// are their neighbours, and it is by these that the distance is judged. Fixed vertices stay, and
/// all do where the noise is not made by outliers.
///
/// @param noise the level in ordinary places (`NoiseLevels`), outliers and all; 0 where detail is
///              part of it, which says nothing of what makes the noise
///
/// O(#V) time; the same bits on any number of threads. Throws Cancelled.
Outliers
put_back_outliers(const Workspace& workspace, const std::vector<Point>& positions, double noise);

/// What outliers make of a mesh's noise. Levels are in mean edge lengths.
struct OutlierRepair {
	/// How far they explain it, 0 to 1.
	double share = 0;
	/// Its level then: that of all vertices, without the detail of the surface.
	double level = 0;
	/// The level that is left without the outliers.
	double left = 0;
	/// The share of the vertices that are some.
	double found = 0;
	/// #V positions with the outliers put back, as far as they explain the noise; empty where they
	/// do not.
	std::vector<Point> positions;
};

/// Puts back the outliers of the workspace's mesh, as far as the noise is less without them.
///
/// @param levels those of the mesh
/// The same bits on any number of threads. Throws Cancelled.
OutlierRepair repair_outliers(const Workspace& workspace, const NoiseLevels& levels);

} // namespace orthopoly
