// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#if defined(__GNUC__) && defined(__x86_64__)
#include <immintrin.h>
#endif

namespace orthopoly {

constexpr std::size_t LANES = 4;

#if defined(__GNUC__)

/// What a plain x86-64 or ARM processor works on at once.
using DoublePair = double __attribute__((vector_size(16)));

#else

/// The same for compilers without vector types.
struct DoublePair {
	double values[2];
	double operator[](std::size_t k) const { return values[k]; }
	double& operator[](std::size_t k) { return values[k]; }
};

inline DoublePair operator+(const DoublePair& a, const DoublePair& b)
{
	return {{a[0] + b[0], a[1] + b[1]}};
}
inline DoublePair operator-(const DoublePair& a, const DoublePair& b)
{
	return {{a[0] - b[0], a[1] - b[1]}};
}
inline DoublePair operator*(const DoublePair& a, const DoublePair& b)
{
	return {{a[0] * b[0], a[1] * b[1]}};
}
inline DoublePair operator/(const DoublePair& a, const DoublePair& b)
{
	return {{a[0] / b[0], a[1] / b[1]}};
}

#endif

// By reference throughout: how vectors are handed over by value depends on the processor that the
// function was compiled for.

inline void take_square_root(DoublePair& pair)
{
#ifdef __SSE2__
	pair = _mm_sqrt_pd(pair);
#else
	pair = DoublePair {std::sqrt(pair[0]), std::sqrt(pair[1])};
#endif
}

#if defined(__GNUC__) && defined(__x86_64__)

/// What a processor with AVX2 works on at once.
using DoubleQuad = double __attribute__((vector_size(32)));

/// For a function that is to be compiled, with all that it calls, for processors with AVX2.
#define ORTHOPOLY_WIDE __attribute__((target("avx2"), flatten))

__attribute__((target("avx2"))) inline void take_square_root(DoubleQuad& quad)
{
	quad = _mm256_sqrt_pd(quad);
}

/// Whether the processor at hand has AVX2.
inline bool has_wide_lanes()
{
	return __builtin_cpu_supports("avx2") != 0;
}

#else

using DoubleQuad = DoublePair;
#define ORTHOPOLY_WIDE
inline bool has_wide_lanes()
{
	return false;
}

#endif

/// Doubles worked on side by side. What comes out does not depend on the processor: each lane is
/// worked on by itself, as a lone double would be. Aligned as the processor wants it, also in code
/// compiled for one that does not.
/// @tparam Part as many of them as the processor works on at once
template<class Part>
class alignas(sizeof(Part)) BasicLanes {
public:
	BasicLanes() = default;
	// Written out, for classes with one of their own are handed over by reference.
	// NOLINTNEXTLINE(modernize-use-equals-default)
	BasicLanes(const BasicLanes& other) : parts_(other.parts_) {}
	BasicLanes& operator=(const BasicLanes& other) = default;
	~BasicLanes() = default;

	/// The same in all lanes.
	explicit BasicLanes(double value) :
			BasicLanes(std::array<double, LANES> {value, value, value, value})
	{
	}
	explicit BasicLanes(const std::array<double, LANES>& values)
	{
		for (std::size_t lane = 0; lane < LANES; ++lane)
			parts_[lane / WIDTH][lane % WIDTH] = values[lane];
	}

	double operator[](std::size_t lane) const { return parts_[lane / WIDTH][lane % WIDTH]; }

	BasicLanes& operator+=(const BasicLanes& other)
	{
		for (std::size_t k = 0; k < PARTS; ++k)
			parts_[k] = parts_[k] + other.parts_[k];
		return *this;
	}
	BasicLanes& operator-=(const BasicLanes& other)
	{
		for (std::size_t k = 0; k < PARTS; ++k)
			parts_[k] = parts_[k] - other.parts_[k];
		return *this;
	}
	BasicLanes& operator*=(const BasicLanes& other)
	{
		for (std::size_t k = 0; k < PARTS; ++k)
			parts_[k] = parts_[k] * other.parts_[k];
		return *this;
	}
	BasicLanes& operator/=(const BasicLanes& other)
	{
		for (std::size_t k = 0; k < PARTS; ++k)
			parts_[k] = parts_[k] / other.parts_[k];
		return *this;
	}

	friend BasicLanes operator+(BasicLanes a, const BasicLanes& b) { return a += b; }
	friend BasicLanes operator-(BasicLanes a, const BasicLanes& b) { return a -= b; }
	friend BasicLanes operator*(BasicLanes a, const BasicLanes& b) { return a *= b; }
	friend BasicLanes operator/(BasicLanes a, const BasicLanes& b) { return a /= b; }

	friend BasicLanes square_root(BasicLanes lanes)
	{
		for (Part& part : lanes.parts_)
			take_square_root(part);
		return lanes;
	}

	/// `then` where the condition is above zero, `otherwise` elsewhere (NaN included).
	friend BasicLanes
	where_positive(const BasicLanes& condition, BasicLanes then, const BasicLanes& otherwise)
	{
		for (std::size_t k = 0; k < PARTS; ++k) {
#if defined(__GNUC__)
			then.parts_[k] = condition.parts_[k] > 0 ? then.parts_[k] : otherwise.parts_[k];
#else
			for (std::size_t lane = 0; lane < WIDTH; ++lane) {
				if (!(condition.parts_[k][lane] > 0))
					then.parts_[k][lane] = otherwise.parts_[k][lane];
			}
#endif
		}
		return then;
	}

	friend double lane_of(const BasicLanes& lanes, std::size_t lane)
	{
		return lanes[lane];
	}
	friend double sum_of_lanes(const BasicLanes& lanes)
	{
		return (lanes[0] + lanes[1]) + (lanes[2] + lanes[3]);
	}

private:
	static constexpr std::size_t WIDTH = sizeof(Part) / sizeof(double);
	static constexpr std::size_t PARTS = LANES / WIDTH;

	std::array<Part, PARTS> parts_;
};

/// Lanes for any processor, and for one that has wide ones: the same values.
using Lanes = BasicLanes<DoublePair>;
using WideLanes = BasicLanes<DoubleQuad>;

// A lone double in their place.

inline double lane_of(double value, std::size_t /*lane*/)
{
	return value;
}
inline double where_positive(double condition, double then, double otherwise)
{
	return condition > 0 ? then : otherwise;
}
inline double square_root(double value)
{
	return std::sqrt(value);
}

} // namespace orthopoly
