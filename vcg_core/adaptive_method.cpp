// SPDX-License-Identifier: GPL-3.0-or-later
#include "adaptive_method.h"

#include "adaptive_plan.h"
#include "adaptive_run.h"
#include "broad_detail.h"
#include "correlated_moves.h"
#include "detail.h"
#include "final_smoothing.h"
#include "interpolation.h"
#include "mesh_noise.h"
#include "mesh_part.h"
#include "noise_level.h"
#include "outliers.h"
#include "probe.h"
#include "sampling.h"
#include "spikes.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace orthopoly {

namespace {

// Share of the vertices found to be outliers up to which the others are taken for measured rightly,
// and from which there must be too many among them that were not found.
constexpr double FEW_OUTLIERS = 0.05;
constexpr double MANY_OUTLIERS = 0.15;

// Median share of what the method took that neighbours predict (see MovePredictor) from which it is
// detail for a good part; noise alone and smooth surfaces leave up to 0.17. The rest is the noise,
// worth another run where its level is by so much the lower one. It is lowered further only where
// still less than the level was taken: at the right one the method takes what is detail on top.
constexpr double DETAIL = 0.25;
constexpr double WORTH_LOWERING = 0.95;

// Runs at lower levels: each lowers it by a seventh or more, and two have been enough so far.
constexpr int MOST_LOWERINGS = 4;

// What a run takes of noise that goes together does so less than all of it, since what is left is
// broad: by 0.36 over an edge where the noise does by 0.46, by 0.61 where it does by 0.71.
constexpr double ALL_TOGETHER = 1.2;

// Faces of a mesh up to which all of it is denoised with a probe.
constexpr Index MOST_PROBED = 100000;

// A noise level that is set counts from here: less is rounding in the files that meshes come in.
constexpr double NEGLIGIBLE_NOISE = 1e-6;

// Share of the vertices whose noise the method is made for where it differs from place to place:
// what takes strong noise away does little where there is less, since the deviations tell it so.
constexpr double MOST_SHARE = 0.75;

// Share of the vertices whose noise is below the low end of what is told of it, and above the high
// one.
constexpr double LOW_SHARE = 0.1;

// What the noise is up to at most vertices, over the overall level.
double factor_planned_for(std::vector<double> factors)
{
	return factors.empty() ? 1 : std::max(1.0, quantile(factors, MOST_SHARE));
}

// What the method does about that level of the noise where its strong parts are so many times it.
AdaptivePlan plan_at(
	double level, double planned_for, const Correlation& correlation, const DenoiseOptions& options)
{
	AdaptivePlan plan = plan_for(options, level * planned_for, correlation);
	plan.noise = level;
	return plan;
}

// A level in edge lengths of one mesh, in those of a part of it.
double level_in(const Workspace& part, const Workspace& whole, double level)
{
	return level * (whole.mean_edge_length / part.mean_edge_length);
}

// What the method makes of a mesh.
std::vector<Point>
denoised(const Workspace& workspace, const AdaptivePlan& plan, const std::vector<double>& factors)
{
	std::vector<Point> positions = workspace.mesh.positions;
	run_adaptively(workspace, plan, factors, positions);
	return positions;
}

// What the method takes as if noise of that level were of that correlation: of a mesh of many faces
// in places. The same whatever options a user sets.
CorrelatedMoves
try_correlated(const Workspace& workspace, double level, const Correlation& correlation)
{
	const auto taken = [&](const Workspace& its_workspace, const auto& inner) {
		const double its_level = level_in(its_workspace, workspace, level);
		const AdaptivePlan plan = plan_for({}, its_level, correlation);
		return measure_correlated_moves(its_workspace, denoised(its_workspace, plan, {}), inner);
	};
	if (workspace.mesh.face_count() <= MOST_PROBED)
		return taken(workspace, std::vector<std::uint8_t>());
	const MeshPart part = cut_out_places(workspace);
	return taken(Workspace(part.mesh, workspace.execution), part.inner);
}

// Runs the method at that level of the noise, strength included, from the workspace's mesh on.
// Returns nothing where there is too little noise to do anything.
std::optional<AdaptiveRun> run_at(
	double level,
	const MeshNoise& noise,
	const Workspace& workspace,
	const DenoiseOptions& options,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	level *= noise.seen;
	const std::vector<double>& factors = noise.uneven.factors;
	AdaptivePlan plan = plan_at(level, factor_planned_for(factors), noise.correlation, options);
	// Outliers that were not found fold faces too, and are none of the level.
	if (noise.outliers.share > 0 && level > 0)
		plan.fold_factor = std::max(1.0, strength_factor(options.strength) * noise.most / level);
	record(plan, result.resolved);
	// Noise that goes together over several edges was found by more than its level.
	double least = plan.is_mostly_white() ? LEAST_NOISE : 0;
	if (options.noise_level)
		least = NEGLIGIBLE_NOISE;
	const bool nothing = options.noise_type != NoiseType::Scanner && level < least;
	result.status = nothing ? DenoiseResult::Status::NothingToDo : DenoiseResult::Status::Done;
	result.iterations_done = nothing ? 0 : plan.iterations;
	if (nothing)
		return std::nullopt;
	positions = workspace.mesh.positions;
	return run_adaptively(workspace, plan, factors, positions);
}

// Gives back what a run for noise that goes together took of detail. What rounding leaves is not
// alike everywhere: nothing on planes along an axis.
void give_back_detail_taken(
	const Workspace& workspace, const MeshNoise& noise, std::vector<Point>& positions)
{
	if (noise.correlation.share > 0 && noise.rounding == 0)
		give_back_uneven(workspace, noise.correlation.share, positions);
}

// How far noise that a run took goes together over an edge.
double edge_correlation_of_noise(const Workspace& workspace, const std::vector<Point>& positions)
{
	return ALL_TOGETHER * measure_correlated_moves(workspace, positions).edge_correlation;
}

// Smooths what a run left rough, and before that gives back what broad detail it took along with
// white noise. A mesh of many faces is tried out in places first, and what the method follows of
// noise there is taken for that of all of it.
void finish(
	double level,
	double sigma,
	const MeshNoise& noise,
	const Workspace& workspace,
	const DenoiseOptions& options,
	std::vector<Point>& positions)
{
	const std::vector<double>& factors = noise.uneven.factors;
	const Correlation& correlation = noise.correlation;
	const bool is_white = correlation.share == 0;
	// Along a grid noise goes together in ways of its own, which the probe does not have.
	const double counts = is_white ? 1 : correlation.share * (1 - noise.of_grid);
	if (counts == 0)
		return;
	const double together = is_white ? 0 : edge_correlation_of_noise(workspace, positions);
	const double planned_for = factor_planned_for(factors);
	const auto result_of = [&](const Workspace& its_workspace, const auto& its_factors) {
		const double its_level = level_in(its_workspace, workspace, level);
		const AdaptivePlan plan = plan_at(its_level, planned_for, correlation, options);
		std::vector<Point> result = denoised(its_workspace, plan, its_factors);
		give_back_detail_taken(its_workspace, noise, result);
		return result;
	};
	const auto responses_to =
		[&](const Probe& probe, TriangleMesh mesh, const auto& its_factors, const auto& plain) {
			mesh.positions = probe.with_probe(plain);
			const Workspace probed(mesh, workspace.execution);
			return probe.responses(plain, result_of(probed, its_factors));
		};
	FinalSmoothing smoothing;
	if (workspace.mesh.face_count() <= MOST_PROBED) {
		const Probe probe(workspace, {sigma, factors}, positions, together);
		const std::vector<Point> responses =
			responses_to(probe, workspace.mesh, factors, positions);
		if (is_white) {
			const BroadDetail detail(workspace, probe, positions);
			detail.give_back(detail.share_followed(responses), positions);
		}
		smoothing = choose_smoothing(workspace, probe, responses, positions);
	}
	else {
		const MeshPart part = cut_out_places(workspace);
		const std::vector<double> part_factors = part.values_of(factors);
		const Workspace part_workspace(part.mesh, workspace.execution);
		std::vector<Point> part_positions = result_of(part_workspace, part_factors);
		const Probe probe(part_workspace, {sigma, part_factors}, part_positions, together);
		const std::vector<Point> responses =
			responses_to(probe, part.mesh, part_factors, part_positions);
		if (is_white) {
			const BroadDetail detail(part_workspace, probe, part_positions);
			const double followed = detail.share_followed(responses, part.inner);
			if (detail.certainty(followed, part.inner) > 0) {
				detail.give_back(followed, part_positions);
				const Probe whole(workspace, {sigma, factors}, positions);
				BroadDetail(workspace, whole, positions).give_back(followed, positions);
			}
		}
		smoothing = choose_smoothing(part_workspace, probe, responses, part_positions, part.inner);
	}
	smoothing.share *= counts;
	smooth_finally(workspace, smoothing, positions);
}

// Runs the method at the estimated level or the one that is set; where what an estimate takes
// proves to be detail for a good part, again at the level of the rest.
void lower_and_run(
	const Workspace& workspace,
	const DenoiseOptions& options,
	const MeshNoise& noise,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	const double strength = strength_factor(options.strength);
	const auto run = [&](double at_level) {
		return run_at(at_level, noise, workspace, options, result, positions);
	};
	double& level = *result.resolved.noise_level;
	std::optional<AdaptiveRun> last = run(strength * level);
	if (noise.correlation.share > 0) {
		if (last) {
			give_back_detail_taken(workspace, noise, positions);
			finish(
				strength * level * noise.seen, last->sigma, noise, workspace, options, positions);
		}
		return;
	}
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
	else
		finish(strength * level * noise.seen, last->sigma, noise, workspace, options, positions);
}

// The same with the outliers put back first, and the other vertices in the end.
void repair_and_run(
	const Workspace& workspace,
	const DenoiseOptions& options,
	const MeshNoise& noise,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	const OutlierRepair& outliers = noise.outliers;
	const double level = *result.resolved.noise_level * strength_factor(options.strength);
	TriangleMesh mesh = workspace.mesh;
	mesh.positions = outliers.positions;
	const Workspace repaired(mesh, workspace.execution);
	if (!run_at(level, noise, repaired, options, result, positions))
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

// Runs the method for the noise that the workspace's mesh has.
void run_for(
	const MeshNoise& noise,
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
		repair_and_run(workspace, options, noise, result, positions);
	record_range(noise.uneven.factors, result);
}

} // namespace

void run_adaptive_method(
	const Workspace& workspace,
	const DenoiseOptions& options,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	const MeshNoise noise = estimate_mesh_noise(workspace, options, try_correlated);
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
	const MeshNoise left = estimate_mesh_noise(without, options, try_correlated);
	run_for(left, without, options, result, positions);
	result.spikes = static_cast<Index>(spikes.vertices.size());
	if (result.status == DenoiseResult::Status::NothingToDo)
		result.status = DenoiseResult::Status::Done;
}

} // namespace orthopoly
