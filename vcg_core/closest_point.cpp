// SPDX-License-Identifier: GPL-3.0-or-later
#include "closest_point.h"

#include "errors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

// The tree uses the barycentre of the first without including it.
#include <vcg/space/triangle3.h>

#include <vcg/space/index/aabb_binary_tree/aabb_binary_tree.h>

namespace orthopoly {

namespace {

using VcgPoint = vcg::Point3<double>;

// Median splits stop here; vcglib's own default.
constexpr unsigned FACES_PER_LEAF = 10;

// Larger than any squared distance in the unit box may grow to, and still far from overflow when
// squared.
constexpr double UNBOUNDED = 1e100;

VcgPoint to_vcg(const Point& point)
{
	return {point.x(), point.y(), point.z()};
}

Point from_vcg(const VcgPoint& point)
{
	return {point[0], point[1], point[2]};
}

struct Triangle {
	std::array<Point, 3> corners;
	Index face;
};

Point closest_on_segment(const Point& query, const Point& a, const Point& b)
{
	const Point along = b - a;
	const double t = (query - a).dot(along) / along.squaredNorm();
	return a + std::clamp(t, 0.0, 1.0) * along;
}

// The point of a triangle with an area that is nearest to the query: the foot of the perpendicular
// where that lies inside, else the nearest point of the three edges.
Point closest_on_triangle(const Point& query, const Triangle& triangle)
{
	const auto& [a, b, c] = triangle.corners;
	const Point normal = (b - a).cross(c - a);
	const auto inside_of = [&](const Point& from, const Point& to) {
		return (to - from).cross(query - from).dot(normal) >= 0;
	};
	if (inside_of(a, b) && inside_of(b, c) && inside_of(c, a)) {
		const Point unit = normal.normalized();
		return query - (query - a).dot(unit) * unit;
	}
	Point closest = closest_on_segment(query, a, b);
	for (const Point& candidate :
		 {closest_on_segment(query, b, c), closest_on_segment(query, c, a)}) {
		if ((candidate - query).squaredNorm() < (closest - query).squaredNorm())
			closest = candidate;
	}
	return closest;
}

// What vcglib's tree asks of the objects it holds.
struct GetPointer {
	const Triangle* operator()(const Triangle& triangle) const { return &triangle; }
};
struct GetBox {
	void operator()(const Triangle& triangle, vcg::Box3<double>& box) const
	{
		box.SetNull();
		for (const Point& corner : triangle.corners)
			box.Add(to_vcg(corner));
	}
};
struct GetBarycenter {
	void operator()(const Triangle& triangle, VcgPoint& barycenter) const
	{
		const auto& [a, b, c] = triangle.corners;
		barycenter = to_vcg((a + b + c) / 3.0);
	}
};
struct GetDistance {
	using QueryType = VcgPoint;
	bool operator()(
		const Triangle& triangle, const VcgPoint& query, double& distance, VcgPoint& closest) const
	{
		const Point point = closest_on_triangle(from_vcg(query), triangle);
		const double found = (point - from_vcg(query)).norm();
		if (!(found < distance))
			return false;
		distance = found;
		closest = to_vcg(point);
		return true;
	}
};

// vcglib's tree splits around the last of its objects, which takes quadratic time where they come
// in order, as the faces of a mesh do. A fixed shuffle (a linear congruential generator) undoes
// that.
void shuffle(std::vector<Triangle>& triangles)
{
	std::uint64_t state = 1;
	for (std::size_t i = triangles.size(); i > 1; --i) {
		state = state * 6364136223846793005U + 1442695040888963407U;
		std::swap(triangles[i - 1], triangles[(state >> 33U) % i]);
	}
}

} // namespace

// A grid would have to walk through all the empty space between a far query and the mesh; the tree
// does not.
class ClosestPointIndex::Tree {
public:
	explicit Tree(const TriangleMesh& mesh)
	{
		// The tree works in a unit box around the origin, so that neither a tiny nor a distant mesh
		// comes near to the tolerances inside.
		Eigen::AlignedBox3d box;
		for (const Face& face : mesh.faces) {
			for (const Index vertex : face)
				box.extend(mesh.positions[static_cast<std::size_t>(vertex)]);
		}
		if (!box.isEmpty()) {
			center_ = box.center();
			scale_ = box.sizes().maxCoeff();
		}
		for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
			const Face& face = mesh.faces[i];
			if (is_degenerate(mesh.positions, face))
				continue;
			Triangle triangle;
			triangle.face = static_cast<Index>(i);
			for (std::size_t k = 0; k < 3; ++k)
				triangle.corners[k] = normalized(mesh.positions[static_cast<std::size_t>(face[k])]);
			triangles_.push_back(triangle);
		}
		if (triangles_.empty())
			throw InvalidMesh(
				"none of the " + std::to_string(mesh.face_count()) +
				" faces of the reference has an area, so no point lies on it; choose another reference");
		shuffle(triangles_);
		GetPointer get_pointer;
		GetBox get_box;
		GetBarycenter get_barycenter;
		tree_.Set(
			triangles_.cbegin(),
			triangles_.cend(),
			get_pointer,
			get_box,
			get_barycenter,
			FACES_PER_LEAF);
	}

	ClosestPoint find(const Point& query)
	{
		const VcgPoint at = to_vcg(normalized(query));
		GetDistance get_distance;
		double distance = UNBOUNDED;
		VcgPoint closest(0, 0, 0);
		int no_marker = 0;
		const Triangle* triangle =
			tree_.GetClosest(get_distance, no_marker, at, UNBOUNDED, distance, closest);
		if (triangle == nullptr)
			triangle = &closest_of_all(at, distance, closest);
		return {center_ + scale_ * from_vcg(closest), scale_ * distance, triangle->face};
	}

private:
	Point normalized(const Point& point) const { return (point - center_) / scale_; }

	// The tree's bounds are rounded: from a million mesh sizes away no face may seem to be within
	// them.
	const Triangle& closest_of_all(const VcgPoint& query, double& distance, VcgPoint& closest) const
	{
		distance = std::numeric_limits<double>::infinity();
		const Triangle* best = &triangles_.front();
		for (const Triangle& triangle : triangles_) {
			if (GetDistance()(triangle, query, distance, closest))
				best = &triangle;
		}
		return *best;
	}

	Point center_ = Point::Zero();
	double scale_ = 1;
	std::vector<Triangle> triangles_;
	vcg::AABBBinaryTreeIndex<const Triangle, double> tree_;
};

ClosestPointIndex::ClosestPointIndex(const TriangleMesh& mesh) : tree_(std::make_unique<Tree>(mesh))
{
}

ClosestPointIndex::~ClosestPointIndex() = default;
ClosestPointIndex::ClosestPointIndex(ClosestPointIndex&&) noexcept = default;
ClosestPointIndex& ClosestPointIndex::operator=(ClosestPointIndex&&) noexcept = default;

ClosestPoint ClosestPointIndex::find(const Point& query) const
{
	return tree_->find(query);
}

} // namespace orthopoly
