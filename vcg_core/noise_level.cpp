// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_level.h"

#include "anisotropy.h"
#include "interpolation.h"
#include "lattice.h"
#include "local_heights.h"
#include "prefilter.h"
#include "residual_variances.h"
#include "sampling.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace orthopoly {

namespace {

// The share of the variances at which there are outliers among the neighbours.
constexpr Quantile ORDINARY = {0.5, 0};

// The quantile of so many variances is steady to about one per cent.
constexpr Index SAMPLES = 20000;

// Polynomials that tell the kind of noise: wide ones, since narrow ones follow an outlier, and
// fewer, since they are slow.
constexpr int WIDE_RINGS = 4;
constexpr Index WIDE_SAMPLES = 2000;

// Edges grow with the rings as well, but similar faces leave less than this part of what whole
// rings do then; of detail they leave the second part at least.
constexpr double EDGES = 0.85;
constexpr double NO_EDGES = 0.91;

// Where a mesh is so coarse that edges are everywhere, polynomials over whole rings take them for
// noise. So do others, over the faces alone whose normals are within this cosine (37 degrees) of
// the vertex's, and a few of them tell what the level is without the edges.
constexpr double SIMILAR = 0.8;
constexpr Index SIMILAR_SAMPLES = 5000;

// Triangles lower than this many deviations of the noise are turned by it so far that heights over
// the smoothed surface miss a part of it: half of it where they are half a deviation low. What is
// read at them is left out, but not at this share of the vertices, where triangles are highest.
constexpr double STEADY_HEIGHT = 1.5;
constexpr double LEAST_STEADY = 0.4;

// Each time with the level of the last; from the third on it stays.
constexpr int STEADY_ROUNDS = 3;

// Where long thin triangles make places this crowded, nearly all of them are lower than strong
// noise. Heights over a steadier surface miss less of it then: after so many Taubin pairs, near
// neighbours first, instead of those of `surface_below_heights`.
constexpr double CROWDED = 1.5;
constexpr double STEADY_PAIRS = 12;

// The same for all triangles where the noise is stronger than this. Not where it is weaker: what
// so much smoothing takes off the surface would count as noise.
constexpr double STRONG = 0.5;
constexpr double STEADIEST_PAIRS = 40;

// What rounding to whole steps leaves: evenly between half a step to either side.
constexpr double ROUNDING = 0.2887;

// Of the noise of rounding similar faces show so much at least where they show more than in four
// fifths of all places: all of it on curved surfaces, half of it where most faces lie along the
// lattice, a tenth of what was drawn on one.
constexpr Quantile HIGH = {0.8, 0.8416};
constexpr double SEEN = 0.38;

constexpr Index GRAIN = 64;

// Rings of vertices of a polynomial.
constexpr int RINGS = 2;

/// Quadratic height polynomials over the similar faces around vertices.
class SimilarHeights {
public:
	SimilarHeights(
		const Workspace& workspace,
		const std::vector<Point>& noisy,
		const std::vector<Point>& smooth) :
			workspace_(workspace),
			noisy_(noisy), smooth_(smooth), ring_(workspace),
			stamps_(workspace.mesh.positions.size(), -1)
	{
	}

	ResidualVariance fit(Index vertex)
	{
		Point normal = cross_product_around(workspace_, smooth_, vertex);
		const double length = normal.norm();
		if (!(length > 0))
			return {};
		normal /= length;
		collect(vertex, normal);
		if (members_.size() < TERMS + FEWEST_FREE)
			return {};
		return {
			residual(smooth_[at(vertex)], normal), static_cast<double>(members_.size() - TERMS)};
	}

private:
	static constexpr std::size_t TERMS = 6;
	static constexpr std::size_t FEWEST_FREE = 4;
	using Terms = Eigen::Matrix<double, static_cast<int>(TERMS), 1>;
	using Gram = Eigen::Matrix<double, static_cast<int>(TERMS), static_cast<int>(TERMS)>;

