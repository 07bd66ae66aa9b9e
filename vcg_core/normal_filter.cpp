// SPDX-License-Identifier: GPL-3.0-or-later
#include "normal_filter.h"

#include "sampling.h"
#include "scattered_polynomials.h"
#include "tangent_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace orthopoly {

namespace {

using Fit = ScatteredFit<2, 3>;
using Moments = Fit::Moments;

// One structure in so many gives the noise floor.
constexpr Index SAMPLE_EVERY = 8;

// But so many at least, or a small mesh would have no steady floor.
constexpr Index LEAST_SAMPLE = 1000;

// The floor is read low among the residual variances: features only ever add to them.
constexpr double FLOOR_QUANTILE = 0.3;

// Members from which a degree is fitted: twice its terms, so that a residual is left to judge it
// by.
constexpr int MEMBERS_FOR_QUADRATIC = 12;
constexpr int MEMBERS_FOR_LINEAR = 6;

// Residual variance beyond the floor is bias or a feature in the middle of the structure. How much
// of it falls on the centre is not known; a quarter did best on smooth and on sharp models alike.
constexpr double BIAS_SHARE = 0.25;

// Past this many times the least risk so far, growing further has not paid.
constexpr double HOPELESS = 3;

// Bounds the weight of votes from structures without a residual: (4 degrees)^2.
constexpr double LEAST_VARIANCE = 0.005;

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
	explicit Scratch(const Workspace& workspace) : rings(workspace.ring_collector()) {}

	RingCollector rings;
	/// Sums over the members within each number of rings.
	std::array<Moments, NormalFilterOptions::MAX_RINGS + 1> moments;
};

/// The filter's work, structure by structure and vote by vote.
class Filter {
public:
	Filter(
		const Workspace& workspace, const NormalField& field, const NormalFilterOptions& options) :
			workspace_(workspace),
			field_(field), options_(options),
			scale_(1.0 / (workspace.mean_edge_length * options.largest_ring)),
			scratch_(static_cast<std::size_t>(workspace.execution.threads()), Scratch(workspace)),
			structures_(at(workspace.mesh.face_count()))
	{
	}

	std::vector<Point> run()
	{
		workspace_.execution.begin_part(0, 4);
		measure_noise_floors();
		workspace_.execution.begin_part(1, 4);
		workspace_.execution.parallel_for(
			workspace_.mesh.face_count(), GRAIN, [&](Index begin, Index end, int worker) {
				for (Index i = begin; i < end; ++i)
					fit_structure(i, scratch_[static_cast<std::size_t>(worker)]);
			});
		workspace_.execution.begin_part(3, 4);
		std::vector<Point> result(structures_.size());
		workspace_.execution.parallel_for(
			workspace_.mesh.face_count(), GRAIN, [&](Index begin, Index end, int worker) {
				for (Index j = begin; j < end; ++j)
					result[at(j)] = votes_for(j, scratch_[static_cast<std::size_t>(worker)].rings);
			});
		return result;
	}

private:
	bool takes_part(Index face) const { return !field_.guides[at(face)].isZero(0); }

	// Whether face j belongs to the structure of face i.
	bool is_member(Index i, Index j) const
	{
		const Point& guide = field_.guides[at(i)];
		return guide.dot(field_.guides[at(j)]) > options_.cos_threshold &&
			   field_.weights[at(j)] > 0 && guide.dot(field_.data[at(j)]) > 0;
	}

	// Axes across the guide, turned to where the data around it change most.
	void choose_axes(Index i, const RingCollector& rings, Structure& structure) const
	{
		TangentFrame frame(field_.guides[at(i)]);
		for (std::size_t k = 0; k < rings.count_within(options_.smallest_ring); ++k) {
			const Index j = rings.faces()[k];
			if (is_member(i, j))
				frame.observe(field_.data[at(j)], field_.weights[at(j)]);
		}
		frame.align();
		structure.tangent = frame.tangent();
		structure.bitangent = frame.bitangent();
	}

	void gather(Index i, Scratch& scratch, Structure& structure) const
	{
		scratch.rings.collect(i, options_.largest_ring);
		choose_axes(i, scratch.rings, structure);
		Moments moments;
		std::size_t k = 0;
		for (int ring = 0; ring <= options_.largest_ring; ++ring) {
			for (; k < scratch.rings.count_within(ring); ++k) {
				const Index j = scratch.rings.faces()[k];
				if (!is_member(i, j))
					continue;
				const Point offset = scale_ * (field_.nodes[at(j)] - field_.nodes[at(i)]);
				const Point& value = field_.data[at(j)];
				moments.add(
					offset.dot(structure.tangent),
					offset.dot(structure.bitangent),
					{value.x(), value.y(), value.z()},
					field_.weights[at(j)]);
			}
			scratch.moments[static_cast<std::size_t>(ring)] = moments;
		}
	}

	static Fit fit(const Moments& moments)
	{
		const int degree = moments.count >= MEMBERS_FOR_QUADRATIC ? 2 :
						   moments.count >= MEMBERS_FOR_LINEAR    ? 1 :
																	0;
		return Fit(moments, degree);
	}

	static int free_members(const Moments& moments, std::size_t terms)
	{
		return moments.count - static_cast<int>(terms);
	}

