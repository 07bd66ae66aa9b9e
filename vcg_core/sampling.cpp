// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace orthopoly {

namespace {

// Digits of a value beyond this many parts of its mean are rounding.
constexpr double DICE_RESOLUTION = 1e6;
constexpr double LARGEST_DIGITS = 1e18;

} // namespace

std::vector<Index> sample_by_value(const std::vector<double>& values, Index wanted)
{
	const auto count = static_cast<Index>(values.size());
	std::vector<Index> sample;
	const Index every = wanted > 0 ? count / wanted : 1;
	const double mean = std::accumulate(values.begin(), values.end(), 0.0) /
						std::max(1.0, static_cast<double>(count));
	if (every > 1 && mean > 0) {
		for (Index i = 0; i < count; ++i) {
			const double digits = DICE_RESOLUTION * values[static_cast<std::size_t>(i)] / mean;
			// Sizes beyond that are no digits, and too rare to be missed.
			if (digits < LARGEST_DIGITS && static_cast<std::int64_t>(digits) % every == 0)
				sample.push_back(i);
		}
	}
	// Values that are all alike are no dice.
	if (2 * sample.size() < static_cast<std::size_t>(std::min(count, wanted))) {
		sample.resize(values.size());
		std::iota(sample.begin(), sample.end(), Index(0));
	}
	return sample;
}

std::vector<std::uint8_t> choose_by_value(const std::vector<double>& values, int one_in)
{
	if (one_in == 1)
		return std::vector<std::uint8_t>(values.size(), 1);
	std::vector<std::uint8_t> flags(values.size(), 0);
	for (const Index i : sample_by_value(values, static_cast<Index>(values.size()) / one_in))
		flags[static_cast<std::size_t>(i)] = 1;
	return flags;
}

double quantile(std::vector<double>& values, double share)
{
	if (values.empty())
		return 0;
	const auto position =
		static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
	const auto nth = values.begin() + position;
	std::nth_element(values.begin(), nth, values.end());
	return *nth;
}

} // namespace orthopoly
