// SPDX-License-Identifier: GPL-3.0-or-later
#include "paper_method.h"

#include "vertex_update.h"

namespace orthopoly {

void run_paper_method(
	const Workspace& workspace, const DenoiseOptions& options, DenoiseResult& result)
{
	VertexUpdateOptions update;
	update.iterations = options.vertex_iterations.value_or(10);
	const int iterations = options.iterations.value_or(5);
	for (int iteration = 0; iteration < iterations; ++iteration) {
		const FaceGeometry geometry = face_geometry(result.positions, workspace.mesh.faces);
		update_vertices(workspace, geometry.normals, update, result.positions);
		++result.iterations_done;
	}
	result.resolved.iterations = iterations;
	result.resolved.vertex_iterations = update.iterations;
}

} // namespace orthopoly
