// SPDX-License-Identifier: GPL-3.0-or-later
#include "height_filter.h"

#include "sampling.h"
#include "scattered_polynomials.h"
#include "structure_votes.h"
#include "tangent_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <deque>
#include <limits>

namespace orthopoly {

namespace {

// Vertices from which a degree is fitted: half as many again as its terms.
constexpr int VERTICES_FOR_CUBIC = 16;
constexpr int VERTICES_FOR_QUADRATIC = 9;
constexpr int VERTICES_FOR_PLANE = 5;

// The constant and the slopes are what is looked for; only what is beyond them is selected.
constexpr std::size_t PLANE_TERMS = 3;

// Weight of the residual variance beyond the noise, over the mean square radius, in the variance of
// a slope: a height left unexplained may well be a slope at the centre, hence more than one.
constexpr double BIAS_SHARE = 12;

// What the noise may be above its estimate before the residual counts as unexplained.
constexpr double MARGIN = 1.25;

// What the risk of a looser structure counts: what it has of another side of an edge shows in the
// heights less than it does harm.
constexpr double LOOSE_RISK = 1.2;

// So many times the members a looser structure has to have to be worth a fit.
constexpr double WORTH_LOOSENING = 1.1;

// Structures of more rings than these see so much of a surface that what their polynomials miss
// gets lost in the noise around: their risk is known less well, and counts so many times. Where the
// surface is as plain as they take it for, twice the rings leave a sixteenth of it.
constexpr int WELL_KNOWN_RINGS = 7;
constexpr double FAR_RISK = 10;

// They have so many members in common that one for so many faces is enough, which votes for the
// faces around it that could have had one: their own votes are those of narrower structures.
constexpr int FACES_PER_FAR_STRUCTURE = 12;
constexpr double FAR_WEIGHT = 20;

// Past this many times the least risk so far, growing further has not paid.
constexpr double HOPELESS = 3;

// Bounds the weight of votes: (4 degrees)^2.
constexpr double LEAST_VARIANCE = 0.005;

// Rings over which the change of the guides gives the axes.
constexpr int RINGS_FOR_AXES = 2;

// Numbers of rings tried, as far as the options allow them, beside the largest they allow: each has
// about twice the vertices of the one before.
constexpr std::array<int, 5> SIZES = {1, 2, 3, 5, WELL_KNOWN_RINGS};

/// Vertices side by side.
template<class Lanes>
struct VertexGroup {
	Lanes x;
	Lanes y;
	Lanes height;
	Lanes weight;
};

// From a center to four of some points.
template<class Lanes>
std::array<Lanes, 3>
offsets(const std::vector<Point>& points, const Index* four, const Point& center)
{
	const Point& first = points[at(four[0])];
	const Point& second = points[at(four[1])];
	const Point& third = points[at(four[2])];
	const Point& fourth = points[at(four[3])];
	const auto component = [&](Index c) {
		return Lanes({first[c], second[c], third[c], fourth[c]}) - Lanes(center[c]);
	};
	return {component(0), component(1), component(2)};
}

template<class Lanes>
Lanes dot(const std::array<Lanes, 3>& vectors, const Point& direction)
{
	return vectors[0] * Lanes(direction[0]) + vectors[1] * Lanes(direction[1]) +
		   vectors[2] * Lanes(direction[2]);
}

/// A normal times its weight, and that weight.
using Vote = Eigen::Vector4d;

/// The polynomial that a structure votes with.
struct Polynomial {
	ScatteredFit<3, 1>::Coefficients coefficients;
	double risk = std::numeric_limits<double>::infinity();
	/// 0: there is none.
	int rings = 0;
};

/// The similar faces around a face, and their vertices laid out for a fit.
template<class Lanes>
struct Structure {
	explicit Structure(int largest_ring) :
			member_ends(at(largest_ring) + 1), vertex_counts(member_ends.size()),
			vertex_group_ends(member_ends.size())
	{
	}

