// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <Eigen/Core>
#include <vector>

namespace orthopoly {

/// Collects the vertices within some rings of one, over shared faces, nearest rings first. Keeps
/// scratch memory (4 bytes a vertex), so use one object a thread.
class VertexRings {
public:
	/// The workspace must outlive the collector.
	explicit VertexRings(const Workspace& workspace) :
			workspace_(workspace), places_(workspace.mesh.positions.size(), 0)
	{
	}

	/// Fills vertices(), the vertex itself first.
	void collect(Index vertex, int rings);

	const std::vector<Index>& vertices() const { return vertices_; }
	/// Where a vertex stands in vertices(); -1 for those outside.
	Index place(Index vertex) const { return places_[static_cast<std::size_t>(vertex)] - 1; }

private:
	const Workspace& workspace_;
	/// Places plus one, zero for those outside.
	std::vector<Index> places_;
	std::vector<Index> vertices_;
};

/// Goes through all vertices on all threads, with a collector of rings for each.
class RingWorkers {
public:
	/// The workspace must outlive them.
	explicit RingWorkers(const Workspace& workspace) :
			workspace_(workspace),
			rings_(static_cast<std::size_t>(workspace.execution.threads()), VertexRings(workspace))
	{
	}

	/// Calls `body(vertex, rings)`. Throws Cancelled.
	template<class Body>
	void for_each_vertex(const Body& body)
	{
		constexpr Index GRAIN = 256;
		workspace_.execution.parallel_for(
			workspace_.mesh.vertex_count(), GRAIN, [&](Index begin, Index end, int worker) {
				for (Index i = begin; i < end; ++i)
					body(i, rings_[static_cast<std::size_t>(worker)]);
			});
	}

private:
	const Workspace& workspace_;
	std::vector<VertexRings> rings_;
};

/// Taubin pairs of the surface that heights are measured from.
constexpr double SURFACE_PAIRS = 4;

/// The surface that heights are measured from: that of the positions, smoothed until normals of a
/// mesh with noise of half an edge length are steady. #V.
std::vector<Point>
surface_below_heights(const Workspace& workspace, const std::vector<Point>& positions);

/// Cubic height polynomials fitted around vertices, one at a time, and what they leave of the
/// heights: noise where the surface is smooth. Ten terms are the fewest that take ordinary
/// curvature and its change out of the residual. Keeps scratch memory, so use one object a thread.
class LocalHeights {
public:
	/// @param noisy  #V, gives the heights
	/// @param smooth #V, gives the normals and where in the plane across them a vertex lies: read
	/// off the noisy mesh, both would hide a part of strong noise from the residual
	LocalHeights(
		const Workspace& workspace,
		const std::vector<Point>& noisy,
		const std::vector<Point>& smooth);

	/// Collects the vertices within so many rings of one (over shared faces) and fits. False where
	/// there is no normal or the nodes leave too little to judge the fit by.
	bool fit(Index vertex, int rings);

	/// Degrees of freedom of the residual: vertices less terms.
	double free() const { return static_cast<double>(rings_.vertices().size()) - TERMS; }
	/// Residual variance of the last fit, in the square of the caller's length unit.
	double variance() const { return residual_.squaredNorm() / free(); }
	/// The deviation that the median of the absolute residuals tells over the one their squares
	/// tell: 1 for Gaussian noise, less where a few large ones make up the noise.
	double median_ratio();
	/// Mean product of the residuals of two vertices that share a face over their mean square, less
	/// what independent noise would give: zero but for chance where the noise is white.
	double edge_correlation() const;

private:
	static constexpr int TERMS = 10;
	using Gram = Eigen::Matrix<double, TERMS, TERMS>;

	const Workspace& workspace_;
	const std::vector<Point>& noisy_;
	const std::vector<Point>& smooth_;
	VertexRings rings_;
	/// Terms by vertices of the ring: monomials at the nodes, orthonormal polynomials after a fit.
	Eigen::Matrix<double, TERMS, Eigen::Dynamic> basis_;
	Eigen::VectorXd heights_;
	Eigen::VectorXd residual_;
	std::vector<double> sizes_;
};

/// Sum of the face areas around a vertex, times two; zero for one without a face.
double area_around(const Workspace& workspace, const std::vector<Point>& positions, Index vertex);

/// The same around every vertex, #V.
std::vector<double> areas_around(const Workspace& workspace, const std::vector<Point>& positions);

/// About `wanted` of the vertices that may move, to read off them what they are like: the same ones
/// however they are numbered (`sample_by_value` of the areas around them). Those that are fixed
/// count as well where too few others have faces.
std::vector<Index>
sample_vertices(const Workspace& workspace, const std::vector<Point>& positions, Index wanted);

} // namespace orthopoly
