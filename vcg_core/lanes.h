// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace orthopoly {

constexpr std::size_t LANES = 4;

#if defined(__GNUC__)

/// Half of the lanes: what a plain x86-64 or ARM processor works on at once.
using LanePair = double __attribute__((vector_size(16)));

inline LanePair where_positive(LanePair condition, LanePair then, LanePair otherwise)
{
	return condition > 0 ? then : otherwise;
}

#else

/// The same for compilers without vector types.
struct LanePair {
	double values[2];
	double operator[](std::size_t k) const { return values[k]; }
};

inline LanePair operator+(LanePair a, LanePair b)
{
	return {{a[0] + b[0], a[1] + b[1]}};
}
inline LanePair operator-(LanePair a, LanePair b)
{
	return {{a[0] - b[0], a[1] - b[1]}};
}
inline LanePair operator*(LanePair a, LanePair b)
{
	return {{a[0] * b[0], a[1] * b[1]}};
}
inline LanePair operator/(LanePair a, LanePair b)
{
	return {{a[0] / b[0], a[1] / b[1]}};
}
inline LanePair where_positive(LanePair condition, LanePair then, LanePair otherwise)
{
	return {{condition[0] > 0 ? then[0] : otherwise[0], condition[1] > 0 ? then[1] : otherwise[1]}};
}

#endif

inline LanePair square_root(LanePair pair)
{
#ifdef __SSE2__
	return _mm_sqrt_pd(pair);
#else
	return LanePair {std::sqrt(pair[0]), std::sqrt(pair[1])};
#endif
}

/// Doubles worked on side by side. What comes out does not depend on the processor: each lane is
/// worked on by itself, as a lone double would be.
struct Lanes {
	std::array<LanePair, 2> pairs;

	Lanes() = default;
	Lanes(LanePair low, LanePair high) : pairs {low, high} {}
	/// The same in all lanes.
	explicit Lanes(double value) : pairs {LanePair {value, value}, LanePair {value, value}} {}
	explicit Lanes(const std::array<double, LANES>& values) :
			pairs {LanePair {values[0], values[1]}, LanePair {values[2], values[3]}}
	{
	}

	double operator[](std::size_t lane) const { return pairs[lane / 2][lane % 2]; }

	Lanes& operator+=(const Lanes& other) { return *this = *this + other; }
	Lanes& operator-=(const Lanes& other) { return *this = *this - other; }
	Lanes& operator*=(const Lanes& other) { return *this = *this * other; }

	friend Lanes operator+(const Lanes& a, const Lanes& b)
	{
		return {a.pairs[0] + b.pairs[0], a.pairs[1] + b.pairs[1]};
	}
	friend Lanes operator-(const Lanes& a, const Lanes& b)
	{
		return {a.pairs[0] - b.pairs[0], a.pairs[1] - b.pairs[1]};
	}
	friend Lanes operator*(const Lanes& a, const Lanes& b)
	{
		return {a.pairs[0] * b.pairs[0], a.pairs[1] * b.pairs[1]};
	}
	friend Lanes operator/(const Lanes& a, const Lanes& b)
	{
		return {a.pairs[0] / b.pairs[0], a.pairs[1] / b.pairs[1]};
	}
};

inline double lane_of(const Lanes& lanes, std::size_t lane)
{
	return lanes[lane];
}
inline double lane_of(double value, std::size_t /*lane*/)
{
	return value;
}

inline double sum_of_lanes(const Lanes& lanes)
{
	return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
}

/// `then` where the condition is above zero, `otherwise` elsewhere (NaN included).
inline Lanes where_positive(const Lanes& condition, const Lanes& then, const Lanes& otherwise)
{
	return {
		where_positive(condition.pairs[0], then.pairs[0], otherwise.pairs[0]),
		where_positive(condition.pairs[1], then.pairs[1], otherwise.pairs[1])};
}
inline double where_positive(double condition, double then, double otherwise)
{
	return condition > 0 ? then : otherwise;
}

inline Lanes square_root(const Lanes& lanes)
{
	return {square_root(lanes.pairs[0]), square_root(lanes.pairs[1])};
}
inline double square_root(double value)
{
	return std::sqrt(value);
}

} // namespace orthopoly
