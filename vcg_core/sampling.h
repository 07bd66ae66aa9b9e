// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"
#include "workspace.h"

#include <cstdint>
#include <vector>

namespace orthopoly {

/// Indices of about `wanted` items, or all where there are not many more.
///
/// Which ones depends on the items' values (areas, say) and not on their numbers, so that a mesh
/// with its faces in another order gives the same sample: the value's digits serve as the dice.
/// Where many values are alike and so no dice, the numbers are.
/// @param values one an item; those that are not positive are left out
std::vector<Index> sample_by_value(const std::vector<double>& values, Index wanted);

/// Numbers of about `wanted` of the items of a sample, or all where there are not many more: by
/// other digits of their values than those that `sample_by_value` took them for.
/// @param values one an item of the sample; positive
std::vector<std::size_t> subsample_by_value(const std::vector<double>& values, Index wanted);

/// 1 or -1 for each item by dice, as those of `sample_by_value`: other dice than there.
/// @param values one an item; those that are not positive get 0
std::vector<double> signs_by_value(const std::vector<double>& values);

/// #F flags of about one face in so many, everywhere alike: one in so many of any face and those
/// that share a vertex with it. By the digits of the faces' values too; all faces for one in one,
/// and where values are all alike.
/// @param values #F positive numbers
std::vector<std::uint8_t>
choose_evenly(const Workspace& workspace, const std::vector<double>& values, int one_in);

/// Deviation of a normal distribution over the median of its absolute values.
constexpr double DEVIATION_PER_MEDIAN = 1.4826;

/// The value below which that share (0 to 1) of the values lies; zero for none. Reorders them.
double quantile(std::vector<double>& values, double share);

} // namespace orthopoly