	std::vector<Index> members;
	/// Members within each number of rings.
	std::vector<std::size_t> member_ends;
	std::vector<Index> vertices;
	std::vector<VertexGroup<Lanes>> groups;
	/// Vertices of the members within each number of rings, and groups of them.
	std::vector<int> vertex_counts;
	std::vector<std::size_t> vertex_group_ends;
	Point tangent = Point::Zero();
	Point bitangent = Point::Zero();
};

/// Builds the structures of one patch after another, fits them and lets them vote.
template<class Lanes>
class Voter {
	using Fit = ScatteredFit<3, 1, Lanes>;

public:
	/// @param chosen     #F flags of the faces with a structure
	/// @param far_chosen #F flags of those among them whose structure may be wide
	Voter(
		const Workspace& workspace,
		const HeightField& field,
		const HeightFilterOptions& options,
		const std::vector<std::uint8_t>& chosen,
		const std::vector<std::uint8_t>& far_chosen) :
			workspace_(workspace),
			field_(field), options_(options), chosen_(chosen), far_chosen_(far_chosen),
			scale_(1.0 / (workspace.mean_edge_length * options.largest_ring)),
			variance_(options.sigma.overall() * scale_ * options.sigma.overall() * scale_),
			best_(options.largest_ring), tried_(options.largest_ring)
	{
		const int near =
			std::min(std::max(options.smallest_ring, WELL_KNOWN_RINGS), options.largest_ring);
		for (const int size : SIZES) {
			if (size >= options.smallest_ring && size < near)
				sizes_.push_back(size);
		}
		sizes_.push_back(near);
		if (near < options.largest_ring)
			far_sizes_.push_back(options.largest_ring);
	}
	Voter(const Voter&) = delete;
	Voter& operator=(const Voter&) = delete;

	const Patch& patch() const { return patch_; }

	void enter(Index number)
	{
		patch_.build(workspace_, number, options_.largest_ring, options_.nearby);
		guides_.clear();
		places_.clear();
		for (const Index i : patch_.mesh_faces()) {
			guides_.push_back(field_.guides[at(i)]);
			places_.push_back(field_.nodes[at(i)]);
		}
		// Fills up groups of members.
		guides_.emplace_back(Point::Zero());
		places_.emplace_back(Point::Zero());
		positions_.clear();
		weights_.clear();
		for (const Index i : patch_.mesh_vertices()) {
			const double factor = options_.sigma.factor(at(i));
			positions_.push_back(field_.positions[at(i)]);
			weights_.push_back(1 / (factor * factor));
		}
		// The same for groups of vertices.
		positions_.emplace_back(Point::Zero());
		weights_.push_back(0);
		stamps_.assign(positions_.size(), 0);
		stamp_ = 0;
	}

	void vote(Index i, std::vector<Vote>& sums)
	{
		const Index number = patch_.mesh_faces()[at(i)];
		if (guides_[at(i)].isZero(0) || chosen_[at(number)] == 0)
			return;
		Polynomial best;
		find_better(i, sizes_, 1, best);
		double weight = 1;
		// A farther one is hardly the best where the farthest of these is not.
		if (best.rings == sizes_.back() && !far_sizes_.empty() && far_chosen_[at(number)] != 0 &&
			find_better(i, far_sizes_, FAR_RISK, best))
			weight = FAR_WEIGHT;
		if (best.rings > 0)
			add_votes(i, best, weight / (best.risk + LEAST_VARIANCE), sums);
	}

private:
	// Takes over the polynomial with the least risk of the structures of these sizes around a face,
	// their risk counted so many times, where it is less than the best one's so far.
	bool find_better(Index i, const std::vector<int>& sizes, double risk_factor, Polynomial& best)
	{
		const int rings = sizes.back();
		patch_.collect(i, rings);
		bool found = false;
		for (const double loosening : {0.0, options_.loosening}) {
			const std::size_t looser = find_members(i, options_.cos_threshold - loosening, rings);
			const std::size_t members = tried_.member_ends[at(rings)];
			choose_axes(i, rings);
			find_vertices(rings);
			lay_out(i);
			Polynomial tried = fit(sizes);
			tried.risk *= risk_factor;
			if ((loosening == 0 ? 1 : LOOSE_RISK) * tried.risk < best.risk) {
				best = tried;
				std::swap(tried_, best_);
				found = true;
			}
			if (loosening > 0 ||
				static_cast<double>(looser) < WORTH_LOOSENING * static_cast<double>(members))
				break;
		}
		return found;
	}

	// The similar faces around a face; returns how many there would be for a looser structure.
	std::size_t find_members(Index i, double cos_threshold, int rings)
	{
		const double looser = cos_threshold - options_.loosening;
		const Point guide = guides_[at(i)];
		const IndexSpan faces = patch_.collected();
		const Point* const guides = guides_.data();
		tried_.members.resize(faces.size() + LANES);
		Index* const members = tried_.members.data();
		std::size_t end = 0;
		std::size_t looser_count = 0;
		std::size_t k = 0;
		for (int ring = 0; ring <= rings; ++ring) {
			for (; k < patch_.count_within(ring); ++k) {
				const Index j = faces[k];
				const double cosine = guide.dot(guides[j]);
				members[end] = j;
				end += static_cast<std::size_t>(cosine > cos_threshold);
				looser_count += static_cast<std::size_t>(cosine > looser);
			}
			tried_.member_ends[at(ring)] = end;
		}
		return looser_count;
	}

