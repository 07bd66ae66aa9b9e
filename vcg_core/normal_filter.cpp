// SPDX-License-Identifier: GPL-3.0-or-later
#include "normal_filter.h"

#include "sampling.h"
#include "scattered_polynomials.h"
#include "structure_votes.h"
#include "tangent_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>

namespace orthopoly {

namespace {

template<class Lanes>
using FitOf = ScatteredFit<2, 3, Lanes>;

// One structure in so many gives the noise floor.
constexpr Index SAMPLE_EVERY = 8;

// But so many at least, or a small mesh would have no steady floor; and so many are always enough.
constexpr Index LEAST_SAMPLE = 1000;
constexpr Index LARGEST_SAMPLE = 5000;

// The floor is read low among the residual variances: features only ever add to them.
constexpr double FLOOR_QUANTILE = 0.3;

// Members from which a degree is fitted: twice its terms, so that a residual is left to judge it
// by.
constexpr int MEMBERS_FOR_QUADRATIC = 12;
constexpr int MEMBERS_FOR_LINEAR = 6;

// Residual variance beyond the floor is bias or a feature in the middle of the structure. How much
// of it falls on the centre is not known; a quarter did best on smooth and on sharp models alike.
constexpr double BIAS_SHARE = 0.25;

// What the risk of a looser structure counts: a strict one has its members chosen by how they
// agree, so that they seem to scatter less than they do.
constexpr double LOOSE_RISK = 0.9;

// So many times the members a looser structure has to have to be worth a fit: in flat regions it
// has a few more, whom the noise turned away.
constexpr double WORTH_LOOSENING = 1.1;

// Past this many times the least risk so far, growing further has not paid.
constexpr double HOPELESS = 3;

// Bounds the weight of votes from structures without a residual: (4 degrees)^2.
constexpr double LEAST_VARIANCE = 0.005;

// Structures of so many sizes are fitted side by side.
constexpr int RINGS_AT_ONCE = static_cast<int>(LANES);

constexpr std::size_t RINGS = NormalFilterOptions::MAX_RINGS + 1;

/// Residual variances by number of rings; negative where there is none.
using Variances = std::array<double, RINGS>;

std::size_t degree_for(int members)
{
	return members >= MEMBERS_FOR_QUADRATIC ? 2 : members >= MEMBERS_FOR_LINEAR ? 1 : 0;
}

/// The polynomial that a structure votes with.
struct Polynomial {
	FitOf<double>::Coefficients coefficients;
	double weight = 0;
	double risk = std::numeric_limits<double>::infinity();
	/// 0: there is none.
	int rings = 0;
};

/// The fields at a face.
struct Observation {
	Point guide = Point::Zero();
	double weight = 0;
	Point data = Point::Zero();
	Point node = Point::Zero();
	double scatter = 0;
};

/// The similar faces around a face, laid out for a fit.
template<class Lanes>
struct Structure {
	/// Members side by side.
	struct Group {
		Lanes x;
		Lanes y;
		std::array<Lanes, 3> data;
		Lanes weight;
		/// Times the weight.
		Lanes scatter;
	};

	/// Faces of the patch, each ring filled up to whole groups.
	std::vector<Index> members;
	std::vector<Group> groups;
	/// Members within each number of rings, and groups of them.
	std::array<int, RINGS> counts = {};
	std::array<std::size_t, RINGS> group_ends = {};
	/// Mean variance of the data within each number of rings that was fitted, by noise alone and up
	/// to the common factor.
	std::array<double, RINGS> scatters = {};
};

/// Builds and fits the structures of one patch after another.
template<class Lanes>
class Structures {
public:
	using Fit = FitOf<Lanes>;

	Structures(
		const Workspace& workspace, const NormalField& field, const NormalFilterOptions& options) :
			workspace_(workspace),
			field_(field), options_(options),
			scale_(1.0 / (workspace.mean_edge_length * options.largest_ring))
	{
	}

	Structures(const Structures&) = delete;
	Structures& operator=(const Structures&) = delete;

	const Patch& patch() const { return patch_; }

