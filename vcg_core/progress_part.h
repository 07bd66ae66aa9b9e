// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "progress.h"

namespace orthopoly {

/// The progress of a piece of work that takes up [begin, end] of a whole: what it reports is passed
/// on to the whole, and the whole's wish to stop comes back. `whole` must outlive it.
inline Progress part_of(Progress& whole, double begin, double end)
{
	return Progress([&whole, begin, end](int percent, const std::string& words) {
		return whole.report(begin + percent / 100.0 * (end - begin), words);
	});
}

/// What measuring against a reference takes up of denoising with a comparison: as much before as
/// after.
constexpr double MEASURING_SHARE = 0.12;

} // namespace orthopoly
