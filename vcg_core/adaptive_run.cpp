// SPDX-License-Identifier: GPL-3.0-or-later
#include "adaptive_run.h"

#include "anisotropy.h"
#include "deviations.h"
#include "height_filter.h"
#include "interpolation.h"
#include "normal_filter.h"
#include "prefilter.h"
#include "unfolding.h"
#include "vertex_update.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

namespace orthopoly {

namespace {

// Noise lengthens edges, and what is left of their mean square without it may be rounding: at least
// this share is taken for the surface's own.
constexpr double LEAST_CLEAN_SHARE = 0.05;

// Standard deviations of the noise beyond which the prefilter must be moving a feature, not noise.
constexpr double PREFILTER_BOUND = 3;

// More pairs where faces are folded over, as low as noise can fold them: it moves the height of a
// triangle by up to about four times sqrt(1.5) standard deviations. And how far these may move
// vertices: of the largest deviations, wherever they are, since deviations along the normal say
// nothing of those along the surface, which fold faces too. Noise along one axis has but these
// where it is seen edge on.
constexpr int UNFOLDING_PAIRS = 3;
constexpr double FOLD_HEIGHT = 5;
constexpr double UNFOLDING_BOUND = 4;

// Share of the overall deviation from which a face tells by how much noise there is. Clean parts
// would only tell that there is none.
constexpr double NOISY = 0.5;

// A face's cosine to its surroundings, or to its target in the vertex update, that says folded.
constexpr double FOLD_COSINE = 0.3;

// Standard deviations of the noise that a vertex may end up away from where it was measured (or
// from the way to where the prefilter took it, so that outliers do come back). Noise of a Gaussian
// length in random directions, whose spread along the normal the level is, reaches so far.
constexpr double DRIFT_BOUND = 5;

// Spread of the votes for a normal (1 less a cosine, over the noise, which makes some of it: two
// degrees at 0.1) at which a vertex goes at half its pace, and what its pace is divided by at most.
// Where votes agree, flat or evenly curved, normals know the surface better than the measured
// vertices do, over any distance; where they do not, long waves are better left as measured.
constexpr double SLOW_SPREAD = 0.005;
constexpr double SLOWEST = 20;

// How much lower the threshold of looser structures is, of normals and of heights. Where a surface
// only bends, the threshold that edges ask for takes members away from its structures.
constexpr double LOOSENING = 0.25;
constexpr double HEIGHT_LOOSENING = 0.15;

// Energy over noise variance from which a coefficient of the heights is kept: more than of the
// normals, whose structures have up to five coefficients, these up to seven.
constexpr double HEIGHT_SELECTION = 12;

// Share of the prefiltered original in the data of an iteration, the rest being the current
// normals: filtering the original again keeps detail that filtering the filtered would lose.
constexpr double ORIGINAL_SHARE = 0.7;

// Spread of the votes by heights (1 less a cosine: four and a half degrees) and angle between the
// normals by heights and by normals (six degrees) at which either counts half. Heights know edges
// only through the guides: a structure that has faces from beyond an edge, or is of several sheets,
// votes otherwise than those around it. Where all agree they are right, and be they ever so far
// from the normals.
constexpr double SPREAD = 0.0033;
constexpr double DISAGREEMENT = 0.1;

// How much the noise of the corners scatters the normal of each face: #F, or empty where no noise
// is known that could tell faces apart.
//
// Independent noise at the corners tilts a triangle by a mean square of sigma^2 times the sum of
// its squared edges over four times its squared area; turned so far that it could be anywhere, it
// tells no more.
std::vector<double> scatters_by(
	const Deviations& deviations, const Workspace& workspace, const std::vector<Point>& positions)
{
	if (!(deviations.overall() > 0))
		return {};
	std::vector<double> scatters(workspace.mesh.faces.size());
	workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
		const Face& face = workspace.mesh.faces[i];
		const double tilt = deviations.square_at(face) * edge_squares(positions, face);
		const double total = tilt + face_cross_product(positions, face).squaredNorm();
		scatters[i] = total > 0 ? tilt / total : 1;
	});
	return scatters;
}

