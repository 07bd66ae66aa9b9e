// SPDX-License-Identifier: GPL-3.0-or-later
#include "denoise.h"

#include "adjacency.h"
#include "defects.h"
#include "errors.h"
#include "measures.h"
#include "method_support.h"
#include "noise.h"
#include "parameters.h"
#include "recipes.h"
#include "shapes.h"
#include "test_support.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <map>
#include <string>
#include <thread>
#include <vector>

using namespace orthopoly;
using Catch::Contains;
using Status = DenoiseResult::Status;

namespace {

TriangleMesh
with_noise(TriangleMesh mesh, double sigma, NoiseDirection direction = NoiseDirection::Normal)
{
	NoiseOptions options;
	options.sigma = sigma;
	options.direction = direction;
	mesh.positions = add_noise(mesh, options);
	return mesh;
}

DenoiseOptions options_of(Method method)
{
	DenoiseOptions options;
	options.method = method;
	options.threads = 1;
	return options;
}

double
mean_angle(const TriangleMesh& mesh, const std::vector<Point>& positions, const TriangleMesh& truth)
{
	TriangleMesh measured = mesh;
	measured.positions = positions;
	return measure(measured, truth).mean_angle;
}

// A value of a parameter that differs from its default enough to show in the result, and what has
// to be so for it to matter.
struct Setting {
	const char* value;
	Method method;
	// Other parameters, as name and value.
	std::map<std::string, std::string> others = {};
};

// Every parameter has an entry here; one that is added to the table without is found out below.
const std::map<std::string, std::vector<Setting>>& settings()
{
	static const std::map<std::string, std::vector<Setting>> table = {
		{"method", {{"paper", Method::Adaptive}, {"adaptive", Method::Paper}}},
		{"strength", {{"gentle", Method::Adaptive}, {"strong", Method::Adaptive}}},
		{"noise_type", {{"scanner", Method::Adaptive}}},
		{"noise_level", {{"0.05", Method::Adaptive}, {"0.5", Method::Adaptive}}},
		{"iterations", {{"1", Method::Paper}, {"7", Method::Paper}, {"5", Method::Adaptive}}},
		{"keep_boundary", {{"true", Method::Paper}, {"true", Method::Adaptive}}},
		{"vertex_iterations", {{"2", Method::Paper}, {"3", Method::Adaptive}}},
		{"structure_ring", {{"4", Method::Paper}, {"1", Method::Adaptive}}},
		{"cos_threshold", {{"0.9", Method::Paper}, {"0.95", Method::Adaptive}}},
		{"cos_threshold_increment",
		 {{"0.08", Method::Paper}, {"0.2", Method::Adaptive, {{"iterations", "3"}}}}},
		{"guide_ring", {{"2", Method::Paper, {{"structure_ring", "3"}}}}},
		{"sigma_theta", {{"10", Method::Paper}}},
		{"order_x", {{"1", Method::Paper}}},
		{"order_y", {{"1", Method::Paper}}},
		{"threads", {{"2", Method::Paper}, {"2", Method::Adaptive}}},
	};
	return table;
}

void apply(const std::map<std::string, std::string>& values, DenoiseOptions& options)
{
	for (const auto& [name, value] : values)
		set_parameter(denoise_parameters(), name, value, options);
}

void check_result(const TriangleMesh& mesh, const DenoiseResult& result)
{
	REQUIRE(result.positions.size() == mesh.positions.size());
	CHECK(all_finite(result.positions));
	CHECK(std::isfinite(result.mean_displacement));
	CHECK(std::isfinite(result.estimated_noise));
	for (std::size_t i = 0; i < mesh.fixed.size(); ++i) {
		if (mesh.fixed[i] != 0)
			REQUIRE(same_bits({result.positions[i]}, {mesh.positions[i]}));
	}
	// Nothing flies off: no vertex moves farther than a few of the longest noise amplitudes.
	const double edge = mean_edge_length(mesh.positions, mesh.faces);
	CHECK(result.max_displacement < 3 * edge);
}

// Small noisy meshes of every class, sound and defective.
std::vector<std::pair<std::string, TriangleMesh>> mesh_classes()
{
	std::vector<std::pair<std::string, TriangleMesh>> meshes;
	for (const Recipe& recipe : recipes()) {
		if (recipe.can_be_denoised)
			meshes.emplace_back(
				recipe.name, with_noise(recipe.make(600), 0.2, NoiseDirection::Random));
	}
	return meshes;
}

} // namespace