	// The corners of the similar faces around the vertex and its neighbours.
	void collect(Index vertex, const Point& normal)
	{
		ring_.collect(vertex, 1);
		members_.clear();
		const IndexLists& around = workspace_.vertex_faces;
		for (const Index i : ring_.vertices()) {
			for (const Index* face = around.begin(i); face != around.end(i); ++face) {
				const Face& corners = workspace_.mesh.faces[at(*face)];
				const Point cross = face_cross_product(smooth_, corners);
				if (!(cross.dot(normal) > SIMILAR * cross.norm()))
					continue;
				for (const Index corner : corners) {
					if (stamps_[at(corner)] != vertex)
						members_.push_back(corner);
					stamps_[at(corner)] = vertex;
				}
			}
		}
	}

	// The residual variance over the members; negative where they do not fix a quadratic.
	double residual(const Point& center, const Point& normal) const
	{
		const Point tangent = normal.unitOrthogonal();
		const Point bitangent = normal.cross(tangent);
		double extent = 0;
		for (const Index i : members_)
			extent = std::max(extent, (smooth_[at(i)] - center).norm());
		if (!(extent > 0))
			return -1;
		const double scale = 1 / extent;
		Gram gram = Gram::Zero();
		Terms moments = Terms::Zero();
		double energy = 0;
		for (const Index i : members_) {
			const Point node = scale * (smooth_[at(i)] - center);
			const double x = node.dot(tangent);
			const double y = node.dot(bitangent);
			const double height = (noisy_[at(i)] - center).dot(normal);
			Terms terms;
			terms << 1, x, y, x * x, x * y, y * y;
			gram.selfadjointView<Eigen::Lower>().rankUpdate(terms);
			moments += height * terms;
			energy += height * height;
		}
		const Eigen::LLT<Gram> cholesky(gram);
		if (cholesky.info() != Eigen::Success || !(cholesky.rcond() > LEAST_CONDITION))
			return -1;
		const Terms solved = cholesky.matrixL().solve(moments);
		return std::max(0.0, energy - solved.squaredNorm()) /
			   static_cast<double>(members_.size() - TERMS);
	}

	// Nodes nearly on a conic do not fix a quadratic.
	static constexpr double LEAST_CONDITION = 1e-8;

	const Workspace& workspace_;
	const std::vector<Point>& noisy_;
	const std::vector<Point>& smooth_;
	VertexRings ring_;
	std::vector<Index> members_;
	/// The vertex each was last collected for.
	std::vector<Index> stamps_;
};

// How noise across the normals lengthens edges, per square of it in edge lengths: an edge takes
// half of the noise of both ends across itself, 2 / 2, and a little more in the next order.
constexpr double LENGTHENING = 1.2;

// The mean edge length of the surface below the noise, whose deviation along the normals is given
// in the caller's length unit.
//
// Smoothing takes the noise out of the edges, but evens irregular triangles out and shortens the
// mean so. The noisy edges without their part along the normals keep the irregularity, and the
// noise across the normals, if there is any, lengthens them. Both err to one side then, if the
// latter are shortened by what noise in all directions would lengthen them.
double clean_edge_length(
	const Workspace& workspace,
	const std::vector<Point>& noisy,
	const std::vector<Point>& smooth,
	double sigma)
{
	std::vector<Point> flattened = noisy;
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const Point normal = cross_product_around(workspace, smooth, static_cast<Index>(i));
		const double square = normal.squaredNorm();
		if (square > 0)
			flattened[i] += (smooth[i] - noisy[i]).dot(normal) / square * normal;
	});
	const double smoothed = mean_edge_length(workspace, smooth);
	if (!(smoothed > 0))
		return 0;
	const double relative = sigma / smoothed;
	return std::max(
		smoothed, mean_edge_length(workspace, flattened) / (1 + LENGTHENING * relative * relative));
}

