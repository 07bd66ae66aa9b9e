// SPDX-License-Identifier: GPL-3.0-or-later
#include "denoise.h"
#include "errors.h"
#include "execution.h"
#include "inspection.h"
#include "measures.h"
#include "mesh_io.h"
#include "noise.h"
#include "noise_level.h"
#include "parameters.h"
#include "progress_part.h"
#include "seams.h"
#include "terminal.h"
#include "workspace.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <exception>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace orthopoly {

namespace {

// Keeps the order in which keys are added.
using Json = nlohmann::ordered_json;

constexpr int EXIT_ERROR = 1;
// What a shell reports for a program that Ctrl-C ended.
constexpr int EXIT_INTERRUPTED = 130;

struct DenoiseArguments {
	std::string input;
	std::string output;
	std::string method;
	std::vector<std::string> settings;
	std::string threads;
	std::string reference;
	bool json = false;
};

struct NoiseArguments {
	std::string input;
	std::string output;
	std::string sigma;
	std::string direction;
	std::string impulsive_share;
	std::string seed;
};

struct MeasureArguments {
	std::string reference;
	std::string result;
	std::string max_distance;
	bool json = false;
};

struct InfoArguments {
	std::string input;
	bool json = false;
};

void apply_setting(const std::string& setting, DenoiseOptions& options)
{
	const std::size_t equals = setting.find('=');
	if (equals == std::string::npos)
		throw InvalidParameter("--set wants name=value, not '" + setting + "'");
	set_parameter(
		denoise_parameters(), setting.substr(0, equals), setting.substr(equals + 1), options);
}

// An option that was not given leaves the default.
template<class Options>
void set_if_given(
	const ParameterTable<Options>& table,
	const std::string& name,
	const std::string& text,
	Options& options)
{
	if (!text.empty())
		set_parameter(table, name, text, options);
}

DenoiseOptions denoise_options(const DenoiseArguments& arguments)
{
	DenoiseOptions options;
	set_if_given(denoise_parameters(), "method", arguments.method, options);
	for (const std::string& setting : arguments.settings)
		apply_setting(setting, options);
	set_if_given(denoise_parameters(), "threads", arguments.threads, options);
	return options;
}

Json to_json(const Parameter<DenoiseOptions>& parameter, double value)
{
	if (parameter.can_be_automatic && value == AUTOMATIC)
		return "auto";
	switch (parameter.type) {
	case ParameterType::Choice: return parameter.format(value);
	case ParameterType::Boolean: return value != 0;
	case ParameterType::Integer: return static_cast<long long>(value);
	case ParameterType::Real: break;
	}
	return value;
}

Json to_json(const ErrorMeasures& measures)
{
	return {
		{"mean_angle", measures.mean_angle},
		{"max_angle", measures.max_angle},
		{"msae", measures.msae},
		{"msae_without_folded", measures.msae_without_folded},
		{"vertex_error", measures.vertex_error},
		{"relative_vertex_error", measures.relative_vertex_error},
		{"max_distance", measures.max_distance},
		{"folded_faces", measures.folded_faces},
		{"folded_in_reference", measures.folded_in_reference},
		{"measured_faces", measures.measured_faces},
		{"paired_by_index", measures.paired_by_index},
	};
}

Json to_json(const TriangleMesh& mesh)
{
	return {
		{"vertices", mesh.vertex_count()},
		{"faces", mesh.face_count()},
		{"mean_edge_length", mean_edge_length(mesh.positions, mesh.faces)},
		{"bounding_box_diagonal", bounding_box_diagonal(mesh.positions)},
	};
}

const char* status_name(DenoiseResult::Status status)
{
	switch (status) {
	case DenoiseResult::Status::Done: return "done";
	case DenoiseResult::Status::Cancelled: return "cancelled";
	case DenoiseResult::Status::NothingToDo: return "nothing to do";
	}
	return "";
}

// One line a measure, one column a mesh.
void print_measures(const std::vector<const ErrorMeasures*>& columns)
{
	struct Row {
		const char* label;
		double (*value)(const ErrorMeasures&);
	};
	static const std::vector<Row> rows = {
		{"mean angle (degrees)", [](const ErrorMeasures& m) { return m.mean_angle; }},
		{"largest angle (degrees)", [](const ErrorMeasures& m) { return m.max_angle; }},
		{"MSAE (radians squared)", [](const ErrorMeasures& m) { return m.msae; }},
		{"MSAE, folded left out", [](const ErrorMeasures& m) { return m.msae_without_folded; }},
		{"E_v", [](const ErrorMeasures& m) { return m.vertex_error; }},
		{"E_v / mean edge length", [](const ErrorMeasures& m) { return m.relative_vertex_error; }},
		{"largest distance", [](const ErrorMeasures& m) { return m.max_distance; }},
		{"folded faces",
		 [](const ErrorMeasures& m) { return static_cast<double>(m.folded_faces); }},
		{"of these, in the truth",
		 [](const ErrorMeasures& m) { return static_cast<double>(m.folded_in_reference); }},
	};
	for (const Row& row : rows) {
		std::cout << "  " << std::left << std::setw(24) << row.label << std::right;
		for (const ErrorMeasures* column : columns)
			std::cout << std::setw(14) << row.value(*column);
		std::cout << "\n";
	}
}

void print_result(const TriangleMesh& mesh, const DenoiseResult& result, double seconds)
{
	std::cout << mesh.vertex_count() << " vertices, " << mesh.face_count() << " faces: "
			  << (result.status == DenoiseResult::Status::NothingToDo ?
					  "no noise worth removing, positions left as they are (if it is rippled "
					  "over several edges: --set noise_type=scanner)" :
					  "denoised")
			  << " in " << seconds << " s\n";
	if (result.resolved.method == Method::Adaptive) {
		std::cout << "  estimated noise along the normal: " << result.estimated_noise
				  << " mean edge lengths";
		if (result.estimated_noise_low != result.estimated_noise_high)
			std::cout << ", uneven: from " << result.estimated_noise_low << " to "
					  << result.estimated_noise_high << " in most places";
		std::cout << "\n";
	}
	std::cout << "  parameters:";
	for (const Parameter<DenoiseOptions>& parameter : denoise_parameters())
		std::cout << " " << parameter.name << "="
				  << parameter.format(parameter.get(result.resolved));
	std::cout << "\n  iterations " << result.iterations_done << ", folded faces "
			  << result.folded_faces_before << " before and " << result.folded_faces_after
			  << " after, vertices moved " << result.moved_vertices << " (mean "
			  << result.mean_displacement << ", most " << result.max_displacement << ")\n";
	if (result.degenerate_faces > 0 || result.non_manifold_edges > 0)
		std::cout << "  left out: " << result.degenerate_faces << " faces without area; "
				  << result.non_manifold_edges << " non-manifold edges kept as they are\n";
	if (result.spikes > 0)
		std::cout << "  spikes: " << result.spikes << " lone vertices far out put back\n";
	if (result.seam_vertices > 0)
		std::cout << "  seams: " << result.seam_vertices
				  << " vertices moved with another at the same place\n";
}

int run_denoise(const DenoiseArguments& arguments)
{
	const DenoiseOptions options = denoise_options(arguments);
	validate(options);
	check_savable(arguments.output);
	const TriangleMesh mesh = load_mesh(arguments.input);
	std::optional<ReferenceMeasure> reference;
	if (!arguments.reference.empty())
		reference.emplace(load_mesh(arguments.reference));

	catch_interrupt();
	Progress progress = terminal_progress();
	const double measuring = reference ? MEASURING_SHARE : 0;
	std::optional<ErrorMeasures> before;
	if (reference) {
		// Now rather than at the end: a reference that will not do is refused before the work.
		Progress first_part = part_of(progress, 0, measuring);
		before = reference->measure(mesh, first_part);
	}
	Progress second_part = part_of(progress, measuring, 1 - measuring);
	const auto start = std::chrono::steady_clock::now();
	const DenoiseResult result = denoise(mesh, options, second_part);
	const double seconds =
		std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
	if (result.status == DenoiseResult::Status::Cancelled)
		throw Cancelled();
	TriangleMesh denoised = mesh;
	denoised.positions = result.positions;
	std::optional<ErrorMeasures> after;
	if (reference) {
		Progress last_part = part_of(progress, 1 - measuring, 1);
		after = reference->measure(denoised, last_part);
	}
	clear_progress();
	if (interrupted())
		throw Cancelled();
	save_mesh(arguments.output, denoised);

	if (arguments.json) {
		Json parameters;
		for (const Parameter<DenoiseOptions>& parameter : denoise_parameters())
			parameters[parameter.name] = to_json(parameter, parameter.get(result.resolved));
		Json json = {
			{"input", to_json(mesh)},
			{"status", status_name(result.status)},
			{"seconds", seconds},
			{"parameters", parameters},
			{"iterations_done", result.iterations_done},
			{"degenerate_faces", result.degenerate_faces},
			{"non_manifold_edges", result.non_manifold_edges},
			{"seam_vertices", result.seam_vertices},
			{"folded_faces_before", result.folded_faces_before},
			{"folded_faces_after", result.folded_faces_after},
			{"moved_vertices", result.moved_vertices},
			{"mean_displacement", result.mean_displacement},
			{"max_displacement", result.max_displacement},
		};
		// The paper's method estimates nothing.
		if (options.method == Method::Adaptive) {
			json["estimated_noise"] = result.estimated_noise;
			json["estimated_noise_low"] = result.estimated_noise_low;
			json["estimated_noise_high"] = result.estimated_noise_high;
			json["spikes"] = result.spikes;
		}
		if (reference) {
			json["noisy"] = to_json(*before);
			json["result"] = to_json(*after);
		}
		std::cout << json.dump(2) << "\n";
		return 0;
	}
	print_result(mesh, result, seconds);
	if (reference) {
		std::cout << "  against " << arguments.reference << ", noisy and denoised:\n";
		print_measures({&*before, &*after});
	}
	return 0;
}

int run_noise(const NoiseArguments& arguments)
{
	NoiseOptions options;
	set_if_given(noise_parameters(), "sigma", arguments.sigma, options);
	set_if_given(noise_parameters(), "direction", arguments.direction, options);
	set_if_given(noise_parameters(), "impulsive_share", arguments.impulsive_share, options);
	set_if_given(noise_parameters(), "seed", arguments.seed, options);
	check_savable(arguments.output);
	TriangleMesh mesh = load_mesh(arguments.input);
	mesh.positions = add_noise(mesh, options);
	save_mesh(arguments.output, mesh);
	return 0;
}

ParameterInfo max_distance()
{
	ParameterInfo parameter;
	parameter.name = "max_distance";
	parameter.maximum = std::numeric_limits<double>::max();
	return parameter;
}

int run_measure(const MeasureArguments& arguments)
{
	MeasureOptions options;
	if (!arguments.max_distance.empty())
		options.max_distance = max_distance().parse(arguments.max_distance);
	const ReferenceMeasure reference(load_mesh(arguments.reference), options);
	const TriangleMesh result = load_mesh(arguments.result);
	catch_interrupt();
	Progress progress = terminal_progress();
	const ErrorMeasures measures = reference.measure(result, progress);
	clear_progress();
	if (measures.measured_faces == 0)
		throw InvalidParameter(
			"none of the " + std::to_string(result.face_count()) +
			" faces has an area and lies within --max-distance of the reference; give more (0: no "
			"limit)");
	if (arguments.json) {
		std::cout << to_json(measures).dump(2) << "\n";
		return 0;
	}
	std::cout << arguments.result << " against " << arguments.reference << ", faces paired by "
			  << (measures.paired_by_index ? "index" : "closest point") << ":\n";
	print_measures({&measures});
	return 0;
}

// Along the normal, in mean edge lengths, if it is independent from vertex to vertex. No more than
// one of the things that denoising looks at: whether the noise goes together, whether outliers
// make it and whether it proves to be detail comes on top.
double white_noise(const TriangleMesh& mesh)
{
	Progress progress;
	Execution execution(0, progress);
	const Workspace workspace(mesh, execution);
	return estimate_noise_level(workspace, mesh.positions);
}

int run_info(const InfoArguments& arguments)
{
	const TriangleMesh mesh = load_mesh(arguments.input);
	const Inspection found = inspect(mesh);
	Json json = to_json(mesh);
	json["components"] = found.components;
	json["boundary_vertices"] = found.boundary_vertices;
	json["degenerate_faces"] = found.degenerate_faces;
	json["duplicate_faces"] = found.duplicate_faces;
	json["duplicate_vertices"] = found.duplicate_vertices;
	json["seam_vertices"] = found.seam_vertices;
	json["unreferenced_vertices"] = found.unreferenced_vertices;
	json["non_manifold_edges"] = found.non_manifold_edges;
	json["not_finite_vertices"] = found.not_finite_vertices;
	// Defects are what this command is for: those that all others refuse are told with the rest.
	try {
		validate(mesh);
		if (found.degenerate_faces < mesh.face_count())
			json["white_noise"] = white_noise(sew(mesh, find_seams(mesh)));
	}
	catch (const InvalidMesh& error) {
		json["unusable"] = error.what();
	}
	if (arguments.json) {
		std::cout << json.dump(2) << "\n";
		return 0;
	}
	for (const auto& [name, value] : json.items()) {
		std::string words = name;
		std::replace(words.begin(), words.end(), '_', ' ');
		std::cout << words << ": " << (value.is_string() ? value.get<std::string>() : value.dump())
				  << "\n";
	}
	return 0;
}

// Everything that goes wrong is said in one line.
int report_error(const std::string& message)
{
	std::string line = message;
	std::replace(line.begin(), line.end(), '\n', ' ');
	clear_progress();
	std::cerr << "orthopoly: " << line << "\n";
	return EXIT_ERROR;
}

int run(int argc, char** argv)
{
	CLI::App app("Feature-preserving mesh denoising with orthogonal polynomials");
	app.set_version_flag("--version", std::string("orthopoly ") + ORTHOPOLY_VERSION);
	app.require_subcommand(1);
	const char* const mesh_file = "mesh file: .ply, .obj, .off or .stl";
	const char* const written_file =
		"mesh file: .ply, .obj, .off or .stl. Gets vertices and faces only: colours, normals, "
		"texture coordinates and materials of IN are left out";

	DenoiseArguments denoise_arguments;
	CLI::App* denoise_command = app.add_subcommand("denoise", "Take the noise off a mesh");
	denoise_command->add_option("IN", denoise_arguments.input, mesh_file)->required();
	denoise_command->add_option("OUT", denoise_arguments.output, written_file)->required();
	denoise_command->add_option(
		"--method", denoise_arguments.method, "adaptive (the default) or paper");
	denoise_command
		->add_option(
			"--set", denoise_arguments.settings, "a parameter, name=value; may be repeated")
		->take_all()
		->allow_extra_args(false);
	denoise_command->add_option("--threads", denoise_arguments.threads, "0: one per processor");
	denoise_command->add_option(
		"--reference", denoise_arguments.reference, "measure the result against this mesh");
	denoise_command->add_flag("--json", denoise_arguments.json, "print what was done as JSON");
	denoise_command->footer([]() {
		std::string text = "Parameters for --set:\n";
		for (const Parameter<DenoiseOptions>& parameter : denoise_parameters())
			text += "  " + parameter.name + "\n      " + parameter.tooltip + "\n";
		return text;
	});

	NoiseArguments noise_arguments;
	CLI::App* noise_command = app.add_subcommand("noise", "Put Gaussian noise on a mesh");
	noise_command->add_option("IN", noise_arguments.input, mesh_file)->required();
	noise_command->add_option("OUT", noise_arguments.output, written_file)->required();
	noise_command
		->add_option("--sigma", noise_arguments.sigma, "standard deviation in mean edge lengths")
		->required();
	noise_command->add_option(
		"--direction,--kind",
		noise_arguments.direction,
		"random (the default), normal or isotropic");
	noise_command->add_option(
		"--impulsive-share,--impulsive",
		noise_arguments.impulsive_share,
		"share of the vertices that are moved, 0 to 1");
	noise_command->add_option("--seed", noise_arguments.seed, "same seed, same noise");

	MeasureArguments measure_arguments;
	CLI::App* measure_command = app.add_subcommand("measure", "Say how far a mesh is from another");
	measure_command->add_option("REFERENCE", measure_arguments.reference, mesh_file)->required();
	measure_command->add_option("RESULT", measure_arguments.result, mesh_file)->required();
	measure_command->add_option(
		"--max-distance",
		measure_arguments.max_distance,
		"leave out what is farther than this from the reference, in its unit (0, the default: nothing)");
	measure_command->add_flag("--json", measure_arguments.json, "print the measures as JSON");

	InfoArguments info_arguments;
	CLI::App* info_command =
		app.add_subcommand("info", "Say what a mesh is like, and what is wrong with it");
	info_command->footer(
		"white_noise is the noise along the normals in mean edge lengths if that of neighbouring "
		"vertices has nothing in common. denoise looks closer, and tells as estimated_noise what it "
		"found.");
	info_command->add_option("IN", info_arguments.input, mesh_file)->required();
	info_command->add_flag("--json", info_arguments.json, "print it as JSON");

	try {
		app.parse(argc, argv);
	}
	catch (const CLI::Success& success) {
		return app.exit(success);
	}
	catch (const CLI::ParseError& error) {
		return report_error(std::string(error.what()) + " (try --help)");
	}
	if (*denoise_command)
		return run_denoise(denoise_arguments);
	if (*noise_command)
		return run_noise(noise_arguments);
	if (*measure_command)
		return run_measure(measure_arguments);
	return run_info(info_arguments);
}

} // namespace

} // namespace orthopoly

int main(int argc, char** argv)
{
	try {
		return orthopoly::run(argc, argv);
	}
	catch (const orthopoly::Cancelled&) {
		orthopoly::report_error("cancelled, nothing was written");
		return orthopoly::EXIT_INTERRUPTED;
	}
	catch (const std::bad_alloc&) {
		return orthopoly::report_error("there is not enough memory");
	}
	catch (const std::exception& error) {
		return orthopoly::report_error(error.what());
	}
}