TEST_CASE("noise on every kind of surface is reduced", "[denoise][slow]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const std::string name = GENERATE("cube", "sphere", "torus", "part", "height_field");
	const double sigma = GENERATE(0.1, 0.25);
	const TriangleMesh truth = find_recipe(name).make(6000);
	const TriangleMesh noisy = with_noise(truth, sigma);
	const DenoiseResult result = denoised(noisy, options_of(method));
	CAPTURE(name, sigma, static_cast<int>(method));
	CHECK(result.status == Status::Done);
	const double before = mean_angle(noisy, noisy.positions, truth);
	const double after = mean_angle(noisy, result.positions, truth);
	// The paper's default threshold is for strong noise: little is asked of it on mild noise.
	const bool is_adaptive = method == Method::Adaptive;
	CHECK(after < (is_adaptive ? 0.5 : sigma < 0.2 ? 0.95 : 0.65) * before);
	TriangleMesh denoised = noisy;
	denoised.positions = result.positions;
	// It also wears away the curb of the height field, which is no wider than a triangle.
	if (is_adaptive || (sigma > 0.2 && name != "height_field"))
		CHECK(measure(denoised, truth).vertex_error < 0.9 * measure(noisy, truth).vertex_error);
}

TEST_CASE("the result says what was done", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh noisy = with_noise(make_torus(2000), 0.2);
	const DenoiseResult result = denoised(noisy, options_of(method));
	CHECK(result.status == Status::Done);
	CHECK(result.resolved.method == method);
	CHECK(result.iterations_done == result.resolved.iterations);
	CHECK(result.moved_vertices > noisy.vertex_count() * 9 / 10);
	CHECK(result.max_displacement == Approx(largest_distance(result.positions, noisy.positions)));
	CHECK(result.mean_displacement > 0);
	CHECK(result.mean_displacement < result.max_displacement);
	CHECK(result.degenerate_faces == 0);
	CHECK(result.non_manifold_edges == 0);
	CHECK(result.folded_faces_after <= result.folded_faces_before);
	if (method == Method::Adaptive)
		CHECK(result.estimated_noise == Approx(0.2).epsilon(0.25));
}

TEST_CASE("the resolved options give the same result again", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	// The first iteration of the adaptive method counts for nothing, for a part, and in full.
	const auto sigma = GENERATE(0.1, 0.15, 0.2);
	const TriangleMesh noisy = with_noise(make_part(1500), sigma);
	const DenoiseResult first = denoised(noisy, options_of(method));
	const DenoiseResult second = denoised(noisy, first.resolved);
	CHECK(same_bits(first.positions, second.positions));
	CHECK(second.resolved.iterations == first.resolved.iterations);
	CHECK(second.resolved.noise_level == first.resolved.noise_level);
	CHECK(second.resolved.cos_threshold == first.resolved.cos_threshold);
}

TEST_CASE("the widest guides resolve to a structure ring that is accepted", "[denoise]")
{
	DenoiseOptions options = options_of(Method::Paper);
	options.guide_ring = 10;
	options.iterations = 1;
	const DenoiseResult result = denoised(with_noise(make_part(600), 0.2), options);
	CHECK(result.resolved.structure_ring == 10);
	CHECK_NOTHROW(validate(result.resolved));
}

TEST_CASE("every class of mesh gets through every method", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	for (auto& [name, mesh] : mesh_classes()) {
		CAPTURE(name, static_cast<int>(method));
		const TriangleMesh before = mesh;
		const DenoiseResult result = denoised(mesh, options_of(method));
		check_result(mesh, result);
		CHECK(result.moved_vertices > 0);
		// The input is as it was.
		CHECK(same_bits(mesh.positions, before.positions));
		CHECK(mesh.faces == before.faces);
	}
}

TEST_CASE("every class of mesh gets through every option", "[denoise][slow]")
{
	for (auto& [mesh_name, mesh] : mesh_classes()) {
		mesh.fixed.assign(mesh.positions.size(), 0);
		for (std::size_t i = 0; i < mesh.fixed.size(); i += 4)
			mesh.fixed[i] = 1;
		for (const auto& [name, values] : settings()) {
			for (const Setting& setting : values) {
				CAPTURE(mesh_name, name, setting.value, static_cast<int>(setting.method));
				DenoiseOptions options = options_of(setting.method);
				apply(setting.others, options);
				set_parameter(denoise_parameters(), name, setting.value, options);
				check_result(mesh, denoised(mesh, options));
			}
		}
		// Both ends of every range, as far as they may be combined with the rest.
		for (const Parameter<DenoiseOptions>& parameter : denoise_parameters()) {
			if (parameter.type != ParameterType::Integer && parameter.type != ParameterType::Real)
				continue;
			for (const auto method : {Method::Adaptive, Method::Paper}) {
				for (const double value : {parameter.minimum, parameter.maximum}) {
					CAPTURE(mesh_name, parameter.name, value, static_cast<int>(method));
					DenoiseOptions options = options_of(method);
					options.iterations = 1;
					options.vertex_iterations = 2;
					parameter.set(options, std::min(value, 60.0));
					check_result(mesh, denoised(mesh, options));
				}
			}
		}
	}
}