	// The noise variance of the data, as structures of each size see it.
	void measure_noise_floors()
	{
		const std::vector<Index> sample = sample_by_value(
			field_.weights, std::max(LEAST_SAMPLE, workspace_.mesh.face_count() / SAMPLE_EVERY));
		using Variances = std::array<double, NormalFilterOptions::MAX_RINGS + 1>;
		std::vector<Variances> variances(sample.size());
		workspace_.execution.parallel_for(
			static_cast<Index>(sample.size()), GRAIN, [&](Index begin, Index end, int worker) {
				Scratch& scratch = scratch_[static_cast<std::size_t>(worker)];
				for (Index k = begin; k < end; ++k) {
					variances[at(k)].fill(-1);
					const Index i = sample[at(k)];
					if (!takes_part(i))
						continue;
					Structure structure;
					gather(i, scratch, structure);
					for (int ring = options_.smallest_ring; ring <= options_.largest_ring; ++ring) {
						const Moments& moments = scratch.moments[static_cast<std::size_t>(ring)];
						if (moments.count == 0)
							continue;
						const Fit fitted = fit(moments);
						if (free_members(moments, fitted.terms()) > 0)
							variances[at(k)][static_cast<std::size_t>(ring)] =
								fitted.residual() / free_members(moments, fitted.terms());
					}
				}
			});
		for (int ring = options_.smallest_ring; ring <= options_.largest_ring; ++ring) {
			std::vector<double> of_ring;
			for (const Variances& variance : variances) {
				if (variance[static_cast<std::size_t>(ring)] >= 0)
					of_ring.push_back(variance[static_cast<std::size_t>(ring)]);
			}
			floors_[static_cast<std::size_t>(ring)] = quantile(of_ring, FLOOR_QUANTILE);
		}
	}

	void fit_structure(Index i, Scratch& scratch)
	{
		if (!takes_part(i))
			return;
		Structure& structure = structures_[at(i)];
		gather(i, scratch, structure);
		double least_risk = std::numeric_limits<double>::infinity();
		for (int ring = options_.smallest_ring; ring <= options_.largest_ring; ++ring) {
			const Moments& moments = scratch.moments[static_cast<std::size_t>(ring)];
			if (moments.count == 0)
				continue;
			const Fit fitted = fit(moments);
			const double floor = floors_[static_cast<std::size_t>(ring)];
			const int free = free_members(moments, fitted.terms());
			const double noise = free > 0 ? std::min(fitted.residual() / free, floor) : floor;

			std::uint32_t kept = 1;
			std::size_t kept_count = 1;
			double residual = fitted.residual();
			for (std::size_t term = 1; term < fitted.terms(); ++term) {
				if (fitted.energy(term) > options_.selection * noise) {
					kept |= 1U << term;
					++kept_count;
				}
				else {
					residual += fitted.energy(term);
				}
			}
			const int kept_free = free_members(moments, kept_count);
			const double variance = kept_free > 0 ? residual / kept_free : floor;
			const double members = moments.count;
			const double terms = 1.0 + static_cast<double>(kept_count);
			const double risk =
				floor * terms / members +
				BIAS_SHARE * std::max(0.0, variance - floor * (1 + 1 / std::sqrt(members)));
			if (risk < least_risk) {
				least_risk = risk;
				structure.polynomial = fitted.polynomial(kept);
				structure.weight = 1 / std::sqrt(variance * terms + LEAST_VARIANCE);
				structure.rings = ring;
			}
			else if (risk > HOPELESS * least_risk) {
				break;
			}
		}
	}

	Point votes_for(Index j, RingCollector& rings) const
	{
		const Point& data = field_.data[at(j)];
		if (!(field_.weights[at(j)] > 0))
			return data;
		rings.collect(j, options_.largest_ring);
		Point sum = Point::Zero();
		std::size_t k = 0;
		for (int ring = 0; ring <= options_.largest_ring; ++ring) {
			for (; k < rings.count_within(ring); ++k) {
				const Index i = rings.faces()[k];
				const Structure& structure = structures_[at(i)];
				if (structure.rings < ring || structure.weight == 0 || !is_member(i, j))
					continue;
				const Point offset = scale_ * (field_.nodes[at(j)] - field_.nodes[at(i)]);
				const auto terms =
					monomials<2>(offset.dot(structure.tangent), offset.dot(structure.bitangent));
				Point vote = Point::Zero();
				for (std::size_t term = 0; term < terms.size(); ++term)
					vote +=
						terms[term] * Eigen::Map<const Point>(structure.polynomial[term].data());
				const double length = vote.norm();
				if (length > 0)
					sum += structure.weight / length * vote;
			}
		}
		const double length = sum.norm();
		return length > 0 ? Point(sum / length) : data;
	}

	const Workspace& workspace_;
	const NormalField& field_;
	const NormalFilterOptions& options_;
	double scale_;
	std::vector<Scratch> scratch_;
	std::array<double, NormalFilterOptions::MAX_RINGS + 1> floors_ = {};
	std::vector<Structure> structures_;
};

} // namespace

std::vector<Point> filter_normals(
	const Workspace& workspace, const NormalField& field, const NormalFilterOptions& options)
{
	return Filter(workspace, field, options).run();
}

} // namespace orthopoly
