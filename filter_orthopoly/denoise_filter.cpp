// SPDX-License-Identifier: GPL-3.0-or-later
#include "denoise_filter.h"

#include "denoise.h"
#include "errors.h"
#include "execution.h"
#include "layers.h"
#include "progress_part.h"

#include <algorithm>
#include <chrono>
#include <optional>

namespace orthopoly {

namespace {

const char* const COMPARE = "compare_with_reference";

FilterParameter compare_parameter()
{
	FilterParameter parameter;
	parameter.name = COMPARE;
	parameter.label = "Compare with a reference";
	parameter.tooltip =
		"Also measures the mesh against the reference mesh below, before and after: the faces are "
		"coloured by angular error, which is also their quality (degrees); the quality of a vertex is "
		"its distance to the reference; the figures go to the log and the output values. It changes "
		"nothing about the denoising.";
	parameter.type = ParameterType::Boolean;
	parameter.maximum = 1;
	return parameter;
}

// What the user compares with, and how the mesh stood before.
struct Comparison {
	double max_angle;
	ReferenceMeasure reference;
	ErrorMeasures before;
};

std::optional<Comparison>
start_comparison(FilterRun& run, const VcgArrays& arrays, Progress& progress)
{
	if (!run.values.is_on(COMPARE))
		return std::nullopt;
	report_or_stop(progress, 0, "reading the reference");
	Comparison comparison = {
		checked_value(max_angle_parameter(), run.values),
		ReferenceMeasure(read_reference(run)),
		{},
	};
	comparison.before = comparison.reference.measure(arrays.mesh, progress);
	return comparison;
}

bool may_be_automatic(const ParameterInfo& entry)
{
	return entry.can_be_automatic || (!entry.choices.empty() && entry.choices.front() == "auto");
}

bool is_automatic(const ParameterInfo& entry, double value)
{
	return may_be_automatic(entry) && value == (entry.can_be_automatic ? AUTOMATIC : 0);
}

// The values that the method chose itself.
std::string describe_resolved(const DenoiseOptions& given, const DenoiseOptions& resolved)
{
	std::string text;
	for (const Parameter<DenoiseOptions>& entry : denoise_parameters()) {
		const double value = entry.get(resolved);
		if (!is_automatic(entry, entry.get(given)) || is_automatic(entry, value))
			continue;
		text += (text.empty() ? "chosen: " : ", ") + entry.name + " = " + entry.format(value);
	}
	return text;
}

void report_resolved(FilterRun& run, const DenoiseOptions& resolved)
{
	for (const Parameter<DenoiseOptions>& entry : denoise_parameters()) {
		const double value = entry.get(resolved);
		// What the method does not use stays automatic.
		if (!may_be_automatic(entry) || is_automatic(entry, value))
			continue;
		const std::string name = "resolved_" + entry.name;
		if (entry.type == ParameterType::Real)
			run.outputs.emplace_back(name, value);
		else
			// Of a choice, its number: pymeshlab does not hand words on.
			run.outputs.emplace_back(name, static_cast<int>(value));
	}
}

std::string describe_nothing_to_do(const DenoiseOptions& options)
{
	if (options.noise_level)
		return "noise_level is " + in_words(*options.noise_level) +
			   ", so there is nothing to remove and the mesh is left as it is; raise noise_level, or set "
			   "it to -1 to have the noise estimated";
	return "there is no noise worth removing, so the mesh is left as it is; if it is rippled over "
		   "several edges, set noise_type to scanner; set noise_level to denoise it all the same";
}

// How far the noise differs from place to place; nothing where it does not.
std::string describe_range(const DenoiseResult& result)
{
	if (result.estimated_noise_low == result.estimated_noise_high)
		return "";
	return ", uneven: from " + in_words(result.estimated_noise_low) + " to " +
		   in_words(result.estimated_noise_high) + " in most places";
}

void report_result(FilterRun& run, const DenoiseOptions& options, const DenoiseResult& result)
{
	const bool nothing_to_do = result.status == DenoiseResult::Status::NothingToDo;
	if (options.method == Method::Adaptive)
		run.log(
			"noise along the surface normals: " + in_words(result.estimated_noise) +
			" mean edge lengths (estimated)" + describe_range(result) +
			(options.noise_level ? ", taken as " + in_words(*options.noise_level) : ""));
	if (result.spikes > 0)
		run.log(
			count_of(result.spikes, "lone vertex", "lone vertices") +
			" far out (spikes) put back onto the surface");
	if (nothing_to_do)
		run.log(describe_nothing_to_do(options));
	const std::string resolved = describe_resolved(options, result.resolved);
	if (!resolved.empty())
		run.log(resolved);
	run.log(
		count_of(result.iterations_done, "iteration", "iterations") + ", " +
		count_of(result.moved_vertices, "vertex", "vertices") + " moved, by " +
		in_words(result.mean_displacement) + " (mean of all vertices), " +
		in_words(result.max_displacement) + " at most");
	run.log(
		"faces folded over: " + std::to_string(result.folded_faces_before) + " before, " +
		std::to_string(result.folded_faces_after) + " after");
	if (result.degenerate_faces > 0)
		run.log(
			count_of(result.degenerate_faces, "face", "faces") +
			" without area took no part and were kept");
	if (result.non_manifold_edges > 0)
		run.log(
			count_of(result.non_manifold_edges, "edge", "edges") +
			" with more than two faces, or two faces of opposite orientation: results are less good "
			"there");
	if (result.seam_vertices > 0)
		run.log(
			count_of(result.seam_vertices, "vertex", "vertices") +
			" along seams, where another is at the same place, moved with that one");

	run.outputs.insert(
		run.outputs.end(),
		{
			{"nothing_to_do", nothing_to_do},
			{"iterations_done", result.iterations_done},
			{"degenerate_faces", static_cast<int>(result.degenerate_faces)},
			{"non_manifold_edges", static_cast<int>(result.non_manifold_edges)},
			{"seam_vertices", static_cast<int>(result.seam_vertices)},
			{"folded_faces_before", static_cast<int>(result.folded_faces_before)},
			{"folded_faces_after", static_cast<int>(result.folded_faces_after)},
			{"moved_vertices", static_cast<int>(result.moved_vertices)},
			{"mean_displacement", result.mean_displacement},
			{"max_displacement", result.max_displacement},
		});
	if (options.method == Method::Adaptive)
		run.outputs.insert(
			run.outputs.end(),
			{
				{"estimated_noise", result.estimated_noise},
				{"estimated_noise_low", result.estimated_noise_low},
				{"estimated_noise_high", result.estimated_noise_high},
				{"spikes", static_cast<int>(result.spikes)},
			});
	report_resolved(run, result.resolved);
}

} // namespace

std::string DenoiseFilter::name() const
{
	return "Orthogonal Polynomial Denoising";
}

std::string DenoiseFilter::python_name() const
{
	return "apply_coord_orthogonal_polynomial_denoising";
}

std::string DenoiseFilter::info() const
{
	return "Removes noise from a triangle mesh and keeps edges, corners and fine detail. Only vertices "
		   "move; faces stay as they are.<br>"
		   "Apply it as it is: the method <b>adaptive</b> estimates the noise and chooses everything "
		   "else from the mesh. Where detail is lost, set the strength to gentle; where noise is left, "
		   "to strong; where ripples over several edges are left, set the kind of noise to scanner. The method "
		   "<b>paper</b> is the published one: face normals are filtered by discrete orthogonal "
		   "polynomials fitted to non-local similar structures, and the vertices follow.<br>"
		   "If you have the true shape in another layer, compare with it: faces are coloured by the "
		   "angle to it (blue: none, red: the colour range and more).<br>"
		   "See: <b>\"Surface Smoothing based on Discrete Orthogonal Polynomial\"</b>";
}

Menu DenoiseFilter::menu() const
{
	return Menu::Smoothing;
}

bool DenoiseFilter::works_on_current_layer() const
{
	return true;
}

int DenoiseFilter::may_change(const MeshDocument& document) const
{
	const int moved = MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
	const int painted =
		MeshModel::MM_FACECOLOR | MeshModel::MM_FACEQUALITY | MeshModel::MM_VERTQUALITY;
	// Hosts put aside, and so create, all that a filter may change while they preview it: a mesh on
	// its own has nothing to be compared with and shall not come by face colours.
	Index layers = 0;
	for_each_layer(document, [&](const MeshModel&) { ++layers; });
	return layers > 1 ? moved | painted : moved;
}

FilterParameters DenoiseFilter::parameters(const MeshDocument& document) const
{
	FilterParameters parameters = table_parameters(denoise_parameters());
	parameters.push_back(only_selected_parameter(document));
	parameters.push_back(compare_parameter());
	parameters.push_back(reference_parameter(
		document,
		"The layer with the true shape. Of no effect unless 'Compare with a reference' is on."));
	parameters.push_back(max_angle_parameter());
	// What most people never touch comes last, where a host does not hide it.
	std::stable_partition(
		parameters.begin(), parameters.end(), [](const FilterParameter& parameter) {
			return !parameter.advanced;
		});
	return parameters;
}

void DenoiseFilter::apply(FilterRun& run) const
{
	const DenoiseOptions options = table_options(denoise_parameters(), run.values);
	validate(options);
	const VcgArrays arrays = read_current_layer(run);
	Progress progress = vcg_progress(run.callback);
	report_or_stop(progress, 0, "reading the mesh");
	const double measuring = run.values.is_on(COMPARE) ? MEASURING_SHARE : 0;
	Progress first_part = part_of(progress, 0, measuring);
	const std::optional<Comparison> comparison = start_comparison(run, arrays, first_part);

	Progress second_part = part_of(progress, measuring, 1 - measuring);
	const auto start = std::chrono::steady_clock::now();
	const DenoiseResult result = denoise(arrays.mesh, options, second_part);
	const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
	if (result.status == DenoiseResult::Status::Cancelled)
		throw Cancelled();
	std::optional<ErrorMeasures> after;
	if (comparison) {
		TriangleMesh denoised;
		denoised.positions = result.positions;
		denoised.faces = arrays.mesh.faces;
		Progress last_part = part_of(progress, 1 - measuring, 1);
		after = comparison->reference.measure(denoised, last_part);
	}
	report_or_stop(progress, 1, "done");

	// From here on nothing is refused. Painting first: it is what may run out of memory.
	if (after)
		paint_errors(run, arrays, *after, comparison->max_angle);
	if (result.moved_vertices > 0)
		write_current_layer(run, arrays, result.positions);
	report_result(run, options, result);
	// What the layer costs comes on top of it; tests/bench/speed.py tells the one from the other.
	run.log("denoised in " + in_words(taken.count()) + " seconds");
	if (after) {
		report_errors(run, comparison->before, "noisy_");
		report_errors(run, *after, "");
		run.outputs.emplace_back("paired_by_index", after->paired_by_index);
		run.log("against the reference: " + describe_pairing(*after, arrays));
		run.log("before: " + describe_errors(comparison->before));
		run.log("after: " + describe_errors(*after));
	}
}

} // namespace orthopoly