TEST_CASE("every parameter changes the result, the number of threads does not", "[denoise]")
{
	// Boundary, flat and curved parts and a step: something for every parameter to act upon.
	const TriangleMesh mesh = with_noise(make_height_field(1000), 0.2, NoiseDirection::Random);
	std::map<Method, std::vector<Point>> defaults;
	for (const auto method : {Method::Adaptive, Method::Paper})
		defaults[method] = denoised(mesh, options_of(method)).positions;
	for (const Parameter<DenoiseOptions>& parameter : denoise_parameters()) {
		CAPTURE(parameter.name);
		REQUIRE(settings().count(parameter.name) == 1);
		for (const Setting& setting : settings().at(parameter.name)) {
			CAPTURE(setting.value);
			DenoiseOptions options = options_of(setting.method);
			apply(setting.others, options);
			const std::vector<Point> without = setting.others.empty() ?
												   defaults.at(setting.method) :
												   denoised(mesh, options).positions;
			set_parameter(denoise_parameters(), parameter.name, setting.value, options);
			const std::vector<Point> with = denoised(mesh, options).positions;
			CHECK(same_bits(with, without) == (parameter.name == "threads"));
		}
	}
	CHECK(settings().size() == denoise_parameters().size());
}

TEST_CASE("more strength takes away more", "[denoise]")
{
	const TriangleMesh noisy = with_noise(make_sphere(4000), 0.2);
	DenoiseOptions options = options_of(Method::Adaptive);
	std::vector<double> displacements;
	for (const Strength strength : {Strength::Gentle, Strength::Normal, Strength::Strong}) {
		options.strength = strength;
		displacements.push_back(denoised(noisy, options).mean_displacement);
	}
	CHECK(displacements[0] < displacements[1]);
	CHECK(displacements[1] < displacements[2]);
}

TEST_CASE("fixed vertices stay bit for bit", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	TriangleMesh mesh = with_noise(make_part(2000), 0.25, NoiseDirection::Random);
	mesh.fixed.assign(mesh.positions.size(), 0);
	SECTION("some")
	{
		for (std::size_t i = 0; i < mesh.fixed.size() / 2; ++i)
			mesh.fixed[i] = 1;
		const DenoiseResult result = denoised(mesh, options_of(method));
		check_result(mesh, result);
		CHECK(result.moved_vertices > 0);
		CHECK(result.moved_vertices <= mesh.vertex_count() - mesh.vertex_count() / 2);
	}
	SECTION("all")
	{
		mesh.fixed.assign(mesh.positions.size(), 1);
		const DenoiseResult result = denoised(mesh, options_of(method));
		CHECK(same_bits(result.positions, mesh.positions));
		CHECK(result.moved_vertices == 0);
	}
}

TEST_CASE("a kept boundary stays bit for bit, the rest moves", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh mesh = with_noise(make_height_field(2000), 0.2, NoiseDirection::Random);
	const std::vector<std::uint8_t> boundary = edge_defects(mesh).boundary;
	DenoiseOptions options = options_of(method);
	options.keep_boundary = true;
	const DenoiseResult kept = denoised(mesh, options);
	options.keep_boundary = false;
	const DenoiseResult free = denoised(mesh, options);
	Index moved = 0;
	for (std::size_t i = 0; i < boundary.size(); ++i) {
		if (boundary[i] != 0) {
			REQUIRE(same_bits({kept.positions[i]}, {mesh.positions[i]}));
			moved += free.positions[i] != mesh.positions[i] ? 1 : 0;
		}
	}
	CHECK(moved > 0);
	CHECK(kept.moved_vertices > mesh.vertex_count() / 2);

	// Vertices that were fixed before stay so beside the boundary.
	TriangleMesh fixed = mesh;
	fixed.fixed.assign(mesh.positions.size(), 0);
	const std::size_t inner =
		static_cast<std::size_t>(std::find(boundary.begin(), boundary.end(), 0) - boundary.begin());
	fixed.fixed[inner] = 1;
	options.keep_boundary = true;
	const DenoiseResult both = denoised(fixed, options);
	CHECK(same_bits({both.positions[inner]}, {mesh.positions[inner]}));
	CHECK(both.moved_vertices == kept.moved_vertices - 1);
}

