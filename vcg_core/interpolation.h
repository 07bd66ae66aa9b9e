// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

namespace orthopoly {

/// How far a value is on the way from one to another, 0 to 1; the other may be the smaller one.
inline double way_between(double from, double to, double value)
{
	return std::min(1.0, std::max(0.0, (value - from) / (to - from)));
}

/// What is that share (0 to 1) of the way from one value to another.
inline double between(double from, double to, double share)
{
	return (1 - share) * from + share * to;
}

} // namespace orthopoly
