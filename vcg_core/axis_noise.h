// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "uneven_noise.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Noise along one axis, as a scanner leaves it that saw all of the surface from one side: along
/// the normals it is as much of it as these lean on the axis, and none where the surface was seen
/// edge on.
struct AxisNoise {
	/// How certain it is that the noise is of that kind, 0 to 1.
	double certainty = 0;
	/// Unit length; either way.
	Point axis = Point::Zero();
	/// Deviation along the axis, and of the noise along all normals beside it; in mean edge
	/// lengths.
	double along = 0;
	double beside = 0;
	/// What detail as small as the triangles leaves beside both.
	double detail = 0;

	/// Deviation of the noise along a unit normal.
	double level_along(const Point& normal) const;
};

/// Looks for noise along one axis.
///
/// The low residual variances are a quadratic form of the normals then. It is fitted to them
/// (quantile regression, Koenker and Bassett 1978, by reweighted squares), and its longest axis is
/// taken if variances rise along it as they should, by as much over rings of all widths, as noise
/// does and detail does not.
///
/// @param normals #V of the surface below the noise, or zero
/// O(#sample) time. The same bits on any number of threads. Throws Cancelled.
AxisNoise find_axis_noise(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& normals,
	const NoiseSample& sample);

} // namespace orthopoly