TEST_CASE("the result is the same bit for bit on any number of threads", "[denoise][parallel]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh mesh = with_noise(make_part(3000), 0.25, NoiseDirection::Random);
	DenoiseOptions options = options_of(method);
	const DenoiseResult one = denoised(mesh, options);
	for (const int threads : {2, 3, 8}) {
		options.threads = threads;
		const DenoiseResult many = denoised(mesh, options);
		CHECK(same_bits(many.positions, one.positions));
		CHECK(many.estimated_noise == one.estimated_noise);
		CHECK(many.resolved.threads == threads);
	}
	// And the same when run again.
	CHECK(same_bits(denoised(mesh, options).positions, one.positions));
}

TEST_CASE("the size of the mesh does not matter", "[denoise][slow]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh truth = make_part(3000);
	const TriangleMesh mesh = with_noise(truth, 0.2);
	const DenoiseResult here = denoised(mesh, options_of(method));

	SECTION("powers of two change no other bit")
	{
		const double scale = GENERATE(0x1p-40, 0x1p-20, 0x1p20, 0x1p40);
		const DenoiseResult there = denoised(placed(mesh, scale), options_of(method));
		TriangleMesh expected = mesh;
		expected.positions = here.positions;
		CHECK(same_bits(there.positions, placed(expected, scale).positions));
		CHECK(there.estimated_noise == here.estimated_noise);
	}
	SECTION("any size, anywhere")
	{
		const double scale = GENERATE(1e-6, 1.0, 1e6);
		// At a million times the size, coordinates are good to 1e-10 of it.
		const Point offset = GENERATE(Point(0, 0, 0), Point(1, -2, 3)) * (1e6 * scale);
		const TriangleMesh moved = placed(mesh, scale, offset);
		const DenoiseResult there = denoised(moved, options_of(method));
		check_result(moved, there);
		const double expected = mean_angle(mesh, here.positions, truth);
		CHECK(
			mean_angle(moved, there.positions, placed(truth, scale, offset)) ==
			Approx(expected).epsilon(0.05));
	}
}

TEST_CASE("vertices without a face, however many and far, change nothing", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh mesh = with_noise(make_part(3000), 0.2);
	// They come first, where a mesh that is measured from its first vertex would be lost.
	TriangleMesh littered = mesh;
	const Index strays = 2 * mesh.vertex_count();
	littered.positions.assign(static_cast<std::size_t>(strays), Point(1e16, -1e16, 3));
	littered.positions.insert(
		littered.positions.end(), mesh.positions.begin(), mesh.positions.end());
	for (Face& face : littered.faces) {
		for (Index& corner : face)
			corner += strays;
	}
	const DenoiseResult expected = denoised(mesh, options_of(method));
	const DenoiseResult result = denoised(littered, options_of(method));
	CHECK(result.estimated_noise == expected.estimated_noise);
	CHECK(
		same_bits({result.positions.begin() + strays, result.positions.end()}, expected.positions));
	for (Index i = 0; i < strays; ++i)
		REQUIRE(same_bits({result.positions[at(i)]}, {littered.positions[at(i)]}));
}

TEST_CASE("a number that stands for automatic is as good as none", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh mesh = with_noise(make_part(2000), 0.2);
	DenoiseOptions options = options_of(method);
	const DenoiseResult expected = denoised(mesh, options);
	options.noise_level = AUTOMATIC;
	options.iterations = -1;
	options.vertex_iterations = -1;
	options.structure_ring = -1;
	options.cos_threshold = AUTOMATIC;
	options.cos_threshold_increment = AUTOMATIC;
	const DenoiseResult result = denoised(mesh, options);
	CHECK(same_bits(result.positions, expected.positions));
	CHECK(result.iterations_done == expected.iterations_done);
	CHECK(result.status == Status::Done);
}

