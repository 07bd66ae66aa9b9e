// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <memory>

namespace orthopoly {

/// The point of a surface that is nearest to a given one.
struct ClosestPoint {
	Point position = Point::Zero();
	/// The caller's length unit.
	double distance = 0;
	/// The face it lies on.
	Index face = -1;
};

/// Finds closest points on a whole mesh, by a tree of boxes.
class ClosestPointIndex {
public:
	/// Throws InvalidMesh for a mesh without a face that has an area. The mesh may go away
	/// afterwards.
	explicit ClosestPointIndex(const TriangleMesh& mesh);
	~ClosestPointIndex();
	ClosestPointIndex(ClosestPointIndex&&) noexcept;
	ClosestPointIndex& operator=(ClosestPointIndex&&) noexcept;

	/// The closest point of the whole surface, however far. Safe to call from several threads.
	ClosestPoint find(const Point& query) const;

private:
	class Tree;
	std::unique_ptr<Tree> tree_;
};

} // namespace orthopoly
