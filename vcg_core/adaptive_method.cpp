// SPDX-License-Identifier: GPL-3.0-or-later
#include "adaptive_method.h"

#include "broad_detail.h"
#include "detail.h"
#include "deviations.h"
#include "final_smoothing.h"
#include "height_filter.h"
#include "interpolation.h"
#include "mesh_part.h"
#include "noise_correlation.h"
#include "noise_level.h"
#include "normal_filter.h"
#include "outliers.h"
#include "prefilter.h"
#include "probe.h"
#include "sampling.h"
#include "spikes.h"
#include "unfolding.h"
#include "vertex_update.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace orthopoly {

namespace {

// Rings a structure may reach.
struct Rings {
	int smallest;
	int largest;
};

// Noise from which a prefilter pays (fading in until the second): below it faces do not fold, and
// smoothing would only cost detail.
constexpr double PREFILTER_FROM = 0.065;
constexpr double PREFILTER_FULL = 0.095;

// Taubin pairs of the prefilter: a base, and more with the noise over the edges around a vertex, as
// much as folds ask for. More than the most, and it would reach beyond the structures.
constexpr double PREFILTER_BASE_PAIRS = 0.5;
constexpr double PREFILTER_PAIRS_PER_NOISE = 5;
constexpr double MOST_PREFILTER_PAIRS = 8;

// Noise lengthens edges, and what is left of their mean square without it may be rounding: at least
// this share is taken for the surface's own.
constexpr double LEAST_CLEAN_SHARE = 0.05;

// Standard deviations of the noise beyond which the prefilter must be moving a feature, not noise.
constexpr double PREFILTER_BOUND = 3;

// More pairs where faces are folded over, as low as noise can fold them: it moves the height of a
// triangle by up to about four times sqrt(1.5) standard deviations. And how far these may move
// vertices.
constexpr int UNFOLDING_PAIRS = 3;
constexpr double FOLD_HEIGHT = 5;
constexpr double UNFOLDING_BOUND = 4;

// A face's cosine to its surroundings, or to its target in the vertex update, that says folded.
constexpr double FOLD_COSINE = 0.3;

// Standard deviations of the noise that a vertex may end up away from where it was measured (or
// from the way to where the prefilter took it, so that outliers do come back). Noise of a Gaussian
// length in random directions, whose spread along the normal the level is, reaches so far.
constexpr double DRIFT_BOUND = 5;

// Share of the vertices found to be outliers up to which the others are taken for measured rightly,
// and from which there must be too many among them that were not found.
constexpr double FEW_OUTLIERS = 0.05;
constexpr double MANY_OUTLIERS = 0.15;

// Iterations, the last of which makes the result, and those before better guides for it. Up to the
// first noise guides need no improving, and filtering twice would only cost detail; from there to
// the second the first of two iterations moves vertices a growing part of its way.
constexpr int ITERATIONS = 2;
constexpr double GUIDING_FROM = 0.12;
constexpr double GUIDING_FULL = 0.18;

// Steps of the vertex update in the last iteration (accelerated ones: as good as three to five
// times as many plain ones), and what part of them guides need: triangles turn long before waves
// over many of them settle.
constexpr int VERTEX_ITERATIONS = 20;
constexpr double GUIDING_SHARE = 0.25;

// Spread of the votes for a normal (1 less a cosine, over the noise, which makes some of it: two
// degrees at 0.1) at which a vertex goes at half its pace, and what its pace is divided by at most.
// Where votes agree, flat or evenly curved, normals know the surface better than the measured
// vertices do, over any distance; where they do not, long waves are better left as measured.
constexpr double SLOW_SPREAD = 0.005;
constexpr double SLOWEST = 20;

// Increment of the threshold of similar directions, from one noise to the other: the more noise the
// first iteration took out of the guides, the stricter the next can be.
constexpr double LEAST_INCREMENT = 0.05;
constexpr double LEAST_INCREMENT_NOISE = 0.1;
constexpr double LARGEST_INCREMENT = 0.08;
constexpr double LARGEST_INCREMENT_NOISE = 0.2;

// How much lower the threshold of looser structures is, of normals and of heights. Where a surface
// only bends, the threshold that edges ask for takes members away from its structures.
constexpr double LOOSENING = 0.25;
constexpr double HEIGHT_LOOSENING = 0.15;

// Energy over noise variance from which a coefficient is kept: three standard deviations.
constexpr double SELECTION = 9;

// The same for heights, where a structure has up to seven such coefficients; normals have five.
constexpr double HEIGHT_SELECTION = 12;

// Share of the prefiltered original in the data of an iteration, the rest being the current
// normals: filtering the original again keeps detail that filtering the filtered would lose.
constexpr double ORIGINAL_SHARE = 0.7;

// Noise from which structures are wide: height structures of one ring hold too few vertices to be
// worth fitting, and all have so many members in common that some of the faces having their own is
// enough; fewer for heights, whose structures are widest.
constexpr double WIDE_STRUCTURES_NOISE = 0.15;
constexpr int FACES_PER_WIDE_STRUCTURE = 3;
constexpr int FACES_PER_HEIGHT_STRUCTURE = 4;

// Spread of the votes by heights (1 less a cosine: four and a half degrees) and angle between the
// normals by heights and by normals (six degrees) at which either counts half. Heights know edges
// only through the guides: a structure that has faces from beyond an edge, or is of several sheets,
// votes otherwise than those around it. Where all agree they are right, and be they ever so far
// from the normals.
constexpr double SPREAD = 0.0033;
constexpr double DISAGREEMENT = 0.1;

// Noise correlated over several edges: more smoothing from one noise to the other, where guides are
// no longer steady without, structures that may be wide but are of strictly similar directions, and
// a selection that allows for each independent value being shared by some twenty faces; by seven
// where it goes together over an edge or two, and structures need not be that wide. Heights are no
// better known than normals then. Where it is not certain that the noise is of that kind,
// everything lies between.
constexpr double LEAST_SCANNER_PAIRS = 3;
constexpr double LEAST_SCANNER_PAIRS_NOISE = 0.15;
constexpr double MOST_SCANNER_PAIRS = 10;
constexpr double MOST_SCANNER_PAIRS_NOISE = 0.25;
constexpr Rings NEAR_RINGS = {2, 8};
constexpr Rings FAR_RINGS = {3, 10};
constexpr int FACES_PER_SCANNER_STRUCTURE = 6;
constexpr double SCANNER_THRESHOLD = 0.85;
constexpr double SCANNER_THRESHOLD_INCREMENT = 0.05;
constexpr double NEAR_SELECTION = 60;
constexpr double FAR_SELECTION = 200;

// Deviation of rounded coordinates from which what rounding leaves goes together over several
// edges, as terraces, and from which all of it does.
constexpr double FINE_ROUNDING = 0.14;
constexpr double COARSE_ROUNDING = 0.2;

// Steps of the vertex update where that is more likely than not; plain ones, since vertices are
// held back too little there should accelerated ones go too far.
constexpr int SCANNER_VERTEX_ITERATIONS = 60;

// Median share of what the method took that neighbours predict (see MovePredictor) from which it is
// detail for a good part; noise alone and smooth surfaces leave up to 0.17. The rest is the noise,
// worth another run where its level is by so much the lower one. It is lowered further only where
// still less than the level was taken: at the right one the method takes what is detail on top.
constexpr double DETAIL = 0.25;
constexpr double WORTH_LOWERING = 0.95;

// Runs at lower levels: each lowers it by a seventh or more, and two have been enough so far.
constexpr int MOST_LOWERINGS = 4;

// Faces of a mesh up to which all of it is denoised with a probe.
constexpr Index MOST_PROBED = 100000;

// A noise level that is set counts from here: less is rounding in the files that meshes come in.
constexpr double NEGLIGIBLE_NOISE = 1e-6;

// Share of the vertices whose noise is below the low end of what is told of it, and above the high
// one.
constexpr double LOW_SHARE = 0.1;

// No threshold of similar directions is higher, however many iterations raise it: with none but the
// face itself above it, there would be nothing to tell the noise by.
constexpr double HIGHEST_THRESHOLD = 0.95;

// Threshold of similar directions by noise level: strict while normals can be trusted, loose enough
// for their scatter after the prefilter beyond.
double cos_threshold_for(double noise)
{
	using Entry = std::array<double, 2>;
	constexpr std::array<Entry, 4> TABLE = {
		Entry {0.05, 0.80}, Entry {0.11, 0.65}, Entry {0.19, 0.55}, Entry {0.30, 0.60}};
	if (noise <= TABLE.front()[0])
		return TABLE.front()[1];
	for (std::size_t k = 1; k < TABLE.size(); ++k) {
		if (noise < TABLE[k][0]) {
			const double share = (noise - TABLE[k - 1][0]) / (TABLE[k][0] - TABLE[k - 1][0]);
			return TABLE[k - 1][1] + share * (TABLE[k][1] - TABLE[k - 1][1]);
		}
	}
	return TABLE.back()[1];
}

double cos_threshold_increment_for(double noise)
{
	return LEAST_INCREMENT + way_between(LEAST_INCREMENT_NOISE, LARGEST_INCREMENT_NOISE, noise) *
								 (LARGEST_INCREMENT - LEAST_INCREMENT);
}

// Wider the more there is to average.
Rings rings_for(double noise)
{
	if (noise < 0.08)
		return {2, 3};
	if (noise < 0.25)
		return {2, 4};
	return noise < 0.35 ? Rings {3, 4} : Rings {3, 5};
}

// Taubin pairs of the prefilter for white noise, here in the edge lengths around a vertex.
double prefilter_pairs_for(double noise)
{
	return std::min(
		MOST_PREFILTER_PAIRS,
		way_between(PREFILTER_FROM, PREFILTER_FULL, noise) *
			(PREFILTER_BASE_PAIRS + PREFILTER_PAIRS_PER_NOISE * noise));
}

// The same for noise correlated over several edges.
double scanner_pairs_for(double noise)
{
	return LEAST_SCANNER_PAIRS +
		   way_between(LEAST_SCANNER_PAIRS_NOISE, MOST_SCANNER_PAIRS_NOISE, noise) *
			   (MOST_SCANNER_PAIRS - LEAST_SCANNER_PAIRS);
}

// How much of its way the first of two iterations goes.
double guiding_for(double noise)
{
	return way_between(GUIDING_FROM, GUIDING_FULL, noise);
}

// Rings of the height structures: more than those of the normals, since heights are steadier the
// wider they reach, and wider the more noise hides the detail there is.
int height_rings_for(double noise)
{
	return noise < 0.16 ? 6 : 7;
}

// How the noise of neighbouring vertices goes together.
struct Correlation {
	/// How far it is taken to, 0 to 1.
	double share = 0;
	/// From 0 (over an edge or two) to 1 (over many).
	double reach = 0;
};

// Everything an iteration goes by.
struct Plan {
	/// How far the noise is taken as correlated, 0 to 1.
	double correlation = 0;
	/// In mean edge lengths, strength included.
	double noise = 0;
	/// Taubin pairs of the prefilter where noise is correlated.
	double scanner_pairs = 0;
	int iterations = ITERATIONS;
	/// How much of their way the iterations before the last go, 0 to 1.
	double guiding = 1;
	/// Of the last iteration, and of those before.
	int vertex_iterations = VERTEX_ITERATIONS;
	int guiding_vertex_iterations = VERTEX_ITERATIONS;
	double cos_threshold = 0;
	double cos_threshold_increment = LEAST_INCREMENT;
	double selection = SELECTION;
	Rings rings = {2, 4};
	int height_rings = 5;