	// Axes across the guide, turned to where the guides around it change most.
	void choose_axes(Index i, int rings)
	{
		TangentFrame frame(guides_[at(i)]);
		const int observed =
			TangentFrame::rings_to_observe(std::min(RINGS_FOR_AXES, rings), rings, [&](int ring) {
				return tried_.member_ends[at(ring)];
			});
		for (std::size_t k = 0; k < tried_.member_ends[at(observed)]; ++k)
			frame.observe(guides_[at(tried_.members[k])], 1.0);
		frame.align();
		tried_.tangent = frame.tangent();
		tried_.bitangent = frame.bitangent();
	}

	// The vertices of the members, each ring filled up to whole groups.
	void find_vertices(int rings)
	{
		if (tried_.member_ends[at(rings)] == patch_.count_within(rings))
			take_all_vertices(rings);
		else
			take_vertices_of_members(rings);
	}

	// Where all faces are members, they have been met already.
	void take_all_vertices(int rings)
	{
		const IndexSpan met = patch_.collect_vertices();
		const auto nobody = static_cast<Index>(positions_.size()) - 1;
		std::vector<Index>& vertices = tried_.vertices;
		vertices.clear();
		std::size_t begin = 0;
		for (int ring = 0; ring <= rings; ++ring) {
			const std::size_t end = patch_.vertex_count_within(ring);
			vertices.insert(vertices.end(), met.begin() + begin, met.begin() + end);
			begin = end;
			tried_.vertex_counts[at(ring)] = static_cast<int>(end);
			while (vertices.size() % LANES != 0)
				vertices.push_back(nobody);
			tried_.vertex_group_ends[at(ring)] = vertices.size() / LANES;
		}
	}

	void take_vertices_of_members(int rings)
	{
		tried_.vertices.resize(3 * tried_.members.size() + tried_.vertex_group_ends.size() * LANES);
		const auto nobody = static_cast<Index>(positions_.size()) - 1;
		Index* const stamps = stamps_.data();
		Index* const vertices = tried_.vertices.data();
		const Index* const members = tried_.members.data();
		const Index stamp = ++stamp_;
		const Face* const faces = patch_.faces().data();
		std::size_t end = 0;
		std::size_t k = 0;
		int count = 0;
		for (int ring = 0; ring <= rings; ++ring) {
			const std::size_t begin = end;
			for (; k < tried_.member_ends[at(ring)]; ++k) {
				for (const Index vertex : faces[members[k]]) {
					vertices[end] = vertex;
					end += static_cast<std::size_t>(stamps[vertex] != stamp);
					stamps[vertex] = stamp;
				}
			}
			count += static_cast<int>(end - begin);
			tried_.vertex_counts[at(ring)] = count;
			while (end % LANES != 0)
				vertices[end++] = nobody;
			tried_.vertex_group_ends[at(ring)] = end / LANES;
		}
		tried_.vertices.resize(end);
	}

	void lay_out(Index i)
	{
		const Point center = places_[at(i)];
		const Point tangent = scale_ * tried_.tangent;
		const Point bitangent = scale_ * tried_.bitangent;
		const Point guide = scale_ * guides_[at(i)];
		tried_.groups.resize(tried_.vertices.size() / LANES);
		for (std::size_t k = 0; k < tried_.groups.size(); ++k) {
			const Index* const vertices = tried_.vertices.data() + LANES * k;
			const std::array<Lanes, 3> offset = offsets<Lanes>(positions_, vertices, center);
			VertexGroup<Lanes>& group = tried_.groups[k];
			group.x = dot(offset, tangent);
			group.y = dot(offset, bitangent);
			group.height = dot(offset, guide);
			const auto weight = [&](std::size_t lane) { return weights_[at(vertices[lane])]; };
			group.weight = Lanes({weight(0), weight(1), weight(2), weight(3)});
		}
	}

