// SPDX-License-Identifier: GPL-3.0-or-later
#include "adaptive_method.h"

#include "ambiguity.h"
#include "height_filter.h"
#include "noise_level.h"
#include "normal_filter.h"
#include "prefilter.h"
#include "vertex_update.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace orthopoly {

namespace {

// Below this the estimate cannot be told from the detail of clean meshes (which read up to 0.023),
// and the angles left are below three degrees.
constexpr double LEAST_NOISE = 0.025;

// Noise from which a prefilter pays (fading in until the second): below it faces do not fold, and
// smoothing would only cost detail.
constexpr double PREFILTER_FROM = 0.065;
constexpr double PREFILTER_FULL = 0.095;

// Taubin pairs of the prefilter: a base, and more with the noise, as much as folds ask for.
constexpr double PREFILTER_BASE_PAIRS = 0.5;
constexpr double PREFILTER_PAIRS_PER_NOISE = 5;

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

constexpr int ITERATIONS = 2;
// Accelerated ones: as good as twice to three times as many plain ones.
constexpr int VERTEX_ITERATIONS = 10;

// Increment of the threshold of similar directions, from one noise to the other: the more noise the
// first iteration took out of the guides, the stricter the next can be.
constexpr double LEAST_INCREMENT = 0.05;
constexpr double LEAST_INCREMENT_NOISE = 0.1;
constexpr double LARGEST_INCREMENT = 0.08;
constexpr double LARGEST_INCREMENT_NOISE = 0.2;

// Energy over noise variance from which a coefficient is kept: three standard deviations.
constexpr double SELECTION = 9;

// The same for heights, where a structure has up to seven such coefficients; normals have five.
constexpr double HEIGHT_SELECTION = 12;

// Share of the prefiltered original in the data of an iteration, the rest being the current
// normals: filtering the original again keeps detail that filtering the filtered would lose.
constexpr double ORIGINAL_SHARE = 0.7;

// Ambiguity (0 to 1) beyond which normals decide alone, at the relative noise below: heights know
// edges only through the guides, and these know them less where the noise is larger than the
// triangles.
constexpr double AMBIGUITY_LIMIT = 0.4;
constexpr double AMBIGUITY_NOISE = 0.2;

// Angle (17 degrees) between the normal by heights and that by normals from which heights are not
// trusted: a structure of a few long triangles, or of several sheets, is no polynomial.
constexpr double DISAGREEMENT = 0.3;

// Mean edge length over the root of the mean area, for equilateral triangles.
constexpr double EDGE_PER_ROOT_AREA = 1.52;

// Noise correlated over several edges: smoothing that reaches beyond the correlation, wide
// structures of one size, and a selection that allows for each independent value being shared by
// some twenty faces.
constexpr double SCANNER_PAIRS = 10;
constexpr int SCANNER_RINGS = 6;
constexpr int SCANNER_VERTEX_ITERATIONS = 60;
constexpr double SCANNER_THRESHOLD = 0.6;
constexpr double SCANNER_SELECTION = 200;

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
	const double share =
		(noise - LEAST_INCREMENT_NOISE) / (LARGEST_INCREMENT_NOISE - LEAST_INCREMENT_NOISE);
	return LEAST_INCREMENT +
		   std::min(1.0, std::max(0.0, share)) * (LARGEST_INCREMENT - LEAST_INCREMENT);
}

// Rings a structure may reach: wider the more there is to average.
struct Rings {
	int smallest;
	int largest;
};

Rings rings_for(double noise)
{
	if (noise < 0.08)
		return {2, 3};
	if (noise < 0.25)
		return {2, 4};
	return noise < 0.35 ? Rings {3, 4} : Rings {3, 5};
}

// Rings of the height structures: more than those of the normals, since heights are steadier the
// wider they reach, and wider the more noise hides the detail there is.
int height_rings_for(double noise)
{
	if (noise < 0.11)
		return 5;
	return noise < 0.16 ? 6 : 7;
}

