// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling.h"

#include <algorithm>
#include <cstdint>
#include <numeric>

namespace orthopoly {

namespace {

// Digits of a value beyond this many parts of its mean are rounding.
constexpr double DICE_RESOLUTION = 1e6;
// Sizes beyond that are no digits, and too rare to be missed.
constexpr double LARGEST_DIGITS = 1e18;

double scale_of(double mean)
{
	return mean > 0 ? DICE_RESOLUTION / mean : 0;
}

// Digits of a value as bits that have nothing to do with those of a value nearby: multiplied by
// 2^64 over the golden ratio, with the high bits brought down, twice.
std::uint64_t dice_of(double value, double scale)
{
	constexpr std::uint64_t FACTOR = 0x9E3779B97F4A7C15U;
	auto bits = static_cast<std::uint64_t>(std::min(LARGEST_DIGITS, scale * value));
	bits *= FACTOR;
	bits = (bits ^ bits >> 32U) * FACTOR;
	return bits ^ bits >> 32U;
}

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

std::vector<std::uint8_t>
choose_evenly(const Workspace& workspace, const std::vector<double>& values, int one_in)
{
	std::vector<std::uint8_t> flags(values.size(), 1);
	if (one_in == 1)
		return flags;
	const Index count = workspace.mesh.face_count();
	const double mean = workspace.execution.sum(count, [&](Index i) {
		return values[static_cast<std::size_t>(i)];
	}) / std::max<Index>(1, count);
	std::vector<std::uint32_t> dice(values.size());
	workspace.execution.for_each(count, [&](std::size_t i) {
		dice[i] = static_cast<std::uint32_t>(dice_of(values[i], scale_of(mean)));
	});
	workspace.execution.for_each(count, [&](std::size_t i) {
		// Its neighbours across edges count twice, itself once.
		int faces = -2;
		int lower = 0;
		for (const Index corner : workspace.mesh.faces[i]) {
			const Index* const end = workspace.vertex_faces.end(corner);
			for (const Index* it = workspace.vertex_faces.begin(corner); it != end; ++it)
				lower += static_cast<int>(dice[static_cast<std::size_t>(*it)] < dice[i]);
			faces += workspace.vertex_faces.size(corner);
		}
		// The lowest are chosen, and where their number is no whole one, some of those in between.
		const double between = 0x1p-32 * static_cast<std::uint32_t>(dice_of(dice[i], 1));
		flags[i] = static_cast<std::uint8_t>(one_in * (lower + between) < faces);
	});
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
