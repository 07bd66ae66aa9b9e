// SPDX-License-Identifier: GPL-3.0-or-later
#include "closest_point.h"

#include "errors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace orthopoly {

namespace {

// A box costs about as much to look at as half a triangle.
constexpr Index FACES_PER_LEAF = 4;

// Halving two thousand million faces down to a leaf takes 29 levels, and each leaves one half for
// later.
constexpr std::size_t DEEPEST = 32;

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

using Box = Eigen::AlignedBox3d;

Box box_of(const Triangle& triangle)
{
	Box box(triangle.corners[0]);
	return box.extend(triangle.corners[1]).extend(triangle.corners[2]);
}

// A triangle while the tree is built: small, because it is moved once a level.
struct Item {
	Point centroid;
	Index triangle;
};

// Its first half is the next node, the second half starts at `second`; a leaf has none and holds
// triangles [begin, end).
struct Node {
	Box box;
	Index begin;
	Index end;
	Index second = 0;
};

} // namespace

// A grid would have to walk through all the empty space between a far query and the mesh; a tree of
// boxes does not. That of vcglib (2025.07) can do neither two queries at a time nor one without
// reserving room for all triangles, and took eight times as long over a million faces.
class ClosestPointIndex::Tree {
public:
	explicit Tree(const TriangleMesh& mesh)
	{
		// The tree works in a unit box around the origin, so that areas and squares of tiny meshes
		// are still numbers.
		Box box;
		for (const Face& face : mesh.faces) {
			for (const Index vertex : face)
				box.extend(mesh.positions[static_cast<std::size_t>(vertex)]);
		}
		if (!box.isEmpty()) {
			center_ = box.center();
			scale_ = box.sizes().maxCoeff();
		}
		const std::vector<Triangle> triangles = triangles_of(mesh);
		if (triangles.empty())
			throw InvalidMesh(
				"none of the " + std::to_string(mesh.face_count()) +
				" faces of the reference has an area, so no point lies on it; choose another reference");
		std::vector<Item> items;
		items.reserve(triangles.size());
		for (const Triangle& triangle : triangles) {
			const auto& [a, b, c] = triangle.corners;
			items.push_back({(a + b + c) / 3.0, static_cast<Index>(items.size())});
		}
		nodes_.reserve(items.size());
		divide(items, 0, static_cast<Index>(items.size()));
		triangles_.reserve(triangles.size());
		for (const Item& item : items)
			triangles_.push_back(triangles[static_cast<std::size_t>(item.triangle)]);
		for (std::size_t i = nodes_.size(); i-- > 0;)
			nodes_[i].box = box_of_node(i);
	}

	ClosestPoint find(const Point& query) const
	{
		const Point at = normalized(query);
		double best = std::numeric_limits<double>::infinity();
		ClosestPoint result;
		// Nodes to be looked at, with their squared distances.
		std::array<std::pair<double, std::size_t>, DEEPEST> later;
		std::size_t waiting = 0;
		later[waiting++] = {0, 0};
		while (waiting > 0) {
			auto [bound, node] = later[--waiting];
			while (bound < best && nodes_[node].second != 0) {
				std::size_t near = node + 1;
				auto far = static_cast<std::size_t>(nodes_[node].second);
				bound = nodes_[near].box.squaredExteriorDistance(at);
				double far_bound = nodes_[far].box.squaredExteriorDistance(at);
				if (far_bound < bound) {
					std::swap(near, far);
					std::swap(bound, far_bound);
				}
				if (far_bound < best)
					later[waiting++] = {far_bound, far};
				node = near;
			}
			if (bound < best)
				look_through(nodes_[node], at, best, result);
		}
		result.distance = scale_ * std::sqrt(best);
		result.position = center_ + scale_ * result.position;
		return result;
	}

private:
	Point normalized(const Point& point) const { return (point - center_) / scale_; }

	std::vector<Triangle> triangles_of(const TriangleMesh& mesh) const
	{
		std::vector<Triangle> triangles;
		triangles.reserve(mesh.faces.size());
		for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
			const Face& face = mesh.faces[i];
			if (is_degenerate(mesh.positions, face))
				continue;
			Triangle triangle;
			triangle.face = static_cast<Index>(i);
			for (std::size_t k = 0; k < 3; ++k)
				triangle.corners[k] = normalized(mesh.positions[static_cast<std::size_t>(face[k])]);
			triangles.push_back(triangle);
		}
		return triangles;
	}

	// Adds the node of items [begin, end), which are put into order, and all below it.
	void divide(std::vector<Item>& items, Index begin, Index end)
	{
		const std::size_t node = nodes_.size();
		nodes_.push_back({Box(), begin, end});
		if (end - begin <= FACES_PER_LEAF)
			return;
		Box centroids;
		for (Index i = begin; i < end; ++i)
			centroids.extend(items[static_cast<std::size_t>(i)].centroid);
		Eigen::Index axis = 0;
		centroids.sizes().maxCoeff(&axis);
		const Index middle = begin + (end - begin) / 2;
		std::nth_element(
			items.begin() + begin,
			items.begin() + middle,
			items.begin() + end,
			[axis](const Item& a, const Item& b) {
				return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis] :
															  a.triangle < b.triangle;
			});
		divide(items, begin, middle);
		nodes_[node].second = static_cast<Index>(nodes_.size());
		divide(items, middle, end);
	}

	// That of the triangles in a leaf, of the two halves else, which have theirs already.
	Box box_of_node(std::size_t i) const
	{
		const Node& node = nodes_[i];
		if (node.second != 0)
			return nodes_[i + 1].box.merged(nodes_[static_cast<std::size_t>(node.second)].box);
		Box box;
		for (Index k = node.begin; k < node.end; ++k)
			box.extend(box_of(triangles_[static_cast<std::size_t>(k)]));
		return box;
	}

	void look_through(const Node& leaf, const Point& at, double& best, ClosestPoint& result) const
	{
		for (Index k = leaf.begin; k < leaf.end; ++k) {
			const Triangle& triangle = triangles_[static_cast<std::size_t>(k)];
			const Point point = closest_on_triangle(at, triangle);
			const double found = (point - at).squaredNorm();
			if (found < best) {
				best = found;
				result.position = point;
				result.face = triangle.face;
			}
		}
	}

	Point center_ = Point::Zero();
	double scale_ = 1;
	std::vector<Triangle> triangles_;
	std::vector<Node> nodes_;
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