	void enter(Index number)
	{
		patch_.build(workspace_, number, options_.largest_ring, options_.nearby);
		observations_.clear();
		for (const Index i : patch_.mesh_faces())
			observations_.push_back(
				{field_.guides[at(i)],
				 field_.weights[at(i)],
				 field_.data[at(i)],
				 field_.nodes[at(i)],
				 field_.scatters.empty() ? 1.0 : field_.scatters[at(i)]});
		// Fills up groups of members.
		observations_.emplace_back();
	}

	/// Whether a face has a direction to choose members by.
	bool is_guided(Index i) const { return !observations_[at(i)].guide.isZero(0); }

	/// Gathers whoever may be a member of the structures of a face.
	void collect(Index i) { patch_.collect(i, options_.largest_ring); }

	/// The members of the structure of a face that was collected; returns how many a looser one
	/// would have.
	int find_members(Index i, double cos_threshold, Structure<Lanes>& structure)
	{
		const double looser = cos_threshold - options_.loosening;
		const Observation* const observations = observations_.data();
		const Point guide = observations[i].guide;
		const auto nobody = static_cast<Index>(observations_.size()) - 1;
		structure.members.resize(patch_.collected().size() + RINGS * LANES);
		Index* const members = structure.members.data();
		const IndexSpan faces = patch_.collected();
		std::size_t end = 0;
		std::size_t k = 0;
		int count = 0;
		int looser_count = 0;
		for (int ring = 0; ring <= options_.largest_ring; ++ring) {
			const std::size_t begin = end;
			for (; k < patch_.count_within(ring); ++k) {
				const Index j = faces[k];
				const Observation& other = observations[j];
				// Bits and no branches: half of them would be guessed wrong.
				const double cosine = guide.dot(other.guide);
				const bool has_weight = other.weight > 0;
				const bool is_on_this_side = guide.dot(other.data) > 0;
				const bool may_be = has_weight & is_on_this_side;
				members[end] = j;
				end += static_cast<std::size_t>(may_be & (cosine > cos_threshold));
				looser_count += static_cast<int>(may_be & (cosine > looser));
			}
			count += static_cast<int>(end - begin);
			structure.counts[at(ring)] = count;
			while (end % LANES != 0)
				members[end++] = nobody;
			structure.group_ends[at(ring)] = end / LANES;
		}
		structure.members.resize(end);
		return looser_count;
	}

	/// Calls visit(fit, ring, end) for the structures of `ring` rings, in lane 0, to less than
	/// `end`, smallest ones first, until it returns false.
	template<class Visit>
	void for_each_fit(Index i, Structure<Lanes>& structure, Visit visit) const
	{
		lay_out(i, structure);
		typename Fit::Moments sums;
		Lanes scatter(0);
		std::size_t group = 0;
		const auto add_ring = [&](int ring) {
			for (; group < structure.group_ends[at(ring)]; ++group) {
				const typename Structure<Lanes>::Group& members = structure.groups[group];
				sums.add(members.x, members.y, members.data, members.weight);
				scatter += members.scatter;
			}
		};
		for (int ring = 0; ring < options_.smallest_ring; ++ring)
			add_ring(ring);
		for (int ring = options_.smallest_ring; ring <= options_.largest_ring;
			 ring += RINGS_AT_ONCE) {
			const int end = std::min(ring + RINGS_AT_ONCE, options_.largest_ring + 1);
			std::array<ScatteredMoments<2, 3>, LANES> of_sizes;
			for (int size = ring; size < end; ++size) {
				add_ring(size);
				ScatteredMoments<2, 3>& moments = of_sizes[at(size - ring)];
				add_up(sums, structure.counts[at(size)], moments);
				structure.scatters[at(size)] =
					moments.weight() > 0 ? sum_of_lanes(scatter) / moments.weight() : 1;
			}
			if (!visit(Fit(side_by_side<Lanes>(of_sizes)), ring, end))
				return;
		}
	}

	/// Residual variances of the structures of a face, over those that noise alone makes;
	/// negative where there is none.
	Variances residual_variances(Index i)
	{
		Variances variances;
		variances.fill(-1);
		if (!is_guided(i))
			return variances;
		collect(i);
		find_members(i, options_.cos_threshold, sampled_);
		for_each_fit(i, sampled_, [&](const Fit& fitted, int ring, int end) {
			for (int size = ring; size < end; ++size) {
				const std::size_t lane = at(size - ring);
				const int members = sampled_.counts[at(size)];
				const std::size_t terms = fitted.terms(degree_for(members), lane);
				const int free = members - static_cast<int>(terms);
				if (free > 0)
					variances[at(size)] =
						fitted.residual(terms, lane) / free / sampled_.scatters[at(size)];
			}
			return true;
		});
		return variances;
	}

