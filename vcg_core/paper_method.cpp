// SPDX-License-Identifier: GPL-3.0-or-later
#include "paper_method.h"

#include "guide_direction.h"
#include "polynomial_fit.h"
#include "vertex_update.h"

#include <algorithm>
#include <string>

namespace orthopoly {

namespace {

// Where this method's share of the progress begins.
constexpr double PROGRESS_BEGIN = 0.05;

// Shares of an iteration's time, at the defaults on a mesh of 100,000 faces.
constexpr double GUIDE_END = 0.25;
constexpr double FIT_END = 0.85;

// Rounds and steps of the paper's section 5, its threshold for strong noise and its increment for
// the other models of Table 2.
constexpr int ITERATIONS = 5;
constexpr int VERTEX_ITERATIONS = 10;
constexpr double COS_THRESHOLD = 0.65;
constexpr double COS_THRESHOLD_INCREMENT = 0.05;

// At a cosine of 1 no direction is similar to any other, its own included.
constexpr double LARGEST_COS_THRESHOLD = 1.0 - 1e-6;

// The paper leaves R open; one ring more than the structures it looks for, as far as the parameter
// goes.
int default_structure_ring(const DenoiseOptions& options)
{
	return std::min(DenoiseOptions::MAX_RINGS, options.guide_ring + 1);
}

DenoiseOptions resolve(DenoiseOptions options)
{
	options.iterations = options.iterations.value_or(ITERATIONS);
	options.vertex_iterations = options.vertex_iterations.value_or(VERTEX_ITERATIONS);
	options.structure_ring = options.structure_ring.value_or(default_structure_ring(options));
	options.cos_threshold = options.cos_threshold.value_or(COS_THRESHOLD);
	options.cos_threshold_increment =
		options.cos_threshold_increment.value_or(COS_THRESHOLD_INCREMENT);
	return options;
}

// One round of the method: from positions to positions.
class Iteration {
public:
	Iteration(const Workspace& workspace, const DenoiseOptions& resolved) : workspace_(workspace)
	{
		guide_.ring = resolved.guide_ring;
		guide_.sigma_theta = resolved.sigma_theta;
		filter_.structures.local_ring = resolved.guide_ring;
		filter_.structures.search_ring = *resolved.structure_ring;
		filter_.fit.order_x = resolved.order_x;
		filter_.fit.order_y = resolved.order_y;
		update_.iterations = *resolved.vertex_iterations;
	}

	void set_cos_threshold(double cosine)
	{
		filter_.structures.cos_threshold = std::min(cosine, LARGEST_COS_THRESHOLD);
	}

	// Progress runs over the fractions [begin, end).
	void run(double begin, double end, const std::string& name, std::vector<Point>& positions)
	{
		const auto phase = [&](double from, double to, const char* step) {
			workspace_.execution.begin_phase(
				begin + from * (end - begin), begin + to * (end - begin), name + ": " + step);
		};
		phase(0, GUIDE_END, "guide directions");
		const FaceGeometry geometry = face_geometry(workspace_, positions);
		const std::vector<Point> guides = guide_directions(workspace_, geometry, guide_);
		phase(GUIDE_END, FIT_END, "fitting normals");
		const std::vector<Point> normals =
			filter_normals(workspace_, geometry.normals, guides, filter_);
		phase(FIT_END, 1, "moving vertices");
		update_vertices(workspace_, normals, update_, positions);
	}

private:
	const Workspace& workspace_;
	GuideDirectionOptions guide_;
	PolynomialFilterOptions filter_;
	VertexUpdateOptions update_;
};

} // namespace

void run_paper_method(
	const Workspace& workspace,
	const DenoiseOptions& options,
	DenoiseResult& result,
	std::vector<Point>& positions)
{
	result.resolved = resolve(options);
	result.resolved.threads = workspace.execution.threads();
	const int iterations = *result.resolved.iterations;
	const double length = (1.0 - PROGRESS_BEGIN) / iterations;
	Iteration iteration(workspace, result.resolved);
	for (int i = 0; i < iterations; ++i) {
		// Section 5: the threshold grows with each iteration.
		iteration.set_cos_threshold(
			*result.resolved.cos_threshold + i * *result.resolved.cos_threshold_increment);
		const double begin = PROGRESS_BEGIN + i * length;
		iteration.run(
			begin,
			begin + length,
			"iteration " + std::to_string(i + 1) + " of " + std::to_string(iterations),
			positions);
		++result.iterations_done;
	}
}

} // namespace orthopoly