// The mean height of the triangles around each of some vertices, over their longest sides.
std::vector<double> triangle_heights(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Index>& vertices)
{
	std::vector<double> heights(vertices.size(), 0);
	workspace.execution.for_each(static_cast<Index>(vertices.size()), [&](std::size_t i) {
		const IndexLists& around = workspace.vertex_faces;
		const Index vertex = vertices[i];
		for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it) {
			const Face& face = workspace.mesh.faces[static_cast<std::size_t>(*it)];
			const double longest = std::sqrt(longest_edge_squared(positions, face));
			if (longest > 0)
				heights[i] += face_cross_product(positions, face).norm() / longest;
		}
		heights[i] /= std::max<double>(1, around.size(vertex));
	});
	return heights;
}

// Takes the variances away where the triangles around the vertex are lower than that.
void leave_out_lower(
	const std::vector<double>& heights, double least, std::vector<ResidualVariance>& variances)
{
	for (std::size_t i = 0; i < variances.size(); ++i) {
		if (heights[i] < least)
			variances[i].value = -1;
	}
}

// The height of triangles from which the variances of as many vertices tell all of the noise.
double least_steady_height(
	const std::vector<double>& heights, const std::vector<ResidualVariance>& variances)
{
	std::vector<double> values = heights;
	const double largest = quantile(values, 1 - LEAST_STEADY);
	double least = 0;
	for (int round = 0; round < STEADY_ROUNDS; ++round) {
		std::vector<ResidualVariance> kept = variances;
		leave_out_lower(heights, least, kept);
		least = std::min(largest, STEADY_HEIGHT * level_of(kept, FLAT));
	}
	return least;
}

// Of the vertices with these numbers in the sample.
std::vector<ResidualVariance> similar_variances(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth,
	const std::vector<Index>& sample,
	const std::vector<std::size_t>& numbers)
{
	std::vector<ResidualVariance> variances(sample.size());
	std::vector<SimilarHeights> heights(
		static_cast<std::size_t>(workspace.execution.threads()),
		SimilarHeights(workspace, positions, smooth));
	workspace.execution.parallel_for(
		static_cast<Index>(numbers.size()), GRAIN, [&](Index begin, Index end, int worker) {
			for (Index k = begin; k < end; ++k) {
				const std::size_t i = numbers[at(k)];
				variances[i] = heights[static_cast<std::size_t>(worker)].fit(sample[i]);
			}
		});
	return variances;
}

