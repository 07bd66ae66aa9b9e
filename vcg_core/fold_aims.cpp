// SPDX-License-Identifier: GPL-3.0-or-later
#include "fold_aims.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>

namespace orthopoly {

namespace {

// Normals within this cosine (60 degrees) are of the same side of an edge.
constexpr double AGREEMENT = 0.5;

// The cosine to the targets of another side, as far as these are not beyond a right angle, that
// says folded: with a right angle between the sides, what noise leaves of zero is above.
constexpr double FOLDED_AT_EDGE = -0.1;

// The same where it is doubtful which side a face belongs to: if the filter chose the wrong one of
// two at a right angle, this is the least that keeps the face from lying across the right one.
constexpr double FOLDED_IF_DOUBTFUL = 0.02;

// Edges sharper than this cosine between the normals are knife edges, where a face that looks the
// other way proves nothing.
constexpr double KNIFE_EDGE = -0.2;

// The same for slivers with two of the other side across their edges, of which a quarter are on the
// wrong side.
constexpr double KNIFE_EDGE_OF_SLIVERS = -0.7;

// Doubled area over the square of the longest side, for slivers their height over it, up to which
// a face at an edge is a sliver: common triangles have 0.4 and more, and one in ten of those below
// is on the wrong side of its edge, since noise is as high as they are.
constexpr double SLIVER = 0.15;

// Half of what others are given: their targets lie the other way.
constexpr double AREA_AT_EDGE = 0.5 * UNFOLDED_AREA;

/// The targets across the edges of a face.
struct Surroundings {
	Point sum = Point::Zero();
	int agreeing = 0;
	/// Those that do not agree with the face's.
	std::array<Point, 3> others;
	std::size_t other_count = 0;
	/// Edges with one face across, with a target or not.
	int edges = 0;

	/// Mean of the others where all agree with each other and are at least two, or all there can
	/// be; else zero.
	Point united() const
	{
		Point mean = Point::Zero();
		for (std::size_t k = 0; k < other_count; ++k) {
			if (others[k].dot(others[(k + 1) % other_count]) < AGREEMENT)
				return Point::Zero();
			mean += others[k];
		}
		return other_count > 1 || edges == 1 ? Point(mean.normalized()) : Point(Point::Zero());
	}

