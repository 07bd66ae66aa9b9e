// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Standard deviation of the noise along the surface normal, in mean edge lengths.
///
/// Around each of a sample of vertices a cubic height polynomial is fitted to the 2-ring; what it
/// leaves is noise where the surface is smooth. A low quantile of the residual variances keeps
/// edges out. Zero where no vertex has neighbours enough. O(#V) time.
double estimate_noise_level(const Workspace& workspace, const std::vector<Point>& positions);

} // namespace orthopoly