	bool is_mostly_white() const { return correlation < 0.5; }
};

double strength_factor(Strength strength)
{
	switch (strength) {
	case Strength::Gentle: return 0.5;
	case Strength::Strong: return 2;
	case Strength::Normal: break;
	}
	return 1;
}

double between(double from, double to, double share)
{
	return (1 - share) * from + share * to;
}

int between(int from, int to, double share)
{
	return static_cast<int>(
		std::lround(between(static_cast<double>(from), static_cast<double>(to), share)));
}

Rings between(const Rings& from, const Rings& to, double share)
{
	return {between(from.smallest, to.smallest, share), between(from.largest, to.largest, share)};
}

// Of ratios of variances, hence by their logarithms.
double between_ratios(double from, double to, double share)
{
	return from * std::pow(to / from, share);
}

Plan plan_for(const DenoiseOptions& options, double noise, const Correlation& kind)
{
	Plan plan;
	const double correlation = kind.share;
	plan.noise = noise;
	plan.correlation = correlation;
	const double strength = strength_factor(options.strength);
	plan.scanner_pairs = strength * scanner_pairs_for(noise / strength);
	if (!plan.is_mostly_white())
		plan.vertex_iterations = SCANNER_VERTEX_ITERATIONS;
	plan.cos_threshold = between(cos_threshold_for(noise), SCANNER_THRESHOLD, correlation);
	plan.cos_threshold_increment =
		between(cos_threshold_increment_for(noise), SCANNER_THRESHOLD_INCREMENT, correlation);
	plan.selection = between_ratios(
		SELECTION, between_ratios(NEAR_SELECTION, FAR_SELECTION, kind.reach), correlation);
	plan.rings = between(rings_for(noise), between(NEAR_RINGS, FAR_RINGS, kind.reach), correlation);
	plan.height_rings = height_rings_for(noise);
	if (options.structure_ring) {
		plan.height_rings =
			std::max(1, plan.height_rings + *options.structure_ring - plan.rings.largest);
		plan.rings.largest = *options.structure_ring;
		plan.rings.smallest = std::min(plan.rings.smallest, plan.rings.largest);
	}
	plan.guiding = between(guiding_for(noise), 1.0, correlation);
	plan.iterations = plan.guiding > 0 ? ITERATIONS : 1;
	// Another number than by itself: all of it, then.
	if (options.iterations && *options.iterations != plan.iterations) {
		plan.iterations = *options.iterations;
		plan.guiding = 1;
	}
	plan.vertex_iterations = options.vertex_iterations.value_or(plan.vertex_iterations);
	plan.guiding_vertex_iterations = static_cast<int>(
		std::ceil(between(GUIDING_SHARE, 1.0, correlation) * plan.vertex_iterations));
	plan.cos_threshold = options.cos_threshold.value_or(plan.cos_threshold);
	plan.cos_threshold_increment =
		options.cos_threshold_increment.value_or(plan.cos_threshold_increment);
	return plan;
}

void record(const Plan& plan, DenoiseOptions& resolved)
{
	resolved.iterations = plan.iterations;
	resolved.vertex_iterations = plan.vertex_iterations;
	resolved.structure_ring = plan.rings.largest;
	resolved.cos_threshold = plan.cos_threshold;
	resolved.cos_threshold_increment = plan.cos_threshold_increment;
}

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

// The normals to fit: the prefiltered original's, blended with the current ones by area.
NormalField normal_field(
	const FaceGeometry& original,
	FaceGeometry current,
	const std::vector<double>& scatters,
	Execution& execution)
{
	NormalField field;
	field.scatters = scatters;
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
class AdaptiveMethod {
public:
	/// @param factors of the noise, as those of `Deviations`
	AdaptiveMethod(
		const Workspace& workspace,
		const Plan& plan,
		const std::vector<double>& factors,
		std::vector<Point>& positions) :
			workspace_(workspace),
			plan_(plan), deviations_(plan.noise * workspace.mean_edge_length, factors),
			positions_(positions)
	{
	}

	/// The overall noise it went by, after a run, in the caller's length unit.
	double sigma() const { return deviations_.overall(); }

	/// Returns what it took from the vertices; nothing where noise is correlated.
	TakenMoves run()
	{
		prefilter();
		// The level is in edge lengths of the surface below the noise, which lengthens them.
		deviations_.set_overall(plan_.noise * mean_edge_length(workspace_, positions_));
		const std::vector<Point> start = positions_;
		const FaceGeometry original = face_geometry(workspace_, positions_);
		const std::vector<double> scatters = scatters_by(deviations_, workspace_, start);
		for (int iteration = 0; iteration < plan_.iterations; ++iteration) {
			const bool last = iteration + 1 == plan_.iterations;
			NormalField field = normal_field(
				original, face_geometry(workspace_, positions_), scatters, workspace_.execution);
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
			bound_drift(start, DRIFT_BOUND);
			if (unfold_faces(workspace_, normals, positions_))
				bound_drift(start, DRIFT_BOUND);
			if (!last && plan_.guiding < 1)
				go_back(start, 1 - plan_.guiding);
		}
		// Noise that goes together over several edges moves vertices together as well.
		if (plan_.correlation == 1)
			return {};
		return give_back_detail(workspace_, deviations_, 1 - plan_.correlation, positions_);
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

	// Keeps every vertex within so many deviations of the way from where it was measured to a
	// place.
	void bound_drift(const std::vector<Point>& to, double bound)
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
			const double longest = bound * deviations_[i];
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
		taubin_smooth(workspace_, prefilter_pairs(), positions_);
		if (plan_.correlation == 1)
			return;
		bound_drift(measured, PREFILTER_BOUND);
		const FoldCriterion criterion {FOLD_COSINE, FOLD_HEIGHT * deviations_.largest()};
		for (int pair = 0; pair < UNFOLDING_PAIRS; ++pair)
			taubin_smooth(
				workspace_, 1, positions_, folded_vertices(workspace_, positions_, criterion));
		bound_drift(measured, UNFOLDING_BOUND);
	}

	// Taubin pairs of each vertex: small triangles scatter more, and fold before large ones do.
	// None takes fewer than the mean edge asks for, since outliers make long edges too.
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
			const double white =
				prefilter_pairs_for(std::max(plan_.noise * deviations_.factor(i), local));
			pairs[i] = between(white, plan_.scanner_pairs, plan_.correlation);
		});
		return pairs;
	}

	std::vector<Point> filter(const NormalField& field, int iteration) const
	{
		begin_phase(iteration, 0.0, 0.5, "fitting normals");
		NormalFilterOptions options;
		const double guided = iteration * plan_.guiding;
		options.cos_threshold = std::min(
			HIGHEST_THRESHOLD, plan_.cos_threshold + guided * plan_.cos_threshold_increment);
		options.smallest_ring = plan_.rings.smallest;
		options.largest_ring = plan_.rings.largest;
		options.loosening = LOOSENING;
		options.selection = plan_.selection;
		if (!plan_.is_mostly_white())
			options.faces_per_structure = FACES_PER_SCANNER_STRUCTURE;
		else if (plan_.noise >= WIDE_STRUCTURES_NOISE)
			options.faces_per_structure = FACES_PER_WIDE_STRUCTURE;
		return filter_normals(workspace_, field, options);
	}

	// Takes the normals from the measured heights instead, as far as these agree. Returns the paces
	// of the vertices: #V.
	std::vector<double>
	refine(const std::vector<Point>& centroids, std::vector<Point>& normals) const
	{
		begin_phase(plan_.iterations - 1, 0.5, 0.8, "fitting heights");
		HeightFilterOptions options;
		if (plan_.noise >= WIDE_STRUCTURES_NOISE) {
			options.smallest_ring = std::min(2, plan_.height_rings);
			options.faces_per_structure = FACES_PER_HEIGHT_STRUCTURE;
		}
		options.largest_ring = plan_.height_rings;
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
	const Plan& plan_;
	Deviations deviations_;
	std::vector<Point>& positions_;
};