	// The polynomial with the least risk of those sizes of the structure that is tried.
	Polynomial fit(const std::vector<int>& sizes) const
	{
		Polynomial best;
		Choice choice;
		typename Fit::Moments sums;
		std::size_t group = 0;
		for (std::size_t first = 0; first < sizes.size(); first += LANES) {
			const std::size_t end = std::min(first + LANES, sizes.size());
			std::array<ScatteredMoments<3, 1>, LANES> of_sizes;
			for (std::size_t k = first; k < end; ++k) {
				for (; group < tried_.vertex_group_ends[at(sizes[k])]; ++group) {
					const VertexGroup<Lanes>& vertices = tried_.groups[group];
					sums.add(vertices.x, vertices.y, {vertices.height}, vertices.weight);
				}
				add_up(sums, tried_.vertex_counts[at(sizes[k])], of_sizes[k - first]);
			}
			const Fit fitted(side_by_side<Lanes>(of_sizes));
			const Slopes slopes(fitted);
			choice.rings = 0;
			bool goes_on = true;
			for (std::size_t k = first; k < end && goes_on; ++k)
				goes_on = judge(of_sizes[k - first], fitted, slopes, k - first, sizes[k], choice);
			if (choice.rings > 0)
				best = {
					fitted.polynomial(choice.kept, choice.terms, choice.lane),
					choice.least_risk,
					choice.rings};
			if (!goes_on)
				break;
		}
		return best;
	}

	/// Slopes of the orthonormal polynomials at the centre, along both axes.
	struct Slopes {
		explicit Slopes(const Fit& fitted) :
				along_x(fitted.orthonormal({0, 1, 0})), along_y(fitted.orthonormal({0, 0, 1}))
		{
		}
		std::array<Lanes, Fit::TERMS> along_x;
		std::array<Lanes, Fit::TERMS> along_y;
	};

	/// The structure with the least risk so far.
	struct Choice {
		double least_risk = std::numeric_limits<double>::infinity();
		std::uint32_t kept = 0;
		std::size_t terms = 0;
		std::size_t lane = 0;
		/// 0: none of those fitted together last.
		int rings = 0;
	};

	// Takes over the structure of that size if its risk is less; false where growing further has
	// not paid.
	bool judge(
		const ScatteredMoments<3, 1>& moments,
		const Fit& fitted,
		const Slopes& slopes,
		std::size_t lane,
		int ring,
		Choice& choice) const
	{
		const int count = static_cast<int>(moments.count);
		const std::size_t degree = count >= VERTICES_FOR_CUBIC     ? 3 :
								   count >= VERTICES_FOR_QUADRATIC ? 2 :
																	 1;
		const std::size_t terms = fitted.terms(degree, lane);
		if (count < VERTICES_FOR_PLANE || terms < PLANE_TERMS)
			return true;
		double residual = fitted.residual(terms, lane);
		std::uint32_t kept = 0;
		int free = count;
		// Variance of the slope at the centre that the noise of the heights causes.
		double slope_variance = 0;
		for (std::size_t term = 0; term < terms; ++term) {
			if (term < PLANE_TERMS || fitted.energy(term, lane) > options_.selection * variance_) {
				kept |= 1U << term;
				--free;
				const double x = slopes.along_x[term][lane];
				const double y = slopes.along_y[term][lane];
				slope_variance += variance_ * (x * x + y * y);
			}
			else {
				residual += fitted.energy(term, lane);
			}
		}
		const double unexplained = excess(moments, free > 0 ? residual / free : variance_);
		const double risk = slope_variance + BIAS_SHARE * unexplained;
		if (risk < choice.least_risk)
			choice = {risk, kept, terms, lane, ring};
		return risk <= HOPELESS * choice.least_risk;
	}

	// Residual variance beyond what noise explains, as a slope over the radius of the structure.
	double excess(const ScatteredMoments<3, 1>& moments, double residual_variance) const
	{
		const double slack = MARGIN + std::sqrt(2.0 / moments.count);
		// Sums of x^2 and y^2.
		const double mean_square_radius = (moments.powers[3] + moments.powers[5]) / moments.count;
		return std::max(0.0, residual_variance - slack * variance_) / mean_square_radius;
	}