// Flags of the faces whose normals the noise scatters enough to tell it by: #F, or empty where it
// is the same everywhere.
std::vector<std::uint8_t> noisy_faces(const Deviations& deviations, const Workspace& workspace)
{
	if (!deviations.differ())
		return {};
	const double least = NOISY * deviations.overall();
	std::vector<std::uint8_t> flags(workspace.mesh.faces.size());
	workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
		const bool is_noisy = deviations.square_at(workspace.mesh.faces[i]) >= least * least;
		flags[i] = is_noisy ? 1 : 0;
	});
	return flags;
}

// The normals to fit: the prefiltered original's, blended with the current ones by area.
NormalField normal_field(
	const FaceGeometry& original,
	FaceGeometry current,
	const std::vector<double>& scatters,
	const std::vector<std::uint8_t>& noisy,
	Execution& execution)
{
	NormalField field;
	field.scatters = scatters;
	field.noisy = noisy;
	field.guides = std::move(current.normals);
	field.nodes = std::move(current.centroids);
	field.data.resize(field.guides.size());
	field.weights.resize(field.guides.size());
	execution.for_each(static_cast<Index>(field.guides.size()), [&](std::size_t i) {
		const Point blend = ORIGINAL_SHARE * original.areas[i] * original.normals[i] +
							(1 - ORIGINAL_SHARE) * current.areas[i] * field.guides[i];
		field.weights[i] = blend.norm();
		field.data[i] = field.weights[i] > 0 ? Point(blend / field.weights[i]) : blend;
	});
	return field;
}

/// One run of the method.
class AdaptiveRunner {
public:
	/// @param factors of the noise, as those of `Deviations`
	AdaptiveRunner(
		const Workspace& workspace,
		const AdaptivePlan& plan,
		const std::vector<double>& factors,
		std::vector<Point>& positions) :
			workspace_(workspace),
			plan_(plan), deviations_(plan.noise * workspace.mean_edge_length, factors),
			positions_(positions)
	{
	}

	AdaptiveRun run()
	{
		prefilter();
		// The level is in edge lengths of the surface below the noise, which lengthens them.
		deviations_.set_overall(plan_.noise * mean_edge_length(workspace_, positions_));
		const std::vector<Point> start = positions_;
		const FaceGeometry original = face_geometry(workspace_, positions_);
		const std::vector<double> scatters = scatters_by(deviations_, workspace_, start);
		const std::vector<std::uint8_t> noisy = noisy_faces(deviations_, workspace_);
		for (int iteration = 0; iteration < plan_.iterations; ++iteration) {
			const bool last = iteration + 1 == plan_.iterations;
			NormalField field = normal_field(
				original,
				face_geometry(workspace_, positions_),
				scatters,
				noisy,
				workspace_.execution);
			std::vector<Point> normals = filter(field, iteration);
			const std::vector<Point> centroids = std::move(field.nodes);
			field = {};
			std::vector<double> paces;
			if (last && plan_.correlation < 1)
				paces = refine(centroids, normals);
			begin_phase(iteration, 0.8, 1.0, "moving vertices");
			VertexUpdateOptions update;
			update.iterations = last ? plan_.vertex_iterations : plan_.guiding_vertex_iterations;
			update.area_weights = true;
			update.unfold_cosine = FOLD_COSINE;
			update.accelerated = plan_.is_mostly_white();
			if (plan_.correlation < 1)
				update.rest = &start;
			if (!paces.empty())
				update.paces = &paces;
			update_vertices(workspace_, normals, update, positions_);
			// Eq. 12 lets vertices slide where normals do not agree; noise does not reach so far.
			bound_drift(start, DRIFT_BOUND, deviations_);
			if (unfold_faces(workspace_, normals, positions_))
				bound_drift(start, DRIFT_BOUND, folding_deviation());
			if (!last && plan_.guiding < 1)
				go_back(start, 1 - plan_.guiding);
		}
		// Noise that goes together over several edges moves vertices together as well.
		if (plan_.correlation == 1)
			return {{}, deviations_.overall()};
		return {
			give_back_detail(workspace_, deviations_, 1 - plan_.correlation, positions_),
			deviations_.overall()};
	}

private:
	// Announces a part (from, to) of an iteration.
	void begin_phase(int iteration, double from, double to, const char* words) const
	{
		const double share = 0.85 / plan_.iterations;
		workspace_.execution.begin_phase(
			0.15 + share * (iteration + from),
			0.15 + share * (iteration + to),
			"iteration " + std::to_string(iteration + 1) + " of " +
				std::to_string(plan_.iterations) + ": " + words);
	}

