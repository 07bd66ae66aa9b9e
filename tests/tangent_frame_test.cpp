// SPDX-License-Identifier: GPL-3.0-or-later
#include "tangent_frame.h"

#include "step_fixture.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <vector>

using namespace orthopoly;

namespace {

// Unit directions around z that spread three times as far along (cos angle, sin angle) as across.
std::vector<Point> spread(double angle, const Point& middle = Point::Zero())
{
	std::mt19937 generator(5);
	std::vector<Point> directions;
	for (int i = 0; i < 60; ++i) {
		const double along = 0.3 * (static_cast<double>(generator()) * 0x1p-31 - 1);
		const double across = 0.1 * (static_cast<double>(generator()) * 0x1p-31 - 1);
		directions.push_back(Point(
			along * std::cos(angle) - across * std::sin(angle),
			along * std::sin(angle) + across * std::cos(angle),
			1));
		directions.back() += middle;
		directions.back().normalize();
	}
	return directions;
}

TangentFrame frame_of(const Point& normal, const std::vector<Point>& directions)
{
	TangentFrame frame(normal);
	for (const Point& direction : directions)
		frame.observe(direction, 1.0);
	frame.align();
	return frame;
}

void check_axes(const TangentFrame& frame, const Point& normal)
{
	CHECK(frame.tangent().norm() == Approx(1));
	CHECK(frame.bitangent().norm() == Approx(1));
	CHECK(std::abs(frame.tangent().dot(normal)) < 1e-14);
	CHECK((normal.cross(frame.tangent()) - frame.bitangent()).norm() < 1e-14);
}

} // namespace

TEST_CASE("Axes lie across the normal, at right angles", "[tangent_frame]")
{
	std::mt19937 generator(1);
	const auto number = [&]() { return static_cast<double>(generator()) * 0x1p-31 - 1; };
	for (int i = 0; i < 50; ++i) {
		const Point normal = Point(number(), number(), number()).normalized();
		check_axes(TangentFrame(normal), normal);
		check_axes(frame_of(normal, spread(number())), normal);
	}
}

TEST_CASE("The first axis points to where directions change most", "[tangent_frame]")
{
	for (const double angle : {0.0, 0.4, 1.5, 2.2, 3.0}) {
		for (const Point& middle : {Point(0, 0, 0), Point(0.5, -0.3, 0)}) {
			const std::vector<Point> directions = spread(angle, middle);
			const TangentFrame frame = frame_of(Point(0, 0, 1), directions);
			const auto variance = [&](const Point& axis) {
				double sum = 0;
				double squares = 0;
				for (const Point& direction : directions) {
					sum += axis.dot(direction);
					squares += std::pow(axis.dot(direction), 2);
				}
				return squares - sum * sum / static_cast<double>(directions.size());
			};
			const double most = variance(frame.tangent());
			for (double turn = 0.05; turn < 3.1; turn += 0.05)
				CHECK(
					variance(
						std::cos(turn) * frame.tangent() + std::sin(turn) * frame.bitangent()) <=
					most * (1 + 1e-12));
			if (middle.isZero(0))
				CHECK(
					std::abs(frame.tangent().dot(Point(std::cos(angle), std::sin(angle), 0))) >
					0.99);
		}
	}
}

TEST_CASE("Axes turn with the mesh", "[tangent_frame]")
{
	// Up to their sign: a polynomial does not know it.
	const std::vector<Point> directions = spread(0.7);
	const Point normal = Point(0.1, 0.2, 1).normalized();
	const TangentFrame frame = frame_of(normal, directions);
	for (int i = 1; i <= 20; ++i) {
		const Eigen::Matrix3d rotation =
			Eigen::AngleAxisd(0.31 * i, Point(1, -i, 3).normalized()).toRotationMatrix();
		const auto turn = [&](const Point& p) { return Point(rotation * p); };
		const TangentFrame turned = frame_of(turn(normal), each(directions, turn));
		CHECK(std::abs(turned.tangent().dot(turn(frame.tangent()))) == Approx(1).margin(1e-12));
		CHECK(std::abs(turned.bitangent().dot(turn(frame.bitangent()))) == Approx(1).margin(1e-12));
	}
}

TEST_CASE("Observations count by their weight", "[tangent_frame]")
{
	TangentFrame frame(Point(0, 0, 1));
	for (const double side : {-1.0, 1.0}) {
		frame.observe(Point(0.3 * side, 0, 1).normalized(), 1.0);
		frame.observe(Point(0, 0.3 * side, 1).normalized(), 3.0);
		frame.observe(Point(side, side, 0).normalized(), 0.0);
	}
	frame.align();
	CHECK(std::abs(frame.tangent().y()) == Approx(1));
}

TEST_CASE("Without anything observed, axes are axes still", "[tangent_frame]")
{
	const Point normal = Point(1, 2, 3).normalized();
	check_axes(frame_of(normal, {}), normal);
	check_axes(frame_of(normal, {normal, normal}), normal);
	TangentFrame weightless(normal);
	weightless.observe(Point(1, 0, 0), 0);
	weightless.align();
	check_axes(weightless, normal);
}
