// SPDX-License-Identifier: GPL-3.0-or-later
#include "local_heights.h"

#include "prefilter.h"
#include "sampling.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// Fewer degrees of freedom than this make a residual variance mean little.
constexpr std::size_t FEWEST_FREE = 4;

// Nodes on a line, or on a conic's worth of coincidences, do not fix a cubic.
constexpr double LEAST_CONDITION = 1e-10;

// Vertices that may move, below which what they tell is less steady than what all of them do.
constexpr Index FEWEST_MOVING = 500;

} // namespace

void VertexRings::collect(Index vertex, int rings)
{
	for (const Index i : vertices_)
		places_[at(i)] = 0;
	vertices_.assign(1, vertex);
	places_[at(vertex)] = 1;
	const IndexLists& around = workspace_.vertex_faces;
	std::size_t first = 0;
	for (int ring = 0; ring < rings; ++ring) {
		const std::size_t last = vertices_.size();
		for (; first < last; ++first) {
			const Index i = vertices_[first];
			for (const Index* face = around.begin(i); face != around.end(i); ++face) {
				for (const Index corner : workspace_.mesh.faces[at(*face)]) {
					if (places_[at(corner)] == 0) {
						vertices_.push_back(corner);
						places_[at(corner)] = static_cast<Index>(vertices_.size());
					}
				}
			}
		}
	}
}

std::vector<Point>
surface_below_heights(const Workspace& workspace, const std::vector<Point>& positions)
{
	std::vector<Point> smooth = positions;
	taubin_smooth(workspace, SURFACE_PAIRS, smooth);
	return smooth;
}

LocalHeights::LocalHeights(
	const Workspace& workspace, const std::vector<Point>& noisy, const std::vector<Point>& smooth) :
		workspace_(workspace),
		noisy_(noisy), smooth_(smooth), rings_(workspace)
{
}

bool LocalHeights::fit(Index vertex, int rings)
{
	Point normal = cross_product_around(workspace_, smooth_, vertex);
	const double length = normal.norm();
	rings_.collect(vertex, rings);
	const std::vector<Index>& ring = rings_.vertices();
	if (ring.size() < TERMS + FEWEST_FREE || !(length > 0))
		return false;
	normal /= length;
	const Point tangent = normal.unitOrthogonal();
	const Point bitangent = normal.cross(tangent);

	const Point& center = smooth_[at(vertex)];
	double extent = 0;
	for (const Index i : ring)
		extent = std::max(extent, (smooth_[at(i)] - center).squaredNorm());
	if (!(extent > 0))
		return false;
	const double scale = 1.0 / std::sqrt(extent);
	const auto count = static_cast<Eigen::Index>(ring.size());
	basis_.resize(Eigen::NoChange, count);
	heights_.resize(count);
	for (Eigen::Index k = 0; k < count; ++k) {
		const std::size_t i = at(ring[static_cast<std::size_t>(k)]);
		const Point node = scale * (smooth_[i] - center);
		const double x = node.dot(tangent);
		const double y = node.dot(bitangent);
		basis_.col(k) << 1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
		heights_[k] = (noisy_[i] - center).dot(normal);
	}
	Gram gram = Gram::Zero();
	gram.selfadjointView<Eigen::Lower>().rankUpdate(basis_);
	const Eigen::LLT<Gram> cholesky(gram);
	if (cholesky.info() != Eigen::Success || !(cholesky.rcond() > LEAST_CONDITION))
		return false;
	cholesky.matrixL().solveInPlace(basis_);
	const Eigen::Matrix<double, TERMS, 1> coefficients = basis_.lazyProduct(heights_);
	residual_ = heights_;
	residual_ -= basis_.transpose().lazyProduct(coefficients);
	return true;
}

double LocalHeights::median_ratio()
{
	const double square = residual_.squaredNorm() / static_cast<double>(residual_.size());
	sizes_.assign(residual_.begin(), residual_.end());
	for (double& size : sizes_)
		size = std::abs(size);
	return square > 0 ? DEVIATION_PER_MEDIAN * quantile(sizes_, 0.5) / std::sqrt(square) : 1;
}

double LocalHeights::edge_correlation() const
{
	// Products and squares over the pairs, as found and as white noise of variance one would give.
	double products = 0;
	double squares = 0;
	double white_products = 0;
	double white_squares = 0;
	const IndexLists& around = workspace_.vertex_faces;
	for (Eigen::Index a = 0; a < residual_.size(); ++a) {
		const Index i = rings_.vertices()[static_cast<std::size_t>(a)];
		const double left_a = 1 - basis_.col(a).squaredNorm();
		for (const Index* face = around.begin(i); face != around.end(i); ++face) {
			for (const Index corner : workspace_.mesh.faces[at(*face)]) {
				const Eigen::Index b = rings_.place(corner);
				if (b <= a)
					continue;
				const double left_b = 1 - basis_.col(b).squaredNorm();
				products += residual_[a] * residual_[b];
				squares += 0.5 * (residual_[a] * residual_[a] + residual_[b] * residual_[b]);
				white_products -= basis_.col(a).dot(basis_.col(b));
				white_squares += 0.5 * (left_a + left_b);
			}
		}
	}
	return squares > 0 && white_squares > 0 ? products / squares - white_products / white_squares :
											  0;
}

double area_around(const Workspace& workspace, const std::vector<Point>& positions, Index vertex)
{
	double area = 0;
	const IndexLists& around = workspace.vertex_faces;
	for (const Index* face = around.begin(vertex); face != around.end(vertex); ++face)
		area += face_cross_product(positions, workspace.mesh.faces[at(*face)]).norm();
	return area;
}

std::vector<double> areas_around(const Workspace& workspace, const std::vector<Point>& positions)
{
	std::vector<double> areas(positions.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		areas[i] = area_around(workspace, positions, static_cast<Index>(i));
	});
	return areas;
}

std::vector<Index>
sample_vertices(const Workspace& workspace, const std::vector<Point>& positions, Index wanted)
{
	const std::vector<double> areas = areas_around(workspace, positions);
	if (workspace.mesh.fixed.empty())
		return sample_by_value(areas, wanted);
	std::vector<double> moving = areas;
	Index count = 0;
	for (std::size_t i = 0; i < moving.size(); ++i) {
		if (workspace.mesh.fixed[i] != 0)
			moving[i] = 0;
		count += moving[i] > 0 ? 1 : 0;
	}
	return sample_by_value(count < FEWEST_MOVING ? areas : moving, wanted);
}

} // namespace orthopoly