	// The largest standard deviation that may have folded faces.
	double folding_deviation() const
	{
		return std::max(deviations_.largest(), plan_.fold_factor * deviations_.overall());
	}

	// Keeps every vertex within so many deviations of the way from where it was measured to a
	// place.
	void bound_drift(const std::vector<Point>& to, double bound, const Deviations& deviations)
	{
		if (plan_.correlation == 1)
			return;
		bound /= 1 - plan_.correlation;
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			const Point& measured = workspace_.mesh.positions[i];
			const Point way = to[i] - measured;
			const Point move = positions_[i] - measured;
			const double square = way.squaredNorm();
			const double share = square > 0 ? move.dot(way) / square : 0;
			const Point drift = move - std::min(1.0, std::max(0.0, share)) * way;
			const double length = drift.norm();
			const double longest = bound * deviations[i];
			if (length > longest)
				positions_[i] -= (1 - longest / length) * drift;
		});
	}

	// Takes vertices a share of the way back to where they came from.
	void go_back(const std::vector<Point>& start, double share)
	{
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			positions_[i] += share * (start[i] - positions_[i]);
		});
	}

	void prefilter()
	{
		const std::vector<Point>& measured = workspace_.mesh.positions;
		workspace_.execution.begin_phase(0.1, 0.15, "unfolding faces");
		anisotropy_ = find_anisotropy(workspace_, measured);
		const NearFirst near_first = {anisotropy_.shares, anisotropy_.smoothed};
		taubin_smooth(
			workspace_,
			prefilter_pairs(),
			positions_,
			anisotropy_.shares.empty() ? nullptr : &near_first);
		if (plan_.correlation == 1)
			return;
		bound_drift(measured, PREFILTER_BOUND, deviations_);
		const FoldCriterion criterion {FOLD_COSINE, FOLD_HEIGHT * folding_deviation()};
		for (int pair = 0; pair < UNFOLDING_PAIRS; ++pair)
			taubin_smooth(
				workspace_, 1, positions_, folded_vertices(workspace_, positions_, criterion));
		bound_drift(measured, UNFOLDING_BOUND, folding_deviation());
	}

	// Taubin pairs of each vertex: small triangles and thin ones scatter more, and fold before
	// others do. None takes fewer than the mean edge asks for, since outliers make long edges too.
	std::vector<double> prefilter_pairs() const
	{
		std::vector<double> pairs(positions_.size());
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			const double square =
				mean_edge_square_around(workspace_, positions_, static_cast<Index>(i));
			// The noise of both ends is in an edge.
			const double sigma = deviations_[i];
			const double clean = std::max(square - 2 * sigma * sigma, LEAST_CLEAN_SHARE * square);
			const double local = clean > 0 ? sigma / std::sqrt(clean) : 0.0;
			const double least = plan_.noise * deviations_.factor(i);
			pairs[i] = plan_.prefilter_pairs(std::max(least, local));
			if (anisotropy_.shares.empty() || anisotropy_.shares[i] == 0)
				return;
			const double steady =
				steady_edge_square_around(workspace_, anisotropy_.smoothed, static_cast<Index>(i));
			const double thin = plan_.prefilter_pairs(std::max(least, sigma / std::sqrt(steady)));
			pairs[i] = between(pairs[i], thin, anisotropy_.shares[i]);
		});
		return pairs;
	}

	std::vector<Point> filter(const NormalField& field, int iteration) const
	{
		begin_phase(iteration, 0.0, 0.5, "fitting normals");
		NormalFilterOptions options;
		options.cos_threshold = plan_.cos_threshold_of(iteration);
		options.smallest_ring = plan_.rings.smallest;
		options.largest_ring = plan_.rings.largest;
		options.loosening = LOOSENING;
		options.selection = plan_.selection;
		options.faces_per_structure = plan_.faces_per_structure * crowding();
		options.nearby = nearby();
		return filter_normals(workspace_, field, options);
	}

	// Vertices that are one place for the structures, or nothing.
	const IndexLists* nearby() const
	{
		return anisotropy_.shares.empty() ? nullptr : &anisotropy_.nearby;
	}

	// So many times fewer faces need structures of their own where these have more members.
	int crowding() const { return static_cast<int>(anisotropy_.crowding); }

	// Takes the normals from the measured heights instead, as far as these agree. Returns the paces
	// of the vertices: #V.
	std::vector<double>
	refine(const std::vector<Point>& centroids, std::vector<Point>& normals) const
	{
		begin_phase(plan_.iterations - 1, 0.5, 0.8, "fitting heights");
		HeightFilterOptions options;
		options.smallest_ring = plan_.height_rings.smallest;
		options.largest_ring = plan_.height_rings.largest;
		options.faces_per_structure = plan_.faces_per_height_structure * crowding();
		options.nearby = nearby();
		options.loosening = HEIGHT_LOOSENING;
		options.sigma = deviations_;
		options.selection = HEIGHT_SELECTION;
		const HeightNormals refined = normals_from_heights(
			workspace_, {normals, centroids, workspace_.mesh.positions}, options);
		workspace_.execution.for_each(workspace_.mesh.face_count(), [&](std::size_t i) {
			const double spread = refined.spreads[i] / SPREAD;
			const double apart = (normals[i] - refined.normals[i]).norm() / DISAGREEMENT;
			const double doubt = spread * spread * apart;
			const double share = std::max(plan_.correlation, doubt / (1 + doubt));
			const Point blend = share * normals[i] + (1 - share) * refined.normals[i];
			const double length = blend.norm();
			if (length > 0)
				normals[i] = blend / length;
			// Nobody is similar enough: where it points is the noise's doing, so that its vertices
			// had better go by the other faces.
			if (refined.spreads[i] >= 1 && plan_.is_mostly_white())
				normals[i] = Point::Zero();
		});
		return paces_for(refined.spreads);
	}

	// The paces of the vertices, by the mean spread of the votes for the faces around each.
	std::vector<double> paces_for(const std::vector<double>& spreads) const
	{
		const IndexLists& around = workspace_.vertex_faces;
		const double scale = (1 - plan_.correlation) / (SLOW_SPREAD * plan_.noise);
		std::vector<double> paces(positions_.size(), 1);
		workspace_.execution.for_each(workspace_.mesh.vertex_count(), [&](std::size_t i) {
			const auto vertex = static_cast<Index>(i);
			double sum = 0;
			int count = 0;
			for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it) {
				const double spread = spreads[static_cast<std::size_t>(*it)];
				if (spread < 1) {
					sum += spread;
					++count;
				}
			}
			if (count > 0)
				paces[i] = 1 / (1 + std::min(SLOWEST, scale / deviations_.factor(i) * sum / count));
		});
		return paces;
	}

	const Workspace& workspace_;
	const AdaptivePlan& plan_;
	Deviations deviations_;
	Anisotropy anisotropy_;
	std::vector<Point>& positions_;
};

} // namespace

AdaptiveRun run_adaptively(
	const Workspace& workspace,
	const AdaptivePlan& plan,
	const std::vector<double>& factors,
	std::vector<Point>& positions)
{
	return AdaptiveRunner(workspace, plan, factors, positions).run();
}

} // namespace orthopoly