	/// Adds the votes of a polynomial for the members of its structure.
	static void add_votes(
		const Structure<Lanes>& structure, const Polynomial& polynomial, std::vector<Point>& sums)
	{
		std::array<std::array<Lanes, 3>, Fit::TERMS> coefficients;
		for (std::size_t term = 0; term < Fit::TERMS; ++term) {
			for (std::size_t c = 0; c < 3; ++c)
				coefficients[term][c] = Lanes(polynomial.coefficients[term][c]);
		}
		const std::size_t end = structure.group_ends[at(polynomial.rings)];
		for (std::size_t group = 0; group < end; ++group) {
			const std::array<Lanes, Fit::TERMS> terms =
				monomials<2>(structure.groups[group].x, structure.groups[group].y);
			std::array<Lanes, 3> vote = coefficients[0];
			for (std::size_t term = 1; term < Fit::TERMS; ++term) {
				for (std::size_t c = 0; c < 3; ++c)
					vote[c] += coefficients[term][c] * terms[term];
			}
			const Lanes squares = vote[0] * vote[0] + vote[1] * vote[1] + vote[2] * vote[2];
			const Lanes factor =
				where_positive(squares, Lanes(polynomial.weight) / square_root(squares), Lanes(0));
			for (std::size_t c = 0; c < 3; ++c)
				vote[c] *= factor;
			for (std::size_t lane = 0; lane < LANES; ++lane)
				sums[at(structure.members[LANES * group + lane])] +=
					Point(vote[0][lane], vote[1][lane], vote[2][lane]);
		}
	}

private:
	// Axes across the guide, turned to where the data around it change most.
	TangentFrame axes_of(Index i, const Structure<Lanes>& structure) const
	{
		TangentFrame frame(observations_[at(i)].guide);
		const int rings = TangentFrame::rings_to_observe(
			options_.smallest_ring, options_.largest_ring, [&](int ring) {
				return structure.counts[at(ring)];
			});
		const std::size_t end = LANES * structure.group_ends[at(rings)];
		for (std::size_t k = 0; k < end; ++k) {
			const Observation& member = observations_[at(structure.members[k])];
			frame.observe(member.data, member.weight);
		}
		frame.align();
		return frame;
	}

	void lay_out(Index i, Structure<Lanes>& structure) const
	{
		const TangentFrame axes = axes_of(i, structure);
		const Point tangent = scale_ * axes.tangent();
		const Point bitangent = scale_ * axes.bitangent();
		const Point center = observations_[at(i)].node;
		structure.groups.resize(structure.members.size() / LANES);
		for (std::size_t k = 0; k < structure.groups.size(); ++k) {
			const Index* const members = structure.members.data() + LANES * k;
			const Observation& first = observations_[at(members[0])];
			const Observation& second = observations_[at(members[1])];
			const Observation& third = observations_[at(members[2])];
			const Observation& fourth = observations_[at(members[3])];
			const auto lanes = [&](auto value_of) {
				return Lanes(
					{value_of(first), value_of(second), value_of(third), value_of(fourth)});
			};
			typename Structure<Lanes>::Group& group = structure.groups[k];
			group.x = Lanes(0);
			group.y = Lanes(0);
			for (int c = 0; c < 3; ++c) {
				const Lanes offset =
					lanes([c](const Observation& o) { return o.node[c]; }) - Lanes(center[c]);
				group.x += offset * Lanes(tangent[c]);
				group.y += offset * Lanes(bitangent[c]);
				group.data[at(c)] = lanes([c](const Observation& o) { return o.data[c]; });
			}
			group.weight = lanes([](const Observation& o) { return o.weight; });
			group.scatter = group.weight * lanes([](const Observation& o) { return o.scatter; });
		}
	}

