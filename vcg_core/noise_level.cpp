// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_level.h"

#include "prefilter.h"
#include "sampling.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// Terms of a cubic polynomial in two variables: the lowest degree that takes ordinary curvature and
// its change out of the residual.
constexpr int TERMS = 10;

// Fewer degrees of freedom than this make a residual variance mean little.
constexpr std::size_t FEWEST_FREE = 4;

// The share of the residual variances that is taken as free of features, which only ever add to
// them.
constexpr double QUANTILE = 0.35;

// Root of that quantile of chi-square over nine degrees of freedom (a 2-ring of 19 vertices), over
// its mean.
constexpr double QUANTILE_RATIO = 0.89;

// The quantile of so many variances is steady to about one per cent.
constexpr Index SAMPLES = 20000;

// Taubin pairs after which the normals of a mesh with noise of half an edge length are steady.
constexpr double SMOOTHING_PAIRS = 4;

constexpr Index GRAIN = 64;

using Terms = Eigen::Matrix<double, TERMS, 1>;
using Gram = Eigen::Matrix<double, TERMS, TERMS>;

// Appends the vertices that share a face with one.
void append_neighbors(const Workspace& workspace, Index vertex, std::vector<Index>& ring)
{
	const IndexLists& around = workspace.vertex_faces;
	for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it) {
		for (const Index neighbor : workspace.mesh.faces[static_cast<std::size_t>(*it)]) {
			if (std::find(ring.begin(), ring.end(), neighbor) == ring.end())
				ring.push_back(neighbor);
		}
	}
}

/// The mesh as given, and smoothed.
struct Surfaces {
	const std::vector<Point>& noisy;
	/// Gives the normals and where in the plane across them a vertex lies: read off the noisy
	/// mesh, both would hide a part of strong noise from the residual.
	const std::vector<Point>& smooth;
};

// Residual variance of a cubic height polynomial over the 2-ring of a vertex; negative where there
// is none.
double residual_variance(
	const Workspace& workspace, const Surfaces& surfaces, Index vertex, std::vector<Index>& ring)
{
	Point normal = Point::Zero();
	const IndexLists& around = workspace.vertex_faces;
	for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it)
		normal += face_cross_product(
			surfaces.smooth, workspace.mesh.faces[static_cast<std::size_t>(*it)]);
	ring.assign(1, vertex);
	append_neighbors(workspace, vertex, ring);
	const std::size_t first_ring = ring.size();
	for (std::size_t i = 1; i < first_ring; ++i)
		append_neighbors(workspace, ring[i], ring);
	const double length = normal.norm();
	if (ring.size() < TERMS + FEWEST_FREE || !(length > 0))
		return -1;
	normal /= length;
	const Point tangent = normal.unitOrthogonal();
	const Point bitangent = normal.cross(tangent);

	const Point& center = surfaces.smooth[static_cast<std::size_t>(vertex)];
	double extent = 0;
	for (const Index i : ring)
		extent =
			std::max(extent, (surfaces.smooth[static_cast<std::size_t>(i)] - center).squaredNorm());
	if (!(extent > 0))
		return -1;
	const double scale = 1.0 / std::sqrt(extent);
	Gram gram = Gram::Zero();
	Terms moments = Terms::Zero();
	double energy = 0;
	for (const Index i : ring) {
		const auto at = static_cast<std::size_t>(i);
		const Point node = scale * (surfaces.smooth[at] - center);
		const double x = node.dot(tangent);
		const double y = node.dot(bitangent);
		const double height = scale * (surfaces.noisy[at] - center).dot(normal);
		Terms terms;
		terms << 1, x, y, x * x, x * y, y * y, x * x * x, x * x * y, x * y * y, y * y * y;
		gram.selfadjointView<Eigen::Lower>().rankUpdate(terms);
		moments += height * terms;
		energy += height * height;
	}
	const Eigen::LLT<Gram> cholesky(gram);
	// Nodes on a line, or on a conic's worth of coincidences, do not fix a cubic.
	if (cholesky.info() != Eigen::Success || !(cholesky.rcond() > 1e-10))
		return -1;
	const Terms coefficients = cholesky.matrixL().solve(moments);
	const double residual = std::max(0.0, energy - coefficients.squaredNorm());
	return residual / (scale * scale * static_cast<double>(ring.size() - TERMS));
}

} // namespace

double estimate_noise_level(const Workspace& workspace, const std::vector<Point>& positions)
{
	const Index vertex_count = workspace.mesh.vertex_count();
	std::vector<double> areas(static_cast<std::size_t>(vertex_count), 0.0);
	for (Index i = 0; i < vertex_count; ++i) {
		const IndexLists& around = workspace.vertex_faces;
		for (const Index* it = around.begin(i); it != around.end(i); ++it)
			areas[static_cast<std::size_t>(i)] +=
				face_cross_product(positions, workspace.mesh.faces[static_cast<std::size_t>(*it)])
					.norm();
	}
	std::vector<Point> smooth = positions;
	taubin_smooth(workspace, SMOOTHING_PAIRS, smooth);
	const Surfaces surfaces {positions, smooth};
	const std::vector<Index> sample = sample_by_value(areas, SAMPLES);
	std::vector<double> variances(sample.size());
	std::vector<std::vector<Index>> rings(static_cast<std::size_t>(workspace.execution.threads()));
	workspace.execution.parallel_for(
		static_cast<Index>(sample.size()), GRAIN, [&](Index begin, Index end, int worker) {
			for (Index i = begin; i < end; ++i) {
				const auto at = static_cast<std::size_t>(i);
				variances[at] = residual_variance(
					workspace, surfaces, sample[at], rings[static_cast<std::size_t>(worker)]);
			}
		});
	variances.erase(
		std::remove_if(variances.begin(), variances.end(), [](double v) { return v < 0; }),
		variances.end());
	// Noise lengthens the edges: those of the smoothed mesh are closer to the true ones.
	const double length = mean_edge_length(workspace, smooth);
	return length > 0 ? std::sqrt(quantile(variances, QUANTILE)) / (QUANTILE_RATIO * length) : 0;
}

} // namespace orthopoly
