// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "correlated_moves.h"
#include "denoise.h"
#include "outliers.h"
#include "uneven_noise.h"
#include "workspace.h"

#include <functional>

namespace orthopoly {

/// How the noise of neighbouring vertices goes together.
struct Correlation {
	/// How far it is taken to, 0 to 1.
	double share = 0;
	/// From 0 (over an edge or two) to 1 (over many).
	double reach = 0;
};

/// What noise a mesh has: how much, and of what kinds.
struct MeshNoise {
	Correlation correlation;
	/// From 0 to 1: how surely the mesh shows where noise that goes together comes from, the grid
	/// of a depth camera or a volume.
	double of_grid = 0;
	/// Its factors are empty where the noise is the same everywhere.
	UnevenNoise uneven;
	/// Its share is zero where outliers do not make the noise.
	OutlierRepair outliers;
	/// In mean edge lengths, and what no noise and hardly any detail of the mesh is beyond.
	double level = 0;
	double most = 0;
	/// The part of the level that polynomials over few rings leave and hence the method has to do
	/// with: less than 1 where they follow noise that goes together over several edges.
	double seen = 1;
	/// What is certain to be noise of it: rounded coordinates.
	double rounding = 0;
};

/// What a run of a method takes from a workspace's mesh as if its noise, of that level in mean edge
/// lengths, were of that correlation.
using CorrelationTrial = std::function<CorrelatedMoves(
	const Workspace& workspace, double level, const Correlation& correlation)>;

/// Estimates the noise of the workspace's mesh. Of the options, what noise the user says there is
/// decides what is looked for. Where it may go together over several edges and residuals alone do
/// not say so for certain, it is tried out. Reports progress from 0.05 to 0.1, but for a trial's;
/// throws Cancelled. O(#V) time, and what a trial takes.
MeshNoise estimate_mesh_noise(
	const Workspace& workspace, const DenoiseOptions& options, const CorrelationTrial& trial);

} // namespace orthopoly