// What a run took, and the noise that it went by, in the caller's length unit.
struct Run {
	TakenMoves taken;
	double sigma;
};

// Runs the method for that noise, from the workspace's mesh on. Returns nothing where there is too
// little noise to do anything.
std::optional<Run> run_at(
	double noise,
	const Workspace& workspace,
	const DenoiseOptions& options,
	const Correlation& correlation,
	const std::vector<double>& factors,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	const Plan plan = plan_for(options, noise, correlation);
	record(plan, result.resolved);
	const double least = options.noise_level ? NEGLIGIBLE_NOISE : LEAST_NOISE;
	const bool nothing = options.noise_type != NoiseType::Scanner && noise < least;
	result.status = nothing ? DenoiseResult::Status::NothingToDo : DenoiseResult::Status::Done;
	result.iterations_done = nothing ? 0 : plan.iterations;
	if (nothing)
		return std::nullopt;
	positions = workspace.mesh.positions;
	AdaptiveMethod method(workspace, plan, factors, positions);
	const TakenMoves taken = method.run();
	return Run {taken, method.sigma()};
}

// Gives back what broad detail a run took along with noise that is white and the same everywhere,
// and smooths what it left rough. A mesh of many faces is tried out in places first, and what the
// method follows of noise there is taken for that of all of it.
void finish(
	double level,
	double sigma,
	const Workspace& workspace,
	const DenoiseOptions& options,
	std::vector<Point>& positions)
{
	const auto denoised = [&](const Workspace& its_workspace) {
		// Levels are in edge lengths, which differ.
		const double scale = workspace.mean_edge_length / its_workspace.mean_edge_length;
		const Plan plan = plan_for(options, scale * level, {});
		std::vector<Point> result = its_workspace.mesh.positions;
		AdaptiveMethod(its_workspace, plan, {}, result).run();
		return result;
	};
	const auto responses_to = [&](const Probe& probe, TriangleMesh mesh, const auto& plain) {
		mesh.positions = probe.with_probe();
		return probe.responses(plain, denoised(Workspace(mesh, workspace.execution)));
	};
	if (workspace.mesh.face_count() <= MOST_PROBED) {
		const Probe probe(workspace, sigma, positions);
		const std::vector<Point> responses = responses_to(probe, workspace.mesh, positions);
		const BroadDetail detail(workspace, probe, positions);
		detail.give_back(detail.share_followed(responses), positions);
		const FinalSmoothing smoothing = choose_smoothing(workspace, probe, responses, positions);
		smooth_finally(workspace, smoothing, positions);
		return;
	}
	const MeshPart part = cut_out_places(workspace);
	const Workspace part_workspace(part.mesh, workspace.execution);
	std::vector<Point> part_positions = denoised(part_workspace);
	const Probe probe(part_workspace, sigma, part_positions);
	const std::vector<Point> responses = responses_to(probe, part.mesh, part_positions);
	const BroadDetail detail(part_workspace, probe, part_positions);
	const double followed = detail.share_followed(responses, part.inner);
	if (detail.certainty(followed, part.inner) > 0) {
		detail.give_back(followed, part_positions);
		const Probe whole(workspace, sigma, positions);
		BroadDetail(workspace, whole, positions).give_back(followed, positions);
	}
	const FinalSmoothing smoothing =
		choose_smoothing(part_workspace, probe, responses, part_positions, part.inner);
	smooth_finally(workspace, smoothing, positions);
}

