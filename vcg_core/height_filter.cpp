// SPDX-License-Identifier: GPL-3.0-or-later
#include "height_filter.h"

#include "scattered_polynomials.h"
#include "tangent_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace orthopoly {

namespace {

using Fit = ScatteredFit<3, 1>;
using Moments = Fit::Moments;

// Vertices from which a degree is fitted: half as many again as its terms.
constexpr int VERTICES_FOR_CUBIC = 16;
constexpr int VERTICES_FOR_QUADRATIC = 9;
constexpr int VERTICES_FOR_PLANE = 5;

// The constant and the slopes are what is looked for; only what is beyond them is selected.
constexpr std::size_t PLANE_TERMS = 3;
constexpr std::uint32_t PLANE_BITS = 7;

// Weight of the residual variance beyond the noise, over the mean square radius, in the variance of
// a slope: a height left unexplained may well be a slope at the centre, hence more than one.
constexpr double BIAS_SHARE = 8;

// What the noise may be above its estimate before the residual counts as unexplained.
constexpr double MARGIN = 1.25;

// Past this many times the least risk so far, growing further has not paid.
constexpr double HOPELESS = 3;

// Bounds the weight of votes: (4 degrees)^2.
constexpr double LEAST_VARIANCE = 0.005;

// Rings over which the change of the guides gives the axes.
constexpr int RINGS_FOR_AXES = 2;

constexpr Index GRAIN = 128;

std::size_t at(Index index)
{
	return static_cast<std::size_t>(index);
}

/// The polynomial of one structure, ready to vote.
struct Structure {
	Point tangent;
	Point bitangent;
	Fit::Coefficients polynomial;
	double weight = 0;
	int rings = 0;
};

/// Scratch memory of a worker.
struct Scratch {
	explicit Scratch(const Workspace& workspace) :
			rings(workspace.ring_collector()), stamps(workspace.mesh.positions.size(), -1)
	{
	}

	RingCollector rings;
	/// The face each vertex was last gathered for.
	std::vector<Index> stamps;
};

/// The filter's work, structure by structure and vote by vote.
class Filter {
public:
	Filter(
		const Workspace& workspace, const HeightField& field, const HeightFilterOptions& options) :
			workspace_(workspace),
			field_(field), options_(options),
			scale_(1.0 / (workspace.mean_edge_length * options.largest_ring)),
			variance_(options.sigma * scale_ * options.sigma * scale_),
			scratch_(static_cast<std::size_t>(workspace.execution.threads()), Scratch(workspace)),
			structures_(at(workspace.mesh.face_count()))
	{
	}

	std::vector<Point> run()
	{
		workspace_.execution.begin_part(0, 2);
		workspace_.execution.parallel_for(
			workspace_.mesh.face_count(), GRAIN, [&](Index begin, Index end, int worker) {
				for (Index i = begin; i < end; ++i)
					fit_structure(i, scratch_[static_cast<std::size_t>(worker)]);
			});
		workspace_.execution.begin_part(1, 2);
		std::vector<Point> result(structures_.size());
		workspace_.execution.parallel_for(
			workspace_.mesh.face_count(), GRAIN, [&](Index begin, Index end, int worker) {
				for (Index j = begin; j < end; ++j)
					result[at(j)] = votes_for(j, scratch_[static_cast<std::size_t>(worker)].rings);
			});
		return result;
	}

private:
	bool is_similar(Index i, Index j) const
	{
		return field_.guides[at(i)].dot(field_.guides[at(j)]) > options_.cos_threshold;
	}

	// Axes across the guide, turned to where the guides around it change most.
	void choose_axes(Index i, RingCollector& rings, Structure& structure) const
	{
		TangentFrame frame(field_.guides[at(i)]);
		rings.collect(i, RINGS_FOR_AXES);
		for (const Index j : rings.faces()) {
			if (is_similar(i, j))
				frame.observe(field_.guides[at(j)], 1.0);
		}
		frame.align();
		structure.tangent = frame.tangent();
		structure.bitangent = frame.bitangent();
	}

	// Adds the vertices of the similar faces of one more ring.
	void add_ring(Index i, const Structure& structure, Scratch& scratch, Moments& moments) const
	{
		const int ring = scratch.rings.rings();
		const Point& guide = field_.guides[at(i)];
		for (std::size_t k = ring == 0 ? 0 : scratch.rings.count_within(ring - 1);
			 k < scratch.rings.count_within(ring);
			 ++k) {
			const Index j = scratch.rings.faces()[k];
			if (!is_similar(i, j))
				continue;
			for (const Index vertex : workspace_.mesh.faces[at(j)]) {
				if (scratch.stamps[at(vertex)] == i)
					continue;
				scratch.stamps[at(vertex)] = i;
				const Point offset = scale_ * (field_.positions[at(vertex)] - field_.nodes[at(i)]);
				moments.add(
					offset.dot(structure.tangent),
					offset.dot(structure.bitangent),
					{offset.dot(guide)},
					1.0);
			}
		}
	}

