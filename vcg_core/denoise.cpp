// SPDX-License-Identifier: GPL-3.0-or-later
#include "denoise.h"

#include "adaptive_method.h"
#include "errors.h"
#include "numbering.h"
#include "paper_method.h"
#include "parameters.h"
#include "seams.h"
#include "workspace.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

namespace orthopoly {

namespace {

/// A method behind the entry point: another one is another line of METHODS.
struct MethodEntry {
	Method method;
	void (*run)(
		const Workspace&, const DenoiseOptions&, DenoiseResult&, std::vector<Point>& positions);
	/// Whether the result does not depend on how the mesh is numbered, so that it may be numbered
	/// for speed.
	bool any_order;
};

// The paper's structures are read row by row, and where they are equally similar, in the order of
// their faces.
constexpr std::array<MethodEntry, 2> METHODS = {{
	{Method::Adaptive, run_adaptive_method, true},
	{Method::Paper, run_paper_method, false},
}};

const MethodEntry& entry_of(Method method)
{
	return *std::find_if(METHODS.begin(), METHODS.end(), [&](const MethodEntry& entry) {
		return entry.method == method;
	});
}

// The automatic values written as such a number become the empty optionals they stand for.
DenoiseOptions normalized(const DenoiseOptions& options)
{
	DenoiseOptions result = options;
	for (const Parameter<DenoiseOptions>& parameter : denoise_parameters())
		parameter.set(result, parameter.get(options));
	return result;
}

// A place on the surface, from which coordinates are measured: a corner of the first face that has
// an area, since vertices without a face may be anywhere.
Point place_on(const TriangleMesh& mesh)
{
	const auto face =
		std::find_if(mesh.faces.begin(), mesh.faces.end(), [&](const Face& candidate) {
			return !is_degenerate(mesh.positions, candidate);
		});
	return mesh.positions[at(face->front())];
}

Index count_degenerate_faces(const TriangleMesh& mesh, Execution& execution)
{
	return static_cast<Index>(execution.sum(mesh.face_count(), [&](Index i) {
		return is_degenerate(mesh.positions, mesh.faces[static_cast<std::size_t>(i)]) ? 1.0 : 0.0;
	}));
}

void record_displacements(const TriangleMesh& mesh, DenoiseResult& result)
{
	double sum = 0;
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		const double length = (result.positions[i] - mesh.positions[i]).norm();
		if (length > 0)
			++result.moved_vertices;
		sum += length;
		result.max_displacement = std::max(result.max_displacement, length);
	}
	result.mean_displacement = sum / static_cast<double>(mesh.positions.size());
}

} // namespace

void validate(const DenoiseOptions& given)
{
	const DenoiseOptions options = normalized(given);
	for (const Parameter<DenoiseOptions>& parameter : denoise_parameters())
		parameter.check(parameter.get(options));
	if (options.method == Method::Paper && options.structure_ring &&
		*options.structure_ring < options.guide_ring)
		throw InvalidParameter(
			"guide_ring is " + std::to_string(options.guide_ring) + ", structure_ring is " +
			std::to_string(*options.structure_ring) +
			"; the guide ring may not be the wider one: lower it or raise structure_ring");
}

DenoiseResult denoise(const TriangleMesh& mesh, const DenoiseOptions& given, Progress& progress)
{
	validate(given);
	const DenoiseOptions options = normalized(given);
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
		execution.begin_phase(0, 0.005, "reading the mesh");
		result.degenerate_faces = count_degenerate_faces(mesh, execution);
		if (result.degenerate_faces == mesh.face_count())
			throw InvalidMesh(
				"none of the " + std::to_string(mesh.face_count()) +
				" faces has an area, so there are no normals to filter; check the coordinates");
		const MethodEntry& method = entry_of(options.method);
		const Numbering numbering =
			method.any_order ? number_by_place(mesh, execution) : same_numbering(mesh);
		const Point origin = place_on(mesh);
		execution.begin_phase(0.005, 0.01, "reading the mesh");
		TriangleMesh prepared = renumbered(mesh, numbering, origin);
		// A cancel is heard between any two of these steps.
		execution.begin_phase(0.01, 0.03, "finding neighbours");
		std::optional<Workspace> built(std::in_place, prepared, execution);
		const Seams seams = find_seams(prepared, built->vertex_faces, built->edges);
		if (seams.repeated > 0) {
			prepared = sew(prepared, seams);
			built.emplace(prepared, execution);
		}
		const Workspace& workspace = *built;
		result.seam_vertices = seams.repeated;
		if (options.keep_boundary) {
			prepared.fixed.resize(prepared.positions.size(), 0);
			for (std::size_t i = 0; i < prepared.fixed.size(); ++i)
				prepared.fixed[i] |= workspace.edges.boundary[i];
		}
		execution.begin_phase(0.03, 0.05, "looking for defects");
		result.non_manifold_edges = workspace.edges.non_manifold;
		result.folded_faces_before = count_folded_faces(prepared.positions, workspace);
		std::vector<Point> positions = prepared.positions;
		method.run(workspace, options, result, positions);
		execution.begin_phase(0.99, 0.999, "looking at the result");
		result.folded_faces_after = count_folded_faces(positions, workspace);
		execution.for_each(mesh.vertex_count(), [&](std::size_t i) {
			const std::size_t k = at(seams.sewn(static_cast<Index>(i)));
			// What did not move stays bit for bit.
			if (positions[k] != prepared.positions[k])
				result.positions[at(numbering.vertices[i])] = positions[k] + origin;
		});
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