// What noise a mesh has.
struct Noise {
	Correlation correlation;
	UnevenNoise uneven;
	OutlierRepair outliers;
	// In mean edge lengths, and what no noise and hardly any detail of the mesh is beyond.
	double level = 0;
	double most = 0;
	// What is certain to be noise of it: rounded coordinates.
	double rounding = 0;
};

// Runs the method at the estimated level or the one that is set; where what an estimate takes
// proves to be detail for a good part, again at the level of the rest.
void lower_and_run(
	const Workspace& workspace,
	const DenoiseOptions& options,
	const Noise& noise,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	const double strength = strength_factor(options.strength);
	const auto run = [&](double at_level) {
		return run_at(
			at_level,
			workspace,
			options,
			noise.correlation,
			noise.uneven.factors,
			result,
			positions);
	};
	double& level = *result.resolved.noise_level;
	std::optional<Run> last = run(strength * level);
	if (noise.correlation.share > 0)
		return;
	if (!options.noise_level && last && last->taken.predicted > DETAIL) {
		// The level is the same at any strength.
		if (strength != 1)
			last = run(level);
		for (int round = 0; round < MOST_LOWERINGS && last && last->taken.predicted > DETAIL;
			 ++round) {
			const TakenMoves& taken = last->taken;
			const double left = std::sqrt(taken.square * (1 - taken.predicted));
			const double lower = std::max(noise.rounding, left * level);
			if (lower > WORTH_LOWERING * level || (round > 0 && taken.square > 1))
				break;
			level = lower;
			last = run(level);
		}
		if (strength != 1)
			last = run(strength * level);
		result.estimated_noise = level;
	}
	if (!last)
		positions = workspace.mesh.positions;
	else if (noise.uneven.factors.empty())
		finish(strength * level, last->sigma, workspace, options, positions);
}

