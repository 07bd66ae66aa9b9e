// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <Eigen/Geometry>
#include <cmath>

namespace orthopoly {

/// Two axes across a normal, turned to where directions seen around it change most.
///
/// What is chosen along such axes turns with the mesh: it does not depend on how the mesh lies in
/// space.
class TangentFrame {
public:
	/// The number of rings, from some to the largest, within which are enough directions to
	/// observe: one alone has no change around it, so that rounding would turn the axes, and a few
	/// have but chance.
	/// @param count_within the number of directions within a number of rings
	template<class Count>
	static int rings_to_observe(int rings, int largest, Count count_within)
	{
		constexpr int ENOUGH = 6;
		while (rings < largest && static_cast<int>(count_within(rings)) < ENOUGH)
			++rings;
		return rings;
	}

	explicit TangentFrame(const Point& normal) :
			normal_(normal), tangent_(normal.unitOrthogonal()), bitangent_(normal.cross(tangent_))
	{
	}

	/// Takes a direction into account.
	void observe(const Point& direction, double weight)
	{
		const Eigen::Vector2d across(direction.dot(tangent_), direction.dot(bitangent_));
		weight_ += weight;
		sum_ += weight * across;
		squares_ += weight * across * across.transpose();
	}

	/// Turns the axes by what was observed; to be called once, after the last observation.
	void align()
	{
		if (!(weight_ > 0))
			return;
		const Eigen::Matrix2d covariance = squares_ - sum_ * sum_.transpose() / weight_;
		// The angle to turn by is half that of (a, b); by half-angle formulas, on the side where
		// they lose no digits.
		const double a = covariance(0, 0) - covariance(1, 1);
		const double b = 2 * covariance(0, 1);
		const double length = std::sqrt(a * a + b * b);
		if (!(length > 0))
			return;
		const double larger = std::sqrt(0.5 * (1 + std::abs(a) / length));
		const double smaller = 0.5 * std::abs(b) / (length * larger);
		const double cosine = a > 0 ? larger : smaller;
		const double sine = std::copysign(a > 0 ? smaller : larger, b);
		tangent_ = cosine * tangent_ + sine * bitangent_;
		bitangent_ = normal_.cross(tangent_);
	}

	const Point& tangent() const { return tangent_; }
	const Point& bitangent() const { return bitangent_; }

private:
	Point normal_;
	Point tangent_;
	Point bitangent_;
	double weight_ = 0;
	Eigen::Vector2d sum_ = Eigen::Vector2d::Zero();
	Eigen::Matrix2d squares_ = Eigen::Matrix2d::Zero();
};

} // namespace orthopoly