	const Workspace& workspace_;
	const NormalField& field_;
	const NormalFilterOptions& options_;
	double scale_;
	Patch patch_;
	std::vector<Observation> observations_;
	/// Of `residual_variances`.
	Structure<Lanes> sampled_;
};

/// Fits the structures and lets them vote.
template<class Lanes>
class Voter {
	using Fit = FitOf<Lanes>;

public:
	/// @param chosen #F flags of the faces with a structure
	Voter(
		Structures<Lanes>& structures,
		const NormalFilterOptions& options,
		const Variances& floors,
		const std::vector<std::uint8_t>& chosen) :
			structures_(structures),
			options_(options), floors_(floors), chosen_(chosen)
	{
	}

	const Patch& patch() const { return structures_.patch(); }
	void enter(Index number) { structures_.enter(number); }

	void vote(Index i, std::vector<Point>& sums)
	{
		if (chosen_[at(patch().mesh_faces()[at(i)])] == 0 || !structures_.is_guided(i))
			return;
		Polynomial best;
		structures_.collect(i);
		for (const double loosening : {0.0, options_.loosening}) {
			const int looser =
				structures_.find_members(i, options_.cos_threshold - loosening, tried_);
			const int members = tried_.counts[at(options_.largest_ring)];
			const Polynomial tried = fit(i);
			if (loosening == 0 || LOOSE_RISK * tried.risk < best.risk) {
				best = tried;
				std::swap(tried_, best_);
			}
			if (loosening > 0 || looser < WORTH_LOOSENING * members)
				break;
		}
		if (best.rings > 0)
			Structures<Lanes>::add_votes(best_, best, sums);
	}

private:
	/// The structure with the least risk so far.
	struct Choice {
		double least_risk = std::numeric_limits<double>::infinity();
		std::uint32_t kept = 0;
		std::size_t terms = 0;
		double weight = 0;
		/// 0: none of those fitted together last.
		int rings = 0;
	};

	// Fits the structure that is tried.
	Polynomial fit(Index i)
	{
		Polynomial best;
		Choice choice;
		structures_.for_each_fit(i, tried_, [&](const Fit& fitted, int ring, int end) {
			choice.rings = 0;
			bool goes_on = true;
			for (int size = ring; size < end && goes_on; ++size)
				goes_on = judge(fitted, at(size - ring), size, choice);
			if (choice.rings > 0) {
				const std::size_t lane = at(choice.rings - ring);
				best = {
					fitted.polynomial(choice.kept, choice.terms, lane),
					choice.weight,
					choice.least_risk,
					choice.rings};
			}
			return goes_on;
		});
		return best;
	}

	// Takes over the structure of that size if its risk is less; false where growing further has
	// not paid.
	bool judge(const Fit& fitted, std::size_t lane, int ring, Choice& choice) const
	{
		const int members = tried_.counts[at(ring)];
		if (members == 0)
			return true;
		const double floor = floors_[at(ring)] * tried_.scatters[at(ring)];
		const std::size_t terms = fitted.terms(degree_for(members), lane);
		double residual = fitted.residual(terms, lane);
		const int free = members - static_cast<int>(terms);
		const double noise = free > 0 ? std::min(residual / free, floor) : floor;

		std::uint32_t kept = 1;
		int kept_count = 1;
		for (std::size_t term = 1; term < terms; ++term) {
			if (fitted.energy(term, lane) > options_.selection * noise) {
				kept |= 1U << term;
				++kept_count;
			}
			else {
				residual += fitted.energy(term, lane);
			}
		}
		const int kept_free = members - kept_count;
		const double variance = kept_free > 0 ? residual / kept_free : floor;
		const double unexplained =
			std::max(0.0, variance - floor * (1 + 1 / std::sqrt(double(members))));
		const double risk = floor * (1 + kept_count) / members + BIAS_SHARE * unexplained;
		if (risk < choice.least_risk) {
			const double weight = 1 / std::sqrt(variance * (1 + kept_count) + LEAST_VARIANCE);
			choice = {risk, kept, terms, weight, ring};
		}
		return risk <= HOPELESS * choice.least_risk;
	}