// The same with the outliers put back first, and the other vertices in the end.
void repair_and_run(
	const Workspace& workspace,
	const DenoiseOptions& options,
	const Correlation& correlation,
	const OutlierRepair& outliers,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	const double noise = *result.resolved.noise_level * strength_factor(options.strength);
	TriangleMesh mesh = workspace.mesh;
	mesh.positions = outliers.positions;
	const Workspace repaired(mesh, workspace.execution);
	if (!run_at(noise, repaired, options, correlation, {}, result, positions))
		return;
	give_back_inliers(
		repaired,
		outliers.left * mean_edge_length(repaired, positions),
		outliers.share * way_between(MANY_OUTLIERS, FEW_OUTLIERS, outliers.found),
		positions);
}

// Between what levels most of the noise is.
void record_range(const std::vector<double>& factors, DenoiseResult& result)
{
	const auto level_at = [&](double share) {
		std::vector<double> sorted = factors;
		return result.estimated_noise * (factors.empty() ? 1 : quantile(sorted, share));
	};
	result.estimated_noise_low = level_at(LOW_SHARE);
	result.estimated_noise_high = level_at(1 - LOW_SHARE);
}

Noise estimate_noise(const Workspace& workspace, const DenoiseOptions& options)
{
	workspace.execution.begin_phase(0.05, 0.08, "estimating the noise");
	const NoiseLevels levels = estimate_noise_levels(workspace, workspace.mesh.positions);
	Noise noise;
	double by_rise = 0;
	double narrow_level = 0;
	if (options.noise_type != NoiseType::White) {
		const bool scanner = options.noise_type == NoiseType::Scanner;
		const NoiseCorrelation measured =
			measure_noise_correlation(workspace, workspace.mesh.positions, scanner);
		noise.correlation = {scanner ? 1 : measured.certainty(), measured.reach()};
		if (levels.rounding > 0 && !scanner)
			noise.correlation.share = way_between(FINE_ROUNDING, COARSE_ROUNDING, levels.rounding);
		else
			by_rise = (1 - levels.uneven.certainty) * measured.certainty_by_rise();
		narrow_level = measured.narrow_level;
	}
	workspace.execution.begin_phase(0.08, 0.1, "looking for outliers");
	if (noise.correlation.share == 0)
		noise.uneven = levels.uneven;
	// Beside a clean part noise looks like outliers, and so does noise that is strong and
	// correlated.
	if (noise.correlation.share < 0.5 && noise.uneven.certainty < 0.5)
		noise.outliers = repair_outliers(workspace, levels);
	noise.correlation.share =
		std::max(noise.correlation.share, (1 - noise.outliers.share) * by_rise);
	if (noise.correlation.share >= 0.5)
		noise.outliers = {};
	if (noise.correlation.share > 0 || noise.outliers.share > 0)
		noise.uneven = {};
	// What a polynomial over two rings follows of such noise, one over more does not.
	const double rough =
		noise.correlation.share > 0 ? std::max(levels.rough, narrow_level) : levels.rough;
	// Noise that goes together over several edges grows with the rings as detail does.
	const double white = noise.outliers.share > 0 ? levels.flat : (1 - levels.drawn) * levels.flat;
	const double even = between(white, rough, noise.correlation.share);
	const double level = between(even, noise.uneven.level, noise.uneven.certainty);
	noise.level = between(level, noise.outliers.level, noise.outliers.share);
	noise.most = std::max(rough, noise.uneven.level);
	noise.rounding = levels.rounding;
	return noise;
}