TEST_CASE("a turned mesh is denoised as well", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh truth = make_part(3000);
	const TriangleMesh mesh = with_noise(truth, 0.2);
	const auto turned = [](TriangleMesh turning) {
		for (Point& point : turning.positions)
			point = Point(
				0.36 * point.x() + 0.48 * point.y() - 0.8 * point.z(),
				-0.8 * point.x() + 0.6 * point.y(),
				0.48 * point.x() + 0.64 * point.y() + 0.6 * point.z());
		return turning;
	};
	const double expected = mean_angle(mesh, denoised(mesh, options_of(method)).positions, truth);
	const TriangleMesh turned_mesh = turned(mesh);
	CHECK(
		mean_angle(
			turned_mesh, denoised(turned_mesh, options_of(method)).positions, turned(truth)) ==
		Approx(expected).epsilon(0.05));
}

TEST_CASE("clean meshes are left as they are, or very nearly", "[denoise]")
{
	const std::string name = GENERATE("cube", "sphere", "torus", "part");
	const TriangleMesh mesh = find_recipe(name).make(8000);
	const DenoiseResult result = denoised(mesh, options_of(Method::Adaptive));
	CAPTURE(name);
	CHECK(result.max_displacement < 0.05 * mean_edge_length(mesh.positions, mesh.faces));
	if (result.status == Status::NothingToDo) {
		CHECK(same_bits(result.positions, mesh.positions));
		CHECK(result.moved_vertices == 0);
	}
}

TEST_CASE("thin plates keep their two sides apart", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh truth = find_recipe("thin_plate").make_default();
	const TriangleMesh mesh = with_noise(truth, 0.1);
	const DenoiseResult result = denoised(mesh, options_of(method));
	const double thickness = mean_edge_length(truth.positions, truth.faces);
	// Away from the rim, where the rounding of the edges is no part of the question.
	double worst = 0;
	for (std::size_t i = 0; i < truth.positions.size(); ++i) {
		const Point& point = truth.positions[i];
		if (std::abs(point.x()) < 0.4 && std::abs(point.y()) < 0.4)
			worst = std::max(worst, std::abs(result.positions[i].z() - point.z()));
	}
	CHECK(worst < 0.4 * thickness);
}

TEST_CASE("progress counts up with words, from the calling thread", "[denoise][parallel]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh mesh = with_noise(make_part(3000), 0.2);
	const std::thread::id caller = std::this_thread::get_id();
	std::vector<int> percents;
	std::vector<std::string> words;
	bool other_thread = false;
	Progress progress([&](int percent, const std::string& text) {
		other_thread |= std::this_thread::get_id() != caller;
		percents.push_back(percent);
		words.push_back(text);
		return true;
	});
	DenoiseOptions options = options_of(method);
	options.threads = 3;
	const DenoiseResult result = denoise(mesh, options, progress);
	CHECK_FALSE(other_thread);
	REQUIRE_FALSE(percents.empty());
	CHECK(std::is_sorted(percents.begin(), percents.end()));
	CHECK(percents.front() <= 5);
	CHECK(percents.back() == 100);
	CHECK(std::none_of(
		words.begin(), words.end(), [](const std::string& text) { return text.empty(); }));
	for (int i = 1; i <= result.iterations_done; ++i) {
		const std::string expected = "iteration " + std::to_string(i);
		CHECK(std::any_of(words.begin(), words.end(), [&](const std::string& text) {
			return text.find(expected) != std::string::npos;
		}));
	}
}

TEST_CASE("a cancel leaves the positions as they were, whenever it comes", "[denoise][parallel]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const int threads = GENERATE(1, 3);
	const TriangleMesh mesh = with_noise(make_part(1500), 0.2);
	DenoiseOptions options = options_of(method);
	options.threads = threads;
	const std::vector<Point> finished = denoised(mesh, options).positions;
	int reports = 0;
	Progress counting([&](int, const std::string&) {
		++reports;
		return true;
	});
	denoise(mesh, options, counting);
	REQUIRE(reports > 3);

	// A dozen of them, however many reports a slow machine makes.
	for (int last = 1; last <= reports; last += std::max(1, reports / 12)) {
		int calls = 0;
		int percent_at_cancel = 0;
		Progress progress([&](int percent, const std::string&) {
			percent_at_cancel = percent;
			return ++calls < last;
		});
		const DenoiseResult result = denoise(mesh, options, progress);
		CAPTURE(last, percent_at_cancel);
		// How often it reports depends on the time it takes, so a later cancel may not happen at
		// all; one that comes with the last report comes too late.
		if (calls < last || percent_at_cancel == 100) {
			CHECK(result.status == Status::Done);
			CHECK(same_bits(result.positions, finished));
			continue;
		}
		CHECK(calls == last);
		CHECK(result.status == Status::Cancelled);
		CHECK(same_bits(result.positions, mesh.positions));
		CHECK(result.moved_vertices == 0);
	}
}