	/// Mean of the two of three others that agree with each other alone, the third being on the
	/// other side of an edge that is no knife edge; else zero.
	Point majority() const
	{
		Point mean = Point::Zero();
		int pairs = 0;
		for (std::size_t k = 0; other_count == 3 && k < 3; ++k) {
			const Point& one = others[k];
			const Point& other = others[(k + 1) % 3];
			if (one.dot(other) >= AGREEMENT) {
				mean = (one + other).normalized();
				++pairs;
			}
		}
		const bool clear =
			pairs == 1 && std::all_of(others.begin(), others.end(), [&](const Point& n) {
				return n.dot(mean) >= KNIFE_EDGE;
			});
		return clear ? mean : Point(Point::Zero());
	}
};

Surroundings
surroundings_of(const Workspace& workspace, const std::vector<Point>& normals, Index face)
{
	Surroundings result;
	const std::vector<Face>& faces = workspace.mesh.faces;
	const Face& corners = faces[at(face)];
	for (std::size_t k = 0; k < 3; ++k) {
		const Index to = corners[(k + 1) % 3];
		Index across = -1;
		int found = 0;
		for (const Index* it = workspace.vertex_faces.begin(corners[k]);
			 it != workspace.vertex_faces.end(corners[k]);
			 ++it) {
			const Face& other = faces[at(*it)];
			if (*it != face && std::find(other.begin(), other.end(), to) != other.end()) {
				across = *it;
				++found;
			}
		}
		if (found != 1)
			continue;
		++result.edges;
		const Point& normal = normals[at(across)];
		if (normal.isZero(0))
			continue;
		result.sum += normal;
		if (normal.dot(normals[at(face)]) > AGREEMENT)
			++result.agreeing;
		else
			result.others[result.other_count++] = normal;
	}
	return result;
}

// Of a face without a target.
FoldAim aim_by_others(const Surroundings& around)
{
	const Point united = around.united();
	if (!united.isZero(0))
		return {united, 0, united, UNFOLDED_AREA};
	const Point majority = around.majority();
	return majority.isZero(0) ? FoldAim() :
								FoldAim {majority, FOLDED_AT_EDGE, majority, UNFOLDED_AREA};
}

// Whether the targets around say that a face's own is wrong: none agrees with it nor does the face
// itself, or all agree with each other and look the other way.
bool is_contradicted(const Surroundings& around, const Point& target, const Point& normal)
{
	if (around.agreeing > 0)
		return false;
	const bool alone = around.sum.dot(target) <= AGREEMENT * around.sum.norm();
	return (alone && normal.dot(target) < AGREEMENT) ||
		   (around.other_count == 3 && target.dot(around.united()) < KNIFE_EDGE);
}

// Of a face that does not look towards its target.
FoldAim aim_of_turned(const Surroundings& around, const Point& target, const Point& normal)
{
	FoldAim nothing;
	nothing.target = target;
	bool other_side = false;
	for (std::size_t k = 0; k < around.other_count; ++k) {
		if (normal.dot(around.others[k]) <= AGREEMENT)
			continue;
		other_side = true;
		if (target.dot(around.others[k]) < KNIFE_EDGE)
			return nothing;
	}
	if (!other_side || around.agreeing > 1)
		return {target, FOLDED, target, UNFOLDED_AREA};
	// Not folded, or eq. 12 would have followed the target, but for what is beyond both sides.
	return normal.dot(target) < FOLDED_AT_EDGE ? FoldAim {target, 0, target, AREA_AT_EDGE} :
												 nothing;
}

// Of a face that does, so flat: doubled area over the square of the longest side.
FoldAim aim_of_followed(
	const Surroundings& around, const Point& target, const Point& normal, double flatness)
{
	const Point united = around.united();
	const bool at_one = !united.isZero(0);
	const bool sliver = flatness < SLIVER;
	const bool among_others = around.other_count > 1;
	const bool doubtful = among_others ? at_one : sliver;
	const double knife = among_others && sliver ? KNIFE_EDGE_OF_SLIVERS : KNIFE_EDGE;
	// With but one of the other side, more likely than not the target is right: no further than
	// just within a right angle of both.
	const double area =
		doubtful && !among_others ? 2 * FOLDED_IF_DOUBTFUL * flatness : AREA_AT_EDGE;
	FoldAim aim = {target, FOLDED, target, UNFOLDED_AREA};
	double least = 0;
	for (std::size_t k = 0; k < (at_one ? 1 : around.other_count); ++k) {
		const Point& other = at_one ? united : around.others[k];
		const double between = target.dot(other);
		const double folded = doubtful ? FOLDED_IF_DOUBTFUL : std::min(0.0, between) - AGREEMENT;
		const double beyond = normal.dot(other) - folded;
		if (between > knife && beyond < least) {
			least = beyond;
			aim = {other, folded, target, area};
		}
	}
	return aim;
}

} // namespace

FoldAim fold_aim(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const std::vector<Point>& positions,
	Index face)
{
	const Face& corners = workspace.mesh.faces[at(face)];
	const Point& target = normals[at(face)];
	const Surroundings around = surroundings_of(workspace, normals, face);
	if (target.isZero(0))
		return aim_by_others(around);
	const Point cross = face_cross_product(positions, corners);
	const Point normal = cross.normalized();
	if (is_contradicted(around, target, normal)) {
		const Point united = around.united();
		return united.isZero(0) ? FoldAim {united, 0, target, 0} :
								  FoldAim {united, 0, united, UNFOLDED_AREA};
	}
	if (normal.dot(target) < FOLDED)
		return aim_of_turned(around, target, normal);
	const double square = longest_edge_squared(positions, corners);
	return aim_of_followed(around, target, normal, square > 0 ? cross.norm() / square : 0.0);
}

} // namespace orthopoly
