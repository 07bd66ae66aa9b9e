// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Vertices that stand far out by themselves.
struct Spikes {
	/// In ascending order.
	std::vector<Index> vertices;
	/// #V positions: spikes on the surface around them, the others bit for bit as given. Empty
	/// where there is no spike.
	std::vector<Point> positions;
};

/// Finds lone vertices far off a surface that is smooth around them, as scanners leave a few, and
/// puts them on it along its normal.
///
/// A vertex is compared with a quadratic height polynomial through the others within two rings,
/// each weighed by how well it agrees (iteratively reweighted least squares with the weights of
/// Geman and McClure). It is a spike where it is off by a third of the edges around, by more than
/// the noise, and by many times what most of these others are: corners and edges have others as far
/// off beside them. Fixed vertices and those on open edges stay, and all do where there are no more
/// than a clean mesh may have on purpose.
///
/// @param noise the level, in mean edge lengths
///
/// O(#V) time; the same bits on any number of threads. Throws Cancelled.
Spikes find_spikes(const Workspace& workspace, double noise);

} // namespace orthopoly
