// SPDX-License-Identifier: GPL-3.0-or-later
#include "vertex_update.h"

#include <Eigen/Geometry>

namespace orthopoly {

namespace {

// Faces or vertices a thread takes at a time: some tens of microseconds of work.
constexpr Index GRAIN = 2048;

std::size_t at(Index index)
{
	return static_cast<std::size_t>(index);
}

void compute_centroids(
	const std::vector<Face>& faces,
	const std::vector<Point>& positions,
	Execution& execution,
	std::vector<Point>& centroids)
{
	execution.parallel_for(
		static_cast<Index>(faces.size()), GRAIN, [&](Index begin, Index end, int) {
			for (std::size_t k = at(begin); k < at(end); ++k) {
				const Face& face = faces[k];
				// From the first corner: the sum of three far-off corners would lose digits.
				const Point& a = positions[at(face[0])];
				centroids[k] =
					a + ((positions[at(face[1])] - a) + (positions[at(face[2])] - a)) / 3.0;
			}
		});
}

void compute_areas(
	const std::vector<Face>& faces,
	const std::vector<Point>& positions,
	Execution& execution,
	std::vector<double>& areas)
{
	execution.parallel_for(
		static_cast<Index>(faces.size()), GRAIN, [&](Index begin, Index end, int) {
			for (std::size_t k = at(begin); k < at(end); ++k)
				areas[k] = 0.5 * face_cross_product(positions, faces[k]).norm();
		});
}

} // namespace

void update_vertices(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const VertexUpdateOptions& options,
	std::vector<Point>& positions)
{
	const TriangleMesh& mesh = workspace.mesh;
	Execution& execution = workspace.execution;
	std::vector<Point> centroids(mesh.faces.size());
	std::vector<double> areas(options.area_weights ? mesh.faces.size() : 0);

	for (int step = 0; step < options.iterations; ++step) {
		execution.begin_part(step, options.iterations);
		compute_centroids(mesh.faces, positions, execution, centroids);
		if (options.area_weights)
			compute_areas(mesh.faces, positions, execution, areas);
		// A vertex reads centroids and its own position only, so moving in place is safe.
		execution.parallel_for(mesh.vertex_count(), GRAIN, [&](Index begin, Index end, int) {
			for (Index i = begin; i < end; ++i) {
				if (mesh.is_fixed(i))
					continue;
				Point& x = positions[at(i)];
				Point sum = Point::Zero();
				double total = 0;
				for (const Index* it = workspace.vertex_faces.begin(i);
					 it != workspace.vertex_faces.end(i);
					 ++it) {
					const Point& n = normals[at(*it)];
					if (n.isZero(0))
						continue;
					const double weight = options.area_weights ? areas[at(*it)] : 1.0;
					sum += (weight * n.dot(centroids[at(*it)] - x)) * n; // eq. 12
					total += weight;
				}
				if (total > 0)
					x += sum / total;
			}
		});
	}
}

} // namespace orthopoly
