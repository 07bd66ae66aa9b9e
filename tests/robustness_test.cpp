// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes that nobody would make on purpose, through everything: random faces over few vertices,
// points that coincide, coordinates from denormal to almost infinite. Whatever comes in, what comes
// out is finite or a refusal; nothing crashes and nothing runs for ever.
#include "closest_point.h"
#include "denoise.h"
#include "errors.h"
#include "inspection.h"
#include "measures.h"
#include "noise.h"
#include "parameters.h"
#include "shapes.h"
#include "test_support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

using namespace orthopoly;

namespace {

// The draws of the standard's generator are the same everywhere; those of its distributions are
// not.
class Random {
public:
	explicit Random(std::uint32_t seed) : engine_(seed) {}

	int below(int count) { return static_cast<int>(engine_() % static_cast<std::uint32_t>(count)); }
	bool one_in(int count) { return below(count) == 0; }
	double unit() { return static_cast<double>(engine_()) / 4294967296.0; }
	double between(double low, double high) { return low + unit() * (high - low); }

private:
	std::mt19937 engine_;
};

double random_scale(Random& random)
{
	constexpr std::array<double, 9> SCALES = {
		1e-300, 1e-150, 1e-40, 1e-6, 1, 1e6, 1e40, 1e150, 1e300};
	return random.one_in(2) ? 1 : SCALES[static_cast<std::size_t>(random.below(9))];
}

// Faces that name any vertices at all.
TriangleMesh random_faces(Random& random)
{
	TriangleMesh mesh;
	const int vertices = 1 + random.below(60);
	const int faces = 1 + random.below(120);
	for (int i = 0; i < vertices; ++i)
		mesh.positions.emplace_back(
			random.between(-1, 1), random.between(-1, 1), random.between(-1, 1));
	for (int i = 0; i < faces; ++i)
		mesh.faces.push_back(
			{random.below(vertices), random.below(vertices), random.below(vertices)});
	return mesh;
}

// A sound mesh with things done to its faces and vertices.
TriangleMesh mangled(Random& random)
{
	TriangleMesh mesh = random.one_in(2) ? make_height_field(300) : make_part(300);
	NoiseOptions options;
	options.sigma = random.between(0, 2);
	options.seed = static_cast<std::uint32_t>(random.below(1000));
	mesh.positions = add_noise(mesh, options);
	const int changes = random.below(40);
	for (int i = 0; i < changes; ++i) {
		Face& face = mesh.faces[static_cast<std::size_t>(random.below(mesh.face_count()))];
		switch (random.below(4)) {
		case 0: face[0] = random.below(mesh.vertex_count()); break;
		case 1: face[1] = face[2]; break;
		case 2: std::swap(face[0], face[1]); break;
		default: mesh.faces.push_back(face); break;
		}
	}
	return mesh;
}

void move_some(Random& random, TriangleMesh& mesh)
{
	for (Point& point : mesh.positions) {
		if (random.one_in(6))
			point = mesh.positions.front();
		if (random.one_in(15))
			point *= random_scale(random);
		if (random.one_in(15))
			point[random.below(3)] = 0;
	}
}

TriangleMesh random_mesh(Random& random)
{
	TriangleMesh mesh = random.one_in(3) ? random_faces(random) : mangled(random);
	if (random.one_in(3))
		move_some(random, mesh);
	if (random.one_in(3)) {
		const double scale = random_scale(random);
		for (Point& point : mesh.positions)
			point *= scale;
	}
	if (random.one_in(4)) {
		const Point offset = Point::Constant(random.between(-1, 1)) * random_scale(random);
		for (Point& point : mesh.positions)
			point += offset;
	}
	if (random.one_in(3)) {
		for (Index i = 0; i < mesh.vertex_count(); ++i)
			mesh.fixed.push_back(random.one_in(3) ? 1 : 0);
	}
	return mesh;
}

DenoiseOptions random_options(Random& random)
{
	DenoiseOptions options;
	for (const Parameter<DenoiseOptions>& parameter : denoise_parameters()) {
		// Most of the time the default; small rings and few rounds, for the sake of time.
		if (!random.one_in(3))
			continue;
		double value = random.between(parameter.minimum, std::min(parameter.maximum, 6.0));
		if (parameter.type != ParameterType::Real)
			value = std::round(value);
		parameter.set(options, value);
	}
	options.threads = 1 + random.below(3);
	if (options.structure_ring && *options.structure_ring < options.guide_ring)
		options.structure_ring = options.guide_ring;
	return options;
}

bool refused(const std::function<void()>& work)
{
	try {
		work();
	}
	catch (const Error& error) {
		CHECK_FALSE(std::string(error.what()).empty());
		return true;
	}
	return false;
}

void check_denoise(const TriangleMesh& mesh, const DenoiseOptions& options)
{
	DenoiseResult result;
	if (refused([&]() {
			Progress progress;
			result = denoise(mesh, options, progress);
		}))
		return;
	REQUIRE(result.positions.size() == mesh.positions.size());
	REQUIRE(all_finite(result.positions));
	CHECK(std::isfinite(result.estimated_noise));
	for (Index i = 0; i < mesh.vertex_count(); ++i) {
		const auto at = static_cast<std::size_t>(i);
		if (mesh.is_fixed(i))
			REQUIRE(same_bits({result.positions[at]}, {mesh.positions[at]}));
	}
}

void check_rest(const TriangleMesh& mesh)
{
	inspect(mesh);
	refused([&]() {
		const ErrorMeasures measures = measure(mesh, mesh);
		CHECK(measures.folded_faces == 0);
		CHECK(std::isfinite(measures.mean_angle));
		CHECK(std::isfinite(measures.vertex_error));
	});
	refused([&]() {
		const std::vector<Point> noisy = add_noise(mesh, NoiseOptions());
		CHECK(all_finite(noisy));
	});
}

void run_seeds(std::uint32_t first, std::uint32_t last)
{
	for (std::uint32_t seed = first; seed < last; ++seed) {
		CAPTURE(seed);
		Random random(seed);
		const TriangleMesh mesh = random_mesh(random);
		const DenoiseOptions options = random_options(random);
		std::string text;
		for (const Parameter<DenoiseOptions>& parameter : denoise_parameters())
			text += parameter.name + "=" + parameter.format(parameter.get(options)) + " ";
		CAPTURE(text);
		check_denoise(mesh, options);
		check_rest(mesh);
	}
}

} // namespace

TEST_CASE("random meshes come out finite or are refused", "[robustness]")
{
	run_seeds(0, 150);
}

TEST_CASE("many random meshes come out finite or are refused", "[robustness][slow]")
{
	run_seeds(1000, 6000);
}

TEST_CASE("coordinates at the ends of what a number holds", "[robustness]")
{
	const auto method = GENERATE(Method::Adaptive, Method::Paper);
	const double scale = GENERATE(5e-324, 1e-310, 1e-200, 1e-100, 1e100, 1e200, 1.5e308);
	DenoiseOptions options;
	options.method = method;
	TriangleMesh mesh = make_part(300);
	mesh.positions = add_noise(mesh, NoiseOptions());
	check_denoise(placed(mesh, scale), options);
	check_rest(placed(mesh, scale));
	// One vertex out of all proportion.
	mesh.positions[17] *= scale;
	check_denoise(mesh, options);
	check_rest(mesh);
}