	void fit_structure(Index i, Scratch& scratch)
	{
		const Point& guide = field_.guides[at(i)];
		if (guide.isZero(0))
			return;
		Structure& structure = structures_[at(i)];
		choose_axes(i, scratch.rings, structure);
		Moments moments;
		scratch.rings.collect(i, 0);
		add_ring(i, structure, scratch, moments);
		double least_risk = std::numeric_limits<double>::infinity();
		for (int ring = 1; ring <= options_.largest_ring; ++ring) {
			scratch.rings.grow();
			add_ring(i, structure, scratch, moments);
			if (ring < options_.smallest_ring || moments.count < VERTICES_FOR_PLANE)
				continue;
			const int degree = moments.count >= VERTICES_FOR_CUBIC     ? 3 :
							   moments.count >= VERTICES_FOR_QUADRATIC ? 2 :
																		 1;
			const Fit fitted(moments, degree);
			if (fitted.terms() < PLANE_TERMS)
				continue;
			std::uint32_t kept = PLANE_BITS;
			double residual = fitted.residual();
			int free = moments.count - static_cast<int>(PLANE_TERMS);
			for (std::size_t term = PLANE_TERMS; term < fitted.terms(); ++term) {
				if (fitted.energy(term) > options_.selection * variance_) {
					kept |= 1U << term;
					--free;
				}
				else {
					residual += fitted.energy(term);
				}
			}
			const double risk =
				slope_variance(fitted, kept) +
				BIAS_SHARE * excess(moments, free > 0 ? residual / free : variance_);
			if (risk < least_risk) {
				least_risk = risk;
				structure.polynomial = fitted.polynomial(kept);
				structure.weight = 1 / (risk + LEAST_VARIANCE);
				structure.rings = ring;
			}
			else if (risk > HOPELESS * least_risk) {
				break;
			}
		}
	}

	// Variance of the slope at the centre that the noise of the heights causes.
	double slope_variance(const Fit& fitted, std::uint32_t kept) const
	{
		// Derivatives of the monomials at the centre along both axes.
		const Fit::Terms along_x = fitted.orthonormal({0, 1, 0});
		const Fit::Terms along_y = fitted.orthonormal({0, 0, 1});
		double sum = 0;
		for (std::size_t term = 0; term < fitted.terms(); ++term) {
			if ((kept >> term & 1U) != 0)
				sum += along_x[term] * along_x[term] + along_y[term] * along_y[term];
		}
		return variance_ * sum;
	}

	// Residual variance beyond what noise explains, as a slope over the radius of the structure.
	double excess(const Moments& moments, double residual_variance) const
	{
		const double slack = MARGIN + std::sqrt(2.0 / moments.count);
		// Sums of x^2 and y^2 on the diagonal of the Gram matrix.
		const double mean_square_radius = (moments.gram[2] + moments.gram[5]) / moments.count;
		return std::max(0.0, residual_variance - slack * variance_) / mean_square_radius;
	}

	Point votes_for(Index j, RingCollector& rings) const
	{
		const Point& guide = field_.guides[at(j)];
		if (guide.isZero(0))
			return guide;
		rings.collect(j, options_.largest_ring);
		Point sum = Point::Zero();
		std::size_t k = 0;
		for (int ring = 0; ring <= options_.largest_ring; ++ring) {
			for (; k < rings.count_within(ring); ++k) {
				const Index i = rings.faces()[k];
				const Structure& structure = structures_[at(i)];
				if (structure.rings < ring || structure.weight == 0 || !is_similar(i, j))
					continue;
				const Point offset = scale_ * (field_.nodes[at(j)] - field_.nodes[at(i)]);
				sum += structure.weight * normal_of(structure, field_.guides[at(i)], offset);
			}
		}
		const double length = sum.norm();
		return length > 0 ? Point(sum / length) : guide;
	}

	// Unit normal of a structure's polynomial over a place.
	static Point normal_of(const Structure& structure, const Point& guide, const Point& offset)
	{
		const double x = offset.dot(structure.tangent);
		const double y = offset.dot(structure.bitangent);
		const auto c = [&](std::size_t term) { return structure.polynomial[term][0]; };
		const double along_x =
			c(1) + 2 * c(3) * x + c(4) * y + 3 * c(6) * x * x + 2 * c(7) * x * y + c(8) * y * y;
		const double along_y =
			c(2) + c(4) * x + 2 * c(5) * y + c(7) * x * x + 2 * c(8) * x * y + 3 * c(9) * y * y;
		return (guide - along_x * structure.tangent - along_y * structure.bitangent).normalized();
	}

	const Workspace& workspace_;
	const HeightField& field_;
	const HeightFilterOptions& options_;
	double scale_;
	/// Of the noise, in scaled units.
	double variance_;
	std::vector<Scratch> scratch_;
	std::vector<Structure> structures_;
};

} // namespace

std::vector<Point> normals_from_heights(
	const Workspace& workspace, const HeightField& field, const HeightFilterOptions& options)
{
	return Filter(workspace, field, options).run();
}

} // namespace orthopoly
