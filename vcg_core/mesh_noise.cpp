// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_noise.h"

#include "interpolation.h"
#include "local_heights.h"
#include "noise_correlation.h"
#include "noise_level.h"

#include <algorithm>
#include <vector>

namespace orthopoly {

namespace {

// Deviation of rounded coordinates from which what rounding leaves goes together over several
// edges, as terraces, and from which all of it does.
constexpr double FINE_ROUNDING = 0.14;
constexpr double COARSE_ROUNDING = 0.2;

} // namespace

MeshNoise estimate_mesh_noise(
	const Workspace& workspace, const DenoiseOptions& options, const CorrelationTrial& trial)
{
	workspace.execution.begin_phase(0.05, 0.08, "estimating the noise");
	const std::vector<Point>& measured = workspace.mesh.positions;
	const std::vector<Point> smooth = surface_below_heights(workspace, measured);
	const NoiseLevels levels = estimate_noise_levels(workspace, measured, smooth);
	MeshNoise noise;
	NoiseCorrelation found;
	NoiseCorrelation::ByRise by_rise;
	double deviation = 0;
	// Noise that differs from place to place looks as if it went together, but not the other way
	// round.
	const double even = 1 - levels.uneven.certainty;
	if (options.noise_type != NoiseType::White) {
		const bool scanner = options.noise_type == NoiseType::Scanner;
		found = measure_noise_correlation(workspace, measured, smooth, scanner);
		noise.of_grid = found.certainty();
		noise.correlation = {scanner ? 1 : even * noise.of_grid, found.reach()};
		if (levels.rounding > 0 && !scanner)
			noise.correlation.share = way_between(FINE_ROUNDING, COARSE_ROUNDING, levels.rounding);
		else {
			by_rise = found.by_rise();
			deviation = found.deviation();
		}
	}
	workspace.execution.begin_phase(0.08, 0.1, "looking for outliers");
	// Beside a clean part noise looks like outliers, and so does noise that is strong and
	// correlated.
	if (noise.correlation.share < 0.5 && levels.uneven.certainty < 0.5)
		noise.outliers = repair_outliers(workspace, levels);
	const double counts = even * (1 - noise.outliers.share);
	// What a polynomial over two rings follows of noise that goes together, one over more does not.
	double rough = std::max(levels.rough, found.narrow_level);
	const bool is_told = noise.correlation.share >= 1 || by_rise.share >= 1 || levels.rounding > 0;
	if (!is_told && counts * found.worth_trying() > 0) {
		const double by_trial =
			found.by_trial(trial(workspace, rough, {1, noise.correlation.reach}));
		by_rise.certainty = std::max(by_rise.certainty, by_trial);
		by_rise.share = std::max(by_rise.share, by_trial);
	}
	double certainty = std::max(noise.correlation.share, counts * by_rise.certainty);
	noise.correlation.share = std::max(noise.correlation.share, counts * by_rise.share);
	if (noise.correlation.share >= 0.5)
		noise.outliers = {};
	if (noise.outliers.share == 0 && levels.uneven.certainty > certainty) {
		noise.uneven = levels.uneven;
		noise.correlation.share = 0;
		certainty = 0;
	}
	// How far coordinates are off that were rounded is known; what grows beyond that is detail.
	if (levels.rounding > 0 && options.noise_type != NoiseType::Scanner)
		rough = levels.flat;
	else if (noise.correlation.share == 0)
		rough = levels.rough;
	// Noise that goes together over several edges grows with the rings as detail does.
	const double white = noise.outliers.share > 0 ? levels.flat : (1 - levels.drawn) * levels.flat;
	const auto level_for = [&](double correlated, double share) {
		const double same = between(white, correlated, share);
		const double level = between(same, noise.uneven.level, noise.uneven.certainty);
		return between(level, noise.outliers.level, noise.outliers.share);
	};
	noise.level = level_for(std::max(rough, deviation), certainty);
	noise.seen = noise.level > 0 ? level_for(rough, noise.correlation.share) / noise.level : 1;
	noise.most = std::max(rough, noise.uneven.level);
	noise.rounding = levels.rounding;
	return noise;
}

} // namespace orthopoly
