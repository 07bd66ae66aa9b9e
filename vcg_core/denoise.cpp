// SPDX-License-Identifier: GPL-3.0-or-later
#include "denoise.h"

#include "adaptive_method.h"
#include "errors.h"
#include "paper_method.h"
#include "parameters.h"
#include "workspace.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace orthopoly {

namespace {

/// A method behind the entry point: another one is another line of METHODS.
struct MethodEntry {
	Method method;
	void (*run)(const Workspace&, const DenoiseOptions&, DenoiseResult&);
};

constexpr std::array<MethodEntry, 2> METHODS = {{
	{Method::Adaptive, run_adaptive_method},
	{Method::Paper, run_paper_method},
}};

Index count_degenerate_faces(const TriangleMesh& mesh)
{
	return static_cast<Index>(
		std::count_if(mesh.faces.begin(), mesh.faces.end(), [&](const Face& face) {
			return is_degenerate(mesh.positions, face);
		}));
}

void record_displacements(const TriangleMesh& mesh, DenoiseResult& result)
{
	double sum = 0;
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		const double squared = (result.positions[i] - mesh.positions[i]).squaredNorm();
		if (squared > 0)
			++result.moved_vertices;
		sum += squared;
		result.max_displacement = std::max(result.max_displacement, std::sqrt(squared));
	}
	result.mean_displacement = std::sqrt(sum / static_cast<double>(mesh.positions.size()));
}

} // namespace

void validate(const DenoiseOptions& options)
{
	for (const Parameter<DenoiseOptions>& parameter : denoise_parameters())
		parameter.check(parameter.get(options));
	if (options.method == Method::Paper && options.structure_ring &&
		*options.structure_ring < options.guide_ring)
		throw InvalidParameter(
			"guide_ring is " + std::to_string(options.guide_ring) + ", structure_ring is " +
			std::to_string(*options.structure_ring) +
			"; the guide ring may not be the wider one: lower it or raise structure_ring");
}

DenoiseResult denoise(const TriangleMesh& mesh, const DenoiseOptions& options, Progress& progress)
{
	validate(options);
	validate(mesh);
	if (mesh.faces.empty())
		throw InvalidMesh(
			"the mesh has " + std::to_string(mesh.vertex_count()) +
			" vertices and no faces; denoising needs a triangle mesh: reconstruct a surface first");

	DenoiseResult result;
	result.positions = mesh.positions;
	result.resolved = options;
	try {
		Execution execution(options.threads, progress);
		result.resolved.threads = execution.threads();
		execution.begin_phase(0, 0.01, "reading the mesh");
		TriangleMesh prepared = mesh;
		if (options.keep_boundary) {
			prepared.fixed.resize(mesh.positions.size(), 0);
			const std::vector<std::uint8_t> boundary =
				boundary_vertices(mesh.vertex_count(), mesh.faces);
			for (std::size_t i = 0; i < boundary.size(); ++i)
				prepared.fixed[i] = prepared.fixed[i] | boundary[i];
		}
		result.degenerate_faces = count_degenerate_faces(mesh);
		if (result.degenerate_faces == mesh.face_count())
			throw InvalidMesh(
				"none of the " + std::to_string(mesh.face_count()) +
				" faces has an area, so there are no normals to filter; check the coordinates");
		// A cancel is heard between any two of these steps, which are long on a large mesh.
		execution.begin_phase(0.01, 0.03, "finding neighbours");
		const Workspace workspace(prepared, execution);
		execution.begin_phase(0.03, 0.05, "looking for defects");
		result.non_manifold_edges = count_non_manifold_edges(mesh.faces);
		result.folded_faces_before = count_folded_faces(mesh.positions, workspace);
		for (const MethodEntry& entry : METHODS) {
			if (entry.method == options.method)
				entry.run(workspace, options, result);
		}
		result.folded_faces_after = count_folded_faces(result.positions, workspace);
		record_displacements(mesh, result);
		progress.report(1, "done");
	}
	catch (const Cancelled&) {
		result.status = DenoiseResult::Status::Cancelled;
		result.positions = mesh.positions;
	}
	return result;
}

} // namespace orthopoly
