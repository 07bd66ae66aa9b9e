// SPDX-License-Identifier: GPL-3.0-or-later
#include "sampling.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

namespace orthopoly {

namespace {

// Digits of a value beyond this many parts of its mean are rounding.
constexpr double DICE_RESOLUTION = 1e6;
// Sizes beyond that are no digits, and too rare to be missed.
constexpr double LARGEST_DIGITS = 1e18;
// A sample that is this share of its size and so many of its standard deviations too large or too
// small was not drawn by dice: many of the values are alike.
constexpr double MOST_OFF = 0.25;
constexpr double DEVIATIONS_OFF = 6;

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

// Whether so many of a number of items may be one in so many by dice.
bool is_by_dice(std::size_t found, std::size_t count, Index every)
{
	const double expected = static_cast<double>(count) / every;
	const double off = std::abs(static_cast<double>(found) - expected);
	return off <= std::max(MOST_OFF * expected, DEVIATIONS_OFF * std::sqrt(expected));
}

// One in so many numbers, by dice.
std::vector<std::size_t> numbers_by_dice(std::size_t count, Index every)
{
	std::vector<std::size_t> numbers;
	for (std::size_t k = 0; k < count; ++k) {
		if (dice_of(static_cast<double>(k), 1) % static_cast<std::uint64_t>(every) == 0)
			numbers.push_back(k);
	}
	return numbers;
}

} // namespace

std::vector<Index> sample_by_value(const std::vector<double>& values, Index wanted)
{
	std::vector<Index> positive;
	double sum = 0;
	for (std::size_t i = 0; i < values.size(); ++i) {
		if (!(values[i] > 0))
			continue;
		positive.push_back(static_cast<Index>(i));
		sum += values[i];
	}
	if (wanted <= 0)
		return {};
	const auto count = static_cast<Index>(positive.size());
	const Index every = count / wanted;
	if (every <= 1)
		return positive;
	std::vector<Index> sample;
	const double scale = scale_of(sum / count);
	for (const Index i : positive) {
		const double digits = scale * values[static_cast<std::size_t>(i)];
		if (digits < LARGEST_DIGITS && static_cast<std::int64_t>(digits) % every == 0)
			sample.push_back(i);
	}
	if (is_by_dice(sample.size(), positive.size(), every))
		return sample;
	sample.clear();
	for (const std::size_t k : numbers_by_dice(positive.size(), every))
		sample.push_back(positive[k]);
	return sample;
}

std::vector<std::size_t> subsample_by_value(const std::vector<double>& values, Index wanted)
{
	const std::size_t count = values.size();
	const Index every = wanted > 0 ? static_cast<Index>(count) / wanted : 0;
	std::vector<std::size_t> numbers(count);
	std::iota(numbers.begin(), numbers.end(), std::size_t(0));
	if (every <= 1)
		return numbers;
	const double sum = std::accumulate(values.begin(), values.end(), 0.0);
	const double scale = scale_of(sum / static_cast<double>(count));
	const auto is_left_out = [&](std::size_t k) {
		return dice_of(values[k], scale) % static_cast<std::uint64_t>(every) != 0;
	};
	numbers.erase(std::remove_if(numbers.begin(), numbers.end(), is_left_out), numbers.end());
	return is_by_dice(numbers.size(), count, every) ? numbers : numbers_by_dice(count, every);
}

std::vector<double> signs_by_value(const std::vector<double>& values)
{
	std::size_t count = 0;
	double sum = 0;
	for (const double value : values) {
		count += value > 0 ? 1 : 0;
		sum += std::max(0.0, value);
	}
	const double scale = scale_of(sum / static_cast<double>(count));
	// The highest bit: the lower ones make the samples.
	const auto is_up = [](double value, double its_scale) {
		return dice_of(value, its_scale) >> 63U != 0;
	};
	std::vector<double> signs(values.size(), 0);
	std::size_t up = 0;
	for (std::size_t k = 0; k < values.size(); ++k) {
		if (!(values[k] > 0))
			continue;
		signs[k] = is_up(values[k], scale) ? 1 : -1;
		up += signs[k] > 0 ? 1 : 0;
	}
	if (!is_by_dice(up, count, 2)) {
		for (std::size_t k = 0; k < values.size(); ++k) {
			if (signs[k] != 0)
				signs[k] = is_up(static_cast<double>(k), 1) ? 1 : -1;
		}
	}
	return signs;
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