// What heights over that surface tell.
NoiseLevels levels_over(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth)
{
	NoiseSample read;
	read.vertices = sample_vertices(workspace, positions, SAMPLES);
	const std::vector<Index>& sample = read.vertices;
	std::vector<LocalHeights> heights(
		static_cast<std::size_t>(workspace.execution.threads()),
		LocalHeights(workspace, positions, smooth));
	// Fits polynomials over so many rings at the vertices with these numbers in the sample, and
	// calls visit(local, i) where there is a fit.
	const auto fit_each = [&](const std::vector<std::size_t>& numbers, int rings, auto visit) {
		workspace.execution.parallel_for(
			static_cast<Index>(numbers.size()), GRAIN, [&](Index begin, Index end, int worker) {
				LocalHeights& local = heights[static_cast<std::size_t>(worker)];
				for (Index k = begin; k < end; ++k) {
					if (local.fit(sample[numbers[at(k)]], rings))
						visit(local, numbers[at(k)]);
				}
			});
	};
	std::vector<double> areas;
	areas.reserve(sample.size());
	for (const Index i : sample)
		areas.push_back(area_around(workspace, positions, i));
	const std::vector<std::size_t> all =
		subsample_by_value(areas, static_cast<Index>(sample.size()));
	const std::vector<std::size_t> few = subsample_by_value(areas, WIDE_SAMPLES);
	VariancesByRings& variances = read.whole;
	std::vector<double> ratios(sample.size(), -1);
	for (std::size_t k = 0; k < variances.size(); ++k) {
		variances[k].resize(sample.size());
		const int rings = RINGS + static_cast<int>(k);
		fit_each(k == 0 ? all : few, rings, [&](LocalHeights& local, std::size_t i) {
			variances[k][i] = {local.variance(), local.free()};
			if (rings == WIDE_RINGS)
				ratios[i] = local.median_ratio();
		});
	}
	ratios.erase(std::remove(ratios.begin(), ratios.end(), -1), ratios.end());
	NoiseLevels result;
	if (!ratios.empty())
		read.median_ratio = quantile(ratios, 0.5);
	result.median_ratio = read.median_ratio;
	const std::vector<double> triangles = triangle_heights(workspace, smooth, sample);
	const double least = least_steady_height(triangles, variances[0]);
	for (std::vector<ResidualVariance>& of_rings : variances)
		leave_out_lower(triangles, least, of_rings);
	const double flat = level_of(variances[0], FLAT);
	const double length = clean_edge_length(workspace, positions, smooth, flat);
	if (length > 0) {
		read.similar = similar_variances(
			workspace, positions, smooth, sample, subsample_by_value(areas, SIMILAR_SAMPLES));
		leave_out_lower(triangles, least, read.similar);
		const double without_edges = level_of(read.similar, SIMILAR_FLAT);
		result.rough = level_beside_edges(flat, without_edges, length);
		result.flat = result.rough;
		const double share = way_between(EDGES, NO_EDGES, without_edges / flat);
		if (share > 0) {
			const double white = std::sqrt(share_of_noise(variances)) * flat / length;
			result.flat -= share * std::max(0.0, result.rough - white);
		}
		result.drawn = share_drawn(workspace, positions, sample, result.flat * length);
		read.edge_length = length;
		result.uneven = find_uneven_noise(workspace, positions, smooth, read);
		result.ordinary = level_of(variances[0], ORDINARY) / length;
		const double rounding = lattice_step(workspace, positions) * ROUNDING;
		if (rounding > 0 && level_of(read.similar, HIGH) > SEEN * rounding * length) {
			result.rounding = rounding;
			result.drawn = 0;
			result.flat = std::max(result.flat, rounding);
			result.rough = std::max(result.rough, rounding);
		}
	}
	return result;
}

// The surface below the heights, smoothed more where the noise is strong or triangles are long and
// thin.
std::vector<Point> steadier_surface(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const Anisotropy& anisotropy,
	bool strong)
{
	std::vector<double> pairs(positions.size(), strong ? STEADIEST_PAIRS : SURFACE_PAIRS);
	std::vector<Point> surface = positions;
	if (anisotropy.shares.empty()) {
		taubin_smooth(workspace, pairs, surface);
		return surface;
	}
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		pairs[i] = std::max(pairs[i], between(SURFACE_PAIRS, STEADY_PAIRS, anisotropy.shares[i]));
	});
	const NearFirst near_first = {anisotropy.shares, anisotropy.smoothed};
	taubin_smooth(workspace, pairs, surface, &near_first);
	return surface;
}

} // namespace

NoiseLevels estimate_noise_levels(const Workspace& workspace, const std::vector<Point>& positions)
{
	return estimate_noise_levels(workspace, positions, surface_below_heights(workspace, positions));
}

NoiseLevels estimate_noise_levels(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth)
{
	NoiseLevels levels = levels_over(workspace, positions, smooth);
	const Anisotropy anisotropy = find_anisotropy(workspace, positions);
	const bool strong = levels.rough > STRONG;
	if (!strong && anisotropy.crowding < CROWDED)
		return levels;
	const NoiseLevels steadier = levels_over(
		workspace, positions, steadier_surface(workspace, positions, anisotropy, strong));
	return steadier.rough > levels.rough ? steadier : levels;
}

double estimate_noise_level(const Workspace& workspace, const std::vector<Point>& positions)
{
	const NoiseLevels levels = estimate_noise_levels(workspace, positions);
	const double even = (1 - levels.drawn) * levels.flat;
	return even + levels.uneven.certainty * (levels.uneven.level - even);
}

} // namespace orthopoly