// A cancel waits for the next report, so no two reports may be far apart. On one thread the time
// the program takes is that of the work, however busy the machine.
TEST_CASE("a cancel is obeyed at once on a large mesh", "[denoise][slow]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const TriangleMesh mesh = with_noise(make_part(150000), 0.2);
	DenoiseOptions options = options_of(method);
	options.iterations = 1;
	double longest = 0;
	std::string where;
	std::string words_before = "the beginning";
	std::clock_t last = std::clock();
	const auto take_gap = [&](const std::string& words) {
		const double gap = static_cast<double>(std::clock() - last) / CLOCKS_PER_SEC;
		if (gap > longest) {
			longest = gap;
			where = "from " + words_before + " to " + words;
		}
		words_before = words;
		last = std::clock();
	};

	SECTION("in time")
	{
		Progress progress([&](int, const std::string& words) {
			take_gap(words);
			return true;
		});
		denoise(mesh, options, progress);
		CAPTURE(where);
		CHECK(longest < 0.2);
	}
	SECTION("and leaves no trace")
	{
		// A quick machine is done after a dozen reports.
		const int cancelled_after = GENERATE(0, 1, 4, 8);
		int calls = 0;
		Progress progress([&](int, const std::string&) {
			last = std::clock();
			return ++calls <= cancelled_after;
		});
		const DenoiseResult result = denoise(mesh, options, progress);
		take_gap("the end");
		CHECK(result.status == Status::Cancelled);
		CHECK(same_bits(result.positions, mesh.positions));
		CHECK(longest < 0.2);
	}
}

TEST_CASE("meshes that cannot be denoised are refused with reason and cure", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const DenoiseOptions options = options_of(method);
	CHECK_THROWS_AS(denoised(make_empty(), options), InvalidMesh);
	CHECK_THROWS_WITH(denoised(make_empty(), options), Contains("0 vertices and no faces"));
	CHECK_THROWS_WITH(
		denoised(make_points_only(), options),
		Contains("218 vertices and no faces") && Contains("reconstruct"));
	CHECK_THROWS_WITH(
		denoised(make_nan_coordinate(), options), Contains("vertex 7") && Contains("repair"));
	TriangleMesh mesh = unit_square();
	mesh.faces[1][2] = 17;
	CHECK_THROWS_AS(denoised(mesh, options), InvalidMesh);
	CHECK_THROWS_WITH(denoised(mesh, options), Contains("face 1") && Contains("index 17"));
	mesh = unit_square();
	mesh.positions.assign(4, Point(3, 3, 3));
	CHECK_THROWS_WITH(denoised(mesh, options), Contains("none of the 2 faces"));
	mesh = unit_square();
	mesh.fixed = {1, 0};
	CHECK_THROWS_WITH(denoised(mesh, options), Contains("2 fixed flags for 4"));
}

TEST_CASE("options out of their range are refused before any work", "[denoise]")
{
	const TriangleMesh mesh = make_cube(100);
	int calls = 0;
	Progress progress([&](int, const std::string&) {
		++calls;
		return true;
	});
	for (const Parameter<DenoiseOptions>& parameter : denoise_parameters()) {
		if (parameter.type != ParameterType::Integer && parameter.type != ParameterType::Real)
			continue;
		CAPTURE(parameter.name);
		DenoiseOptions options;
		parameter.set(options, parameter.maximum + 1);
		CHECK_THROWS_AS(denoise(mesh, options, progress), InvalidParameter);
		CHECK_THROWS_WITH(denoise(mesh, options, progress), Contains(parameter.name));
	}
	DenoiseOptions options;
	options.noise_level = std::numeric_limits<double>::quiet_NaN();
	CHECK_THROWS_WITH(denoise(mesh, options, progress), Contains("noise_level is nan"));
	CHECK(calls == 0);
}

TEST_CASE("the least of meshes are no trouble", "[denoise]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	TriangleMesh triangle;
	triangle.positions = {Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0)};
	triangle.faces = {{0, 1, 2}};
	for (const TriangleMesh& mesh : {triangle, unit_square(), tetrahedron(), make_cube(12)}) {
		const DenoiseResult result = denoised(mesh, options_of(method));
		check_result(mesh, result);
		// Flat stays flat.
		if (mesh.face_count() <= 2) {
			for (const Point& point : result.positions)
				CHECK(point.z() == Approx(0).margin(1e-12));
		}
	}
}