// Everything an iteration goes by.
struct Plan {
	bool scanner = false;
	/// In mean edge lengths, strength included.
	double noise = 0;
	double prefilter_pairs = 0;
	int iterations = ITERATIONS;
	int vertex_iterations = VERTEX_ITERATIONS;
	double cos_threshold = 0;
	double cos_threshold_increment = LEAST_INCREMENT;
	double selection = SELECTION;
	Rings rings = {2, 4};
	int height_rings = 5;
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

Plan plan_for(const DenoiseOptions& options, double noise)
{
	Plan plan;
	plan.noise = noise;
	plan.scanner = options.noise_type == NoiseType::Scanner;
	if (plan.scanner) {
		plan.prefilter_pairs = SCANNER_PAIRS * strength_factor(options.strength);
		plan.vertex_iterations = SCANNER_VERTEX_ITERATIONS;
		plan.cos_threshold = SCANNER_THRESHOLD;
		plan.selection = SCANNER_SELECTION;
		plan.rings = {SCANNER_RINGS, SCANNER_RINGS};
	}
	else {
		const double faded = (noise - PREFILTER_FROM) / (PREFILTER_FULL - PREFILTER_FROM);
		plan.prefilter_pairs = std::min(1.0, std::max(0.0, faded)) *
							   (PREFILTER_BASE_PAIRS + PREFILTER_PAIRS_PER_NOISE * noise);
		plan.cos_threshold = cos_threshold_for(noise);
		plan.cos_threshold_increment = cos_threshold_increment_for(noise);
		plan.rings = rings_for(noise);
		plan.height_rings = height_rings_for(noise);
	}
	if (options.structure_ring) {
		plan.rings.largest = *options.structure_ring;
		plan.rings.smallest = std::min(plan.rings.smallest, plan.rings.largest);
		plan.height_rings = plan.rings.largest + 1;
	}
	plan.iterations = options.iterations.value_or(plan.iterations);
	plan.vertex_iterations = options.vertex_iterations.value_or(plan.vertex_iterations);
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

// The normals to fit: the prefiltered original's, blended with the current ones by area.
NormalField normal_field(const FaceGeometry& original, const FaceGeometry& current)
{
	NormalField field;
	field.guides = current.normals;
	field.nodes = current.centroids;
	field.data.resize(current.normals.size());
	field.weights.resize(current.normals.size());
	for (std::size_t i = 0; i < current.normals.size(); ++i) {
		const Point blend = ORIGINAL_SHARE * original.areas[i] * original.normals[i] +
							(1 - ORIGINAL_SHARE) * current.areas[i] * current.normals[i];
		field.weights[i] = blend.norm();
		field.data[i] = field.weights[i] > 0 ? Point(blend / field.weights[i]) : blend;
	}
	return field;
}

/// One run of the method.
class AdaptiveMethod {
public:
	AdaptiveMethod(const Workspace& workspace, const Plan& plan) :
			workspace_(workspace), plan_(plan), sigma_(plan.noise * workspace.mean_edge_length),
			positions_(workspace.mesh.positions)
	{
	}

	std::vector<Point> run()
	{
		prefilter();
		// The level is in edge lengths of the surface below the noise, which lengthens them.
		sigma_ = plan_.noise * mean_edge_length(positions_, workspace_.mesh.faces);
		const std::vector<Point> start = positions_;
		const FaceGeometry original = face_geometry(positions_, workspace_.mesh.faces);
		for (int iteration = 0; iteration < plan_.iterations; ++iteration) {
			const FaceGeometry current = face_geometry(positions_, workspace_.mesh.faces);
			std::vector<Point> normals = filter(original, current, iteration);
			if (iteration + 1 == plan_.iterations && !plan_.scanner)
				refine(current, normals);
			begin_phase(iteration, 0.8, 1.0, "moving vertices");
			VertexUpdateOptions update;
			update.iterations = plan_.vertex_iterations;
			update.area_weights = true;
			update.unfold_cosine = FOLD_COSINE;
			if (!plan_.scanner) {
				update.accelerated = true;
				update.rest = &start;
			}
			update_vertices(workspace_, normals, update, positions_);
			// Eq. 12 lets vertices slide where normals do not agree; noise does not reach so far.
			if (!plan_.scanner)
				bound_drift(start, DRIFT_BOUND * sigma_);
		}
		return std::move(positions_);
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

	// Keeps every vertex within a distance of the way from where it was measured to a place.
	void bound_drift(const std::vector<Point>& to, double bound)
	{
		for (std::size_t i = 0; i < positions_.size(); ++i) {
			const Point& measured = workspace_.mesh.positions[i];
			const Point way = to[i] - measured;
			const Point move = positions_[i] - measured;
			const double square = way.squaredNorm();
			const double share = square > 0 ? move.dot(way) / square : 0;
			const Point drift = move - std::min(1.0, std::max(0.0, share)) * way;
			const double length = drift.norm();
			if (length > bound)
				positions_[i] -= (1 - bound / length) * drift;
		}
	}

	void prefilter()
	{
		const std::vector<Point>& measured = workspace_.mesh.positions;
		workspace_.execution.begin_phase(0.1, 0.15, "unfolding faces");
		taubin_smooth(workspace_, plan_.prefilter_pairs, positions_);
		if (plan_.scanner)
			return;
		bound_drift(measured, PREFILTER_BOUND * sigma_);
		for (int pair = 0; pair < UNFOLDING_PAIRS; ++pair) {
			const FoldCriterion criterion {FOLD_COSINE, FOLD_HEIGHT * sigma_};
			taubin_smooth(
				workspace_, 1, positions_, folded_vertices(workspace_, positions_, criterion));
		}
		bound_drift(measured, UNFOLDING_BOUND * sigma_);
	}

	std::vector<Point>
	filter(const FaceGeometry& original, const FaceGeometry& current, int iteration) const
	{
		begin_phase(iteration, 0.0, 0.5, "fitting normals");
		NormalFilterOptions options;
		options.cos_threshold =
			std::min(1.0, plan_.cos_threshold + iteration * plan_.cos_threshold_increment);
		options.smallest_ring = plan_.rings.smallest;
		options.largest_ring = plan_.rings.largest;
		options.selection = plan_.selection;
		return filter_normals(workspace_, normal_field(original, current), options);
	}

	// Takes the normals from the measured heights instead, as far as it is clear which faces go
	// together.
	void refine(const FaceGeometry& current, std::vector<Point>& normals) const
	{
		begin_phase(plan_.iterations - 1, 0.5, 0.8, "fitting heights");
		HeightFilterOptions options;
		options.largest_ring = plan_.height_rings;
		options.sigma = sigma_;
		options.selection = HEIGHT_SELECTION;
		const std::vector<Point> refined = normals_from_heights(
			workspace_, {normals, current.centroids, workspace_.mesh.positions}, options);
		const std::vector<LocalAmbiguity> ambiguities =
			measure_ambiguity(workspace_, normals, current.areas);
		for (std::size_t i = 0; i < normals.size(); ++i) {
			const LocalAmbiguity& local = ambiguities[i];
			// Noise in local edge lengths over that at which the limit holds.
			const double edge = EDGE_PER_ROOT_AREA * std::sqrt(local.mean_area);
			const double doubt =
				local.ambiguity * sigma_ / (AMBIGUITY_LIMIT * AMBIGUITY_NOISE * edge);
			const double square = 2 - 2 * normals[i].dot(refined[i]);
			const double disagreement = square / (DISAGREEMENT * DISAGREEMENT);
			const double share = std::min(1.0, std::max(doubt, disagreement));
			const Point blend = share * normals[i] + (1 - share) * refined[i];
			const double length = blend.norm();
			if (length > 0)
				normals[i] = blend / length;
		}
	}

	const Workspace& workspace_;
	const Plan& plan_;
	/// Noise in the caller's length unit.
	double sigma_ = 0;
	std::vector<Point> positions_;
};

} // namespace

void run_adaptive_method(
	const Workspace& workspace, const DenoiseOptions& options, DenoiseResult& result)
{
	workspace.execution.begin_phase(0.05, 0.1, "estimating the noise");
	result.estimated_noise = estimate_noise_level(workspace, workspace.mesh.positions);
	result.resolved.noise_level = options.noise_level.value_or(result.estimated_noise);
	const double noise = *result.resolved.noise_level * strength_factor(options.strength);
	const Plan plan = plan_for(options, noise);
	record(plan, result.resolved);
	if (!plan.scanner && noise < LEAST_NOISE) {
		result.status = DenoiseResult::Status::NothingToDo;
		return;
	}
	result.positions = AdaptiveMethod(workspace, plan).run();
	result.iterations_done = plan.iterations;
}

} // namespace orthopoly