	void add_votes(Index i, const Polynomial& polynomial, double weight, std::vector<Vote>& sums)
	{
		const Point center = places_[at(i)];
		const Point guide = guides_[at(i)];
		const Point tangent = scale_ * best_.tangent;
		const Point bitangent = scale_ * best_.bitangent;
		std::array<Lanes, Fit::TERMS> c;
		for (std::size_t term = 0; term < Fit::TERMS; ++term)
			c[term] = Lanes(polynomial.coefficients[term][0]);
		std::array<std::array<Lanes, 3>, 3> axes;
		for (std::size_t axis = 0; axis < 3; ++axis) {
			const Point& direction = axis == 0 ? guide :
									 axis == 1 ? best_.tangent :
												 best_.bitangent;
			for (int component = 0; component < 3; ++component)
				axes[axis][at(component)] = Lanes(direction[component]);
		}
		const Lanes two(2);
		const Lanes three(3);
		const std::size_t end = best_.member_ends[at(polynomial.rings)];
		// Whoever fills up the last group.
		std::fill_n(
			best_.members.begin() + static_cast<std::ptrdiff_t>(end),
			LANES,
			static_cast<Index>(guides_.size()) - 1);
		for (std::size_t k = 0; k < end; k += LANES) {
			const std::array<Lanes, 3> offset =
				offsets<Lanes>(places_, best_.members.data() + k, center);
			const Lanes x = dot(offset, tangent);
			const Lanes y = dot(offset, bitangent);
			const Lanes slope_x =
				c[1] + (two * c[3] + three * c[6] * x + two * c[7] * y) * x + (c[4] + c[8] * y) * y;
			const Lanes slope_y =
				c[2] + (c[4] + c[7] * x + two * c[8] * y) * x + (two * c[5] + three * c[9] * y) * y;
			// The guide and the axes are unit vectors across each other.
			const Lanes factor =
				Lanes(weight) / square_root(Lanes(1) + slope_x * slope_x + slope_y * slope_y);
			std::array<Lanes, 3> vote;
			for (std::size_t component = 0; component < 3; ++component)
				vote[component] = factor * (axes[0][component] - slope_x * axes[1][component] -
											slope_y * axes[2][component]);
			for (std::size_t lane = 0; lane < LANES; ++lane)
				sums[at(best_.members[k + lane])] +=
					Vote(vote[0][lane], vote[1][lane], vote[2][lane], weight);
		}
	}

	const Workspace& workspace_;
	const HeightField& field_;
	const HeightFilterOptions& options_;
	const std::vector<std::uint8_t>& chosen_;
	const std::vector<std::uint8_t>& far_chosen_;
	double scale_;
	/// Of the noise, in scaled units.
	double variance_;
	/// Numbers of rings to try, and the one more that is tried beyond them, if any.
	std::vector<int> sizes_;
	std::vector<int> far_sizes_;
	Patch patch_;
	std::vector<Point> guides_;
	std::vector<Point> places_;
	std::vector<Point> positions_;
	/// Of the vertices: with them the noise of all is the overall one.
	std::vector<double> weights_;
	/// The structure each vertex was last gathered for, by a number of its own.
	std::vector<Index> stamps_;
	Index stamp_ = 0;
	/// The structure with the least risk, and the one that is tried.
	Structure<Lanes> best_;
	Structure<Lanes> tried_;
};

/// The same on a processor with wide lanes.
class WideVoter : public Voter<WideLanes> {
public:
	using Voter<WideLanes>::Voter;

	ORTHOPOLY_WIDE void vote(Index i, std::vector<Vote>& sums) { Voter<WideLanes>::vote(i, sums); }
};

// Sizes of the faces by which some of them are chosen.
std::vector<double> perimeters(const Workspace& workspace, const std::vector<Point>& positions)
{
	std::vector<double> sizes(workspace.mesh.faces.size());
	workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
		sizes[i] = perimeter(positions, workspace.mesh.faces[i]);
	});
	return sizes;
}

template<class AnyVoter>
std::vector<Vote>
let_vote(const Workspace& workspace, const HeightField& field, const HeightFilterOptions& options)
{
	const std::vector<double> sizes = perimeters(workspace, field.positions);
	const std::vector<std::uint8_t> chosen =
		choose_evenly(workspace, sizes, options.faces_per_structure);
	const std::vector<std::uint8_t> far_chosen = choose_evenly(
		workspace, sizes, std::max(options.faces_per_structure, FACES_PER_FAR_STRUCTURE));
	// A deque, since voters do not move.
	std::deque<AnyVoter> voters;
	for (int worker = 0; worker < workspace.execution.threads(); ++worker)
		voters.emplace_back(workspace, field, options, chosen, far_chosen);
	return sum_votes<Vote>(workspace, voters);
}

} // namespace

HeightNormals normals_from_heights(
	const Workspace& workspace, const HeightField& field, const HeightFilterOptions& options)
{
	const std::vector<Vote> sums = options.wide_lanes ?
									   let_vote<WideVoter>(workspace, field, options) :
									   let_vote<Voter<Lanes>>(workspace, field, options);
	HeightNormals result;
	result.normals = field.guides;
	result.spreads.resize(sums.size(), 1);
	workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
		const Vote& sum = sums[i];
		const double length = sum.head<3>().norm();
		if (length > 0) {
			result.normals[i] = sum.head<3>() / length;
			result.spreads[i] = std::max(0.0, 1 - length / sum[3]);
		}
	});
	return result;
}

} // namespace orthopoly
