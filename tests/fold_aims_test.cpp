// SPDX-License-Identifier: GPL-3.0-or-later
#include "fold_aims.h"

#include "step_fixture.h"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

using namespace orthopoly;

namespace {

// So far from up; all turned about the same axis.
Point tilted(double degrees)
{
	const double angle = degrees / 57.29578;
	return {0, std::sin(angle), std::cos(angle)};
}

/// A face that looks up, so high over its longest side, and three others across its edges.
struct Star {
	explicit Star(double height = 0.8) : f(make(height)) {}

	static TriangleMesh make(double height)
	{
		TriangleMesh mesh;
		mesh.positions = {
			Point(0, 0, 0),
			Point(1, 0, 0),
			Point(0.5, height, 0),
			Point(0.5, -0.8, 0),
			Point(1.2, 0.8, 0),
			Point(-0.2, 0.8, 0)};
		mesh.faces = {Face {0, 1, 2}, Face {1, 0, 3}, Face {2, 1, 4}, Face {0, 2, 5}};
		return mesh;
	}

	FoldAim aim(const Point& target, const std::array<Point, 3>& around) const
	{
		return fold_aim(
			f.workspace, {target, around[0], around[1], around[2]}, f.mesh.positions, 0);
	}

	bool is_folded(const FoldAim& aim) const
	{
		return orthopoly::is_folded(face_cross_product(f.mesh.positions, f.mesh.faces[0]), aim);
	}

	StepFixture f;
};

bool looks(const FoldAim& aim, double degrees)
{
	return (aim.witness - tilted(degrees)).norm() < 1e-6;
}

} // namespace

TEST_CASE("A face without a target has to look where those around it do", "[unfolding]")
{
	const Star star;
	const Point nothing = Point::Zero();
	const FoldAim same = star.aim(nothing, {tilted(10), tilted(10), tilted(10)});
	CHECK(looks(same, 10));
	CHECK_FALSE(star.is_folded(same));
	CHECK(star.is_folded(star.aim(nothing, {tilted(170), tilted(170), tilted(170)})));
	// Some have no target either.
	CHECK(looks(star.aim(nothing, {tilted(10), tilted(10), nothing}), 10));
	CHECK(star.aim(nothing, {tilted(10), nothing, nothing}).witness.isZero(0));
	// Beside an edge, but not a knife edge, two of them say it.
	CHECK(looks(star.aim(nothing, {tilted(10), tilted(100), tilted(10)}), 10));
	CHECK(star.aim(nothing, {tilted(10), tilted(150), tilted(10)}).witness.isZero(0));
	CHECK(star.aim(nothing, {tilted(0), tilted(90), tilted(180)}).witness.isZero(0));
	// On the other side of that edge it is not folded, but beyond it.
	CHECK_FALSE(star.is_folded(star.aim(nothing, {tilted(90), tilted(0), tilted(90)})));
	CHECK(star.is_folded(star.aim(nothing, {tilted(160), tilted(70), tilted(160)})));
}

TEST_CASE("A target that all around contradict is not believed by any face", "[unfolding]")
{
	const Star star;
	const FoldAim contradicted = star.aim(tilted(0), {tilted(170), tilted(170), tilted(170)});
	CHECK(looks(contradicted, 170));
	CHECK(star.is_folded(contradicted));
	CHECK(looks(star.aim(tilted(0), {tilted(90), tilted(180), tilted(270)}), 0));
	// A sharp tip is no contradiction.
	CHECK(looks(star.aim(tilted(0), {tilted(80), tilted(80), tilted(80)}), 0));
}

TEST_CASE("A face that looks like the other side of a knife edge is not folded", "[unfolding]")
{
	const Star star;
	const FoldAim knife = star.aim(tilted(130), {tilted(130), tilted(130), tilted(0)});
	CHECK(knife.witness.isZero(0));
	CHECK_FALSE(star.is_folded(knife));
	// At a right angle targets know it.
	CHECK(looks(star.aim(tilted(90), {tilted(90), tilted(90), tilted(0)}), 90));
	CHECK(star.aim(tilted(90), {tilted(90), tilted(0), tilted(0)}).witness.isZero(0));
}

TEST_CASE("A face turned beyond both sides of an edge is folded", "[unfolding]")
{
	const Star star;
	const FoldAim beyond = star.aim(tilted(110), {tilted(110), tilted(20), tilted(20)});
	CHECK(looks(beyond, 110));
	CHECK(star.is_folded(beyond));
	const FoldAim other = star.aim(tilted(60), {tilted(60), tilted(60), tilted(140)});
	CHECK(looks(other, 140));
	CHECK(star.is_folded(other));
	CHECK(other.target == tilted(60));
	CHECK_FALSE(star.is_folded(star.aim(tilted(20), {tilted(20), tilted(20), tilted(110)})));
}

TEST_CASE("Where its side is doubtful a face has to be within a right angle of both", "[unfolding]")
{
	const std::array<Point, 3> one_other = {tilted(0), tilted(0), tilted(91)};
	const std::array<Point, 3> two_others = {tilted(0), tilted(91), tilted(91)};
	const Star common;
	const Star sliver(0.1);
	CHECK_FALSE(common.is_folded(common.aim(tilted(0), one_other)));
	CHECK(common.is_folded(common.aim(tilted(0), two_others)));
	const FoldAim little = sliver.aim(tilted(0), one_other);
	CHECK(sliver.is_folded(little));
	CHECK(sliver.is_folded(sliver.aim(tilted(0), two_others)));
	CHECK(little.area < 0.01);
	CHECK(little.area > 0);
	// Less than a right angle is no fold.
	CHECK_FALSE(sliver.is_folded(sliver.aim(tilted(0), {tilted(0), tilted(80), tilted(80)})));
	// At a knife edge only slivers among others are doubtful.
	CHECK(common.aim(tilted(0), {tilted(0), tilted(120), tilted(120)}).witness == tilted(0));
	CHECK(looks(sliver.aim(tilted(0), {tilted(0), tilted(120), tilted(120)}), 120));
	CHECK(sliver.aim(tilted(0), {tilted(0), tilted(0), tilted(120)}).witness == tilted(0));
	CHECK(sliver.aim(tilted(0), {tilted(0), tilted(150), tilted(150)}).witness == tilted(0));
}

TEST_CASE("A face with one other across its edges goes by that one", "[unfolding]")
{
	TriangleMesh mesh = Star::make(0.8);
	mesh.faces.resize(2);
	const StepFixture f(mesh);
	const FoldAim aim = fold_aim(f.workspace, {Point::Zero(), tilted(10)}, f.mesh.positions, 0);
	CHECK(looks(aim, 10));
}