// Runs the method for the noise that the workspace's mesh has.
void run_for(
	const Noise& noise,
	const Workspace& workspace,
	const DenoiseOptions& options,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	result.estimated_noise = noise.level;
	result.resolved.noise_level = options.noise_level.value_or(noise.level);
	result.resolved.noise_type =
		noise.correlation.share > 0.5 ? NoiseType::Scanner : NoiseType::White;
	if (noise.outliers.share == 0)
		lower_and_run(workspace, options, noise, result, positions);
	else
		repair_and_run(workspace, options, noise.correlation, noise.outliers, result, positions);
	record_range(noise.uneven.factors, result);
}

} // namespace

void run_adaptive_method(
	const Workspace& workspace,
	const DenoiseOptions& options,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	const Noise noise = estimate_noise(workspace, options);
	// Where outliers make the noise, these are most of it.
	Spikes spikes;
	if (noise.outliers.share < 0.5 && options.noise_level.value_or(1) > NEGLIGIBLE_NOISE)
		spikes = find_spikes(workspace, noise.most);
	if (spikes.vertices.empty()) {
		run_for(noise, workspace, options, result, positions);
		return;
	}
	TriangleMesh mesh = workspace.mesh;
	mesh.positions = std::move(spikes.positions);
	const Workspace without(mesh, workspace.execution);
	positions = mesh.positions;
	run_for(estimate_noise(without, options), without, options, result, positions);
	result.spikes = static_cast<Index>(spikes.vertices.size());
	if (result.status == DenoiseResult::Status::NothingToDo)
		result.status = DenoiseResult::Status::Done;
}

} // namespace orthopoly