	Structures<Lanes>& structures_;
	const NormalFilterOptions& options_;
	const Variances& floors_;
	const std::vector<std::uint8_t>& chosen_;
	/// The structure with the least risk, and the one that is tried.
	Structure<Lanes> best_;
	Structure<Lanes> tried_;
};

// The faces that the noise floor is read at, in ascending order.
std::vector<Index>
sample_noise(const std::vector<double>& areas, const std::vector<std::uint8_t>& noisy)
{
	std::vector<Index> faces;
	std::vector<double> their_areas;
	for (std::size_t i = 0; i < areas.size(); ++i) {
		if (noisy.empty() || noisy[i] != 0) {
			faces.push_back(static_cast<Index>(i));
			their_areas.push_back(areas[i]);
		}
	}
	const Index wanted = std::min(
		LARGEST_SAMPLE, std::max(LEAST_SAMPLE, static_cast<Index>(faces.size()) / SAMPLE_EVERY));
	std::vector<Index> sample = sample_by_value(their_areas, wanted);
	for (Index& chosen : sample)
		chosen = faces[at(chosen)];
	std::sort(sample.begin(), sample.end());
	return sample;
}

// The noise variance of the data, as structures of each size see it.
template<class AnyStructures>
Variances measure_noise_floors(
	const Workspace& workspace,
	const std::vector<Index>& sample,
	const NormalFilterOptions& options,
	std::deque<AnyStructures>& structures)
{
	std::vector<Variances> variances(sample.size());
	workspace.execution.parallel_for(
		Patch::count(workspace), 1, [&](Index begin, Index end, int worker) {
			AnyStructures& own = structures[static_cast<std::size_t>(worker)];
			for (Index number = begin; number < end; ++number) {
				const Index first = number * Patch::OWN_FACES;
				auto it = std::lower_bound(sample.begin(), sample.end(), first);
				if (it == sample.end() || *it >= first + Patch::OWN_FACES)
					continue;
				own.enter(number);
				for (; it != sample.end() && *it < first + Patch::OWN_FACES; ++it)
					variances[static_cast<std::size_t>(it - sample.begin())] =
						own.residual_variances(*it - first);
			}
		});
	Variances floors = {};
	for (int ring = options.smallest_ring; ring <= options.largest_ring; ++ring) {
		std::vector<double> of_ring;
		for (const Variances& variance : variances) {
			if (variance[at(ring)] >= 0)
				of_ring.push_back(variance[at(ring)]);
		}
		floors[at(ring)] = quantile(of_ring, FLOOR_QUANTILE);
	}
	return floors;
}

/// The same on a processor with wide lanes.
class WideStructures : public Structures<WideLanes> {
public:
	using Structures<WideLanes>::Structures;

	ORTHOPOLY_WIDE Variances residual_variances(Index i)
	{
		return Structures<WideLanes>::residual_variances(i);
	}
};

class WideVoter : public Voter<WideLanes> {
public:
	using Voter<WideLanes>::Voter;

	ORTHOPOLY_WIDE void vote(Index i, std::vector<Point>& sums) { Voter<WideLanes>::vote(i, sums); }
};

template<class AnyStructures, class AnyVoter>
std::vector<Point>
let_vote(const Workspace& workspace, const NormalField& field, const NormalFilterOptions& options)
{
	// A deque, since structures do not move.
	std::deque<AnyStructures> structures;
	for (int worker = 0; worker < workspace.execution.threads(); ++worker)
		structures.emplace_back(workspace, field, options);
	workspace.execution.begin_part(0, 16);
	// By areas as measured: what filtering has made of them has fewer digits that are no rounding.
	const std::vector<double> areas = face_geometry(workspace, workspace.mesh.positions).areas;
	const Variances floors =
		measure_noise_floors(workspace, sample_noise(areas, field.noisy), options, structures);
	workspace.execution.begin_part(1, 16, 15);
	const std::vector<std::uint8_t> chosen =
		choose_evenly(workspace, areas, options.faces_per_structure);
	std::vector<AnyVoter> voters;
	voters.reserve(structures.size());
	for (AnyStructures& own : structures)
		voters.emplace_back(own, options, floors, chosen);
	return sum_votes<Point>(workspace, voters);
}

} // namespace

std::vector<Point> filter_normals(
	const Workspace& workspace, const NormalField& field, const NormalFilterOptions& options)
{
	std::vector<Point> result =
		options.wide_lanes ? let_vote<WideStructures, WideVoter>(workspace, field, options) :
							 let_vote<Structures<Lanes>, Voter<Lanes>>(workspace, field, options);
	workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
		const double length = result[i].norm();
		result[i] = length > 0 && field.weights[i] > 0 ? Point(result[i] / length) : field.data[i];
	});
	return result;
}

} // namespace orthopoly
