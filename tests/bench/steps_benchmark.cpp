// SPDX-License-Identifier: GPL-3.0-or-later
// Time of each step by itself, on one thread: steps_benchmark [--benchmark_filter=...]
//
// The mesh is `part` with noise of 0.3 mean edge lengths along the normals; the argument is its
// number of faces.
#include "closest_point.h"
#include "denoise.h"
#include "guide_direction.h"
#include "height_filter.h"
#include "noise.h"
#include "noise_level.h"
#include "normal_filter.h"
#include "numbering.h"
#include "patch.h"
#include "polynomial_fit.h"
#include "prefilter.h"
#include "recipes.h"
#include "similar_structures.h"
#include "vertex_update.h"
#include "workspace.h"

#include <benchmark/benchmark.h>
#include <map>
#include <memory>

namespace {

using namespace orthopoly;

// What the steps start from; made once a size.
struct Fixture {
	explicit Fixture(Index faces)
	{
		mesh = find_recipe("part").make(faces);
		clean = mesh;
		NoiseOptions noise;
		noise.sigma = 0.3;
		noise.direction = NoiseDirection::Normal;
		mesh.positions = add_noise(mesh, noise);
		workspace = std::make_unique<Workspace>(mesh, execution);
		geometry = face_geometry(mesh.positions, mesh.faces);
		guides = guide_directions(*workspace, geometry, {});
	}

	TriangleMesh clean;
	TriangleMesh mesh;
	Progress progress;
	Execution execution {1, progress};
	std::unique_ptr<Workspace> workspace;
	FaceGeometry geometry;
	std::vector<Point> guides;
};

Fixture& fixture(benchmark::State& state)
{
	static std::map<Index, std::unique_ptr<Fixture>> fixtures;
	std::unique_ptr<Fixture>& fixture = fixtures[static_cast<Index>(state.range(0))];
	if (!fixture)
		fixture = std::make_unique<Fixture>(static_cast<Index>(state.range(0)));
	return *fixture;
}

// Runs `step` on the fixture, and counts the faces it gets through in a second.
template<class Step>
void time(benchmark::State& state, Step step)
{
	Fixture& given = fixture(state);
	for (auto _ : state)
		step(given);
	state.SetItemsProcessed(state.iterations() * given.mesh.face_count());
}

void connectivity(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		const Workspace workspace(f.mesh, f.execution);
		benchmark::DoNotOptimize(workspace.vertex_faces.values.data());
	});
}

void normals(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		benchmark::DoNotOptimize(face_geometry(f.mesh.positions, f.mesh.faces).normals.data());
	});
}

void two_rings(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		RingCollector rings = f.workspace->ring_collector();
		std::size_t count = 0;
		for (Index face = 0; face < f.mesh.face_count(); ++face) {
			rings.collect(face, 2);
			count += rings.faces().size();
		}
		benchmark::DoNotOptimize(count);
	});
}

void numbering(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		benchmark::DoNotOptimize(number_by_place(f.mesh, f.execution).faces.data());
	});
}

void patches(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		Patch patch;
		for (Index number = 0; number < Patch::count(*f.workspace); ++number) {
			patch.build(*f.workspace, number, 4);
			for (Index face = 0; face < patch.own_faces(); ++face)
				patch.collect(face, 4);
		}
		benchmark::DoNotOptimize(patch.collected().begin());
	});
}

void adaptive_normal_filter(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		const NormalField field = {
			f.geometry.normals, f.geometry.normals, f.geometry.areas, f.geometry.centroids};
		benchmark::DoNotOptimize(filter_normals(*f.workspace, field, NormalFilterOptions()).data());
	});
}

void height_filter(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		HeightFilterOptions options;
		options.sigma = 0.1 * f.workspace->mean_edge_length;
		benchmark::DoNotOptimize(
			normals_from_heights(
				*f.workspace, {f.geometry.normals, f.geometry.centroids, f.mesh.positions}, options)
				.normals.data());
	});
}

void noise_level(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		benchmark::DoNotOptimize(estimate_noise_level(*f.workspace, f.mesh.positions));
	});
}

void taubin_pairs(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		std::vector<Point> positions = f.mesh.positions;
		taubin_smooth(*f.workspace, 2, positions);
		benchmark::DoNotOptimize(positions.data());
	});
}

void guides(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		benchmark::DoNotOptimize(guide_directions(*f.workspace, f.geometry, {}).data());
	});
}

void structures(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		benchmark::DoNotOptimize(
			isotropic_structures(*f.workspace, f.geometry.normals, f.guides, {}).values.data());
	});
}

void paper_normal_filter(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		benchmark::DoNotOptimize(
			filter_normals(*f.workspace, f.geometry.normals, f.guides, {}).data());
	});
}

void vertex_update(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		std::vector<Point> positions = f.mesh.positions;
		update_vertices(*f.workspace, f.geometry.normals, {}, positions);
		benchmark::DoNotOptimize(positions.data());
	});
}

void closest_points(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		const ClosestPointIndex closest(f.clean);
		double sum = 0;
		for (const Point& position : f.mesh.positions)
			sum += closest.find(position).distance;
		benchmark::DoNotOptimize(sum);
	});
}

template<Method METHOD>
void whole_method(benchmark::State& state)
{
	time(state, [](Fixture& f) {
		DenoiseOptions options;
		options.method = METHOD;
		options.threads = 1;
		Progress progress;
		benchmark::DoNotOptimize(denoise(f.mesh, options, progress).positions.data());
	});
}

} // namespace

#define STEP(function) BENCHMARK(function)->Arg(16000)->Arg(128000)->Unit(benchmark::kMillisecond)

STEP(connectivity);
STEP(normals);
STEP(two_rings);
STEP(numbering);
STEP(patches);
STEP(noise_level);
STEP(taubin_pairs);
STEP(adaptive_normal_filter);
STEP(height_filter);
STEP(guides);
STEP(structures);
STEP(paper_normal_filter);
STEP(vertex_update);
STEP(closest_points);
BENCHMARK_TEMPLATE(whole_method, Method::Adaptive)->Arg(16000)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(whole_method, Method::Paper)->Arg(16000)->Unit(benchmark::kMillisecond);

BENCHMARK_MAIN();
