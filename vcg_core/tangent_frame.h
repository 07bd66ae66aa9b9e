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
		const double angle =
			0.5 * std::atan2(2 * covariance(0, 1), covariance(0, 0) - covariance(1, 1));
		tangent_ = std::cos(angle) * tangent_ + std::sin(angle) * bitangent_;
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
