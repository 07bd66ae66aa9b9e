// SPDX-License-Identifier: GPL-3.0-or-later
#include "vertex_update.h"

#include <Eigen/Geometry>

namespace orthopoly {

namespace {

// Faces or vertices a thread takes at a time: some tens of microseconds of work.
constexpr Index GRAIN = 2048;

// Share of the way to the mean of the centroids around it that a vertex at a fold takes: half of
// the way to the mean of its neighbours, which is half as far again.
constexpr double UNFOLDING_STEP = 0.75;

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

/// What a step reads of the faces beside their centroids.
struct FaceState {
	std::vector<double> areas;
	/// Faces turned away from their targets.
	std::vector<std::uint8_t> folded;
};

void compute_state(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const std::vector<Point>& positions,
	double unfold_cosine,
	FaceState& state)
{
	const TriangleMesh& mesh = workspace.mesh;
	state.areas.resize(mesh.faces.size());
	state.folded.resize(mesh.faces.size());
	workspace.execution.parallel_for(mesh.face_count(), GRAIN, [&](Index begin, Index end, int) {
		for (std::size_t k = at(begin); k < at(end); ++k) {
			const Point cross = face_cross_product(positions, mesh.faces[k]);
			const double length = cross.norm();
			state.areas[k] = 0.5 * length;
			state.folded[k] = cross.dot(normals[k]) < unfold_cosine * length;
		}
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
	const bool unfold = options.unfold_cosine > -1;
	FaceState state;

	for (int step = 0; step < options.iterations; ++step) {
		execution.begin_part(step, options.iterations);
		compute_centroids(mesh.faces, positions, execution, centroids);
		if (options.area_weights || unfold)
			compute_state(workspace, normals, positions, options.unfold_cosine, state);
		// A vertex reads centroids and its own position only, so moving in place is safe.
		execution.parallel_for(mesh.vertex_count(), GRAIN, [&](Index begin, Index end, int) {
			for (Index i = begin; i < end; ++i) {
				if (mesh.is_fixed(i))
					continue;
				Point& x = positions[at(i)];
				Point sum = Point::Zero();
				Point normal = Point::Zero();
				Point across = Point::Zero();
				double total = 0;
				bool folded = false;
				for (const Index* it = workspace.vertex_faces.begin(i);
					 it != workspace.vertex_faces.end(i);
					 ++it) {
					const Point& n = normals[at(*it)];
					if (n.isZero(0))
						continue;
					const double weight = options.area_weights ? state.areas[at(*it)] : 1.0;
					const Point offset = centroids[at(*it)] - x;
					sum += (weight * n.dot(offset)) * n; // eq. 12
					total += weight;
					if (unfold) {
						normal += weight * n;
						across += offset;
						folded = folded || state.folded[at(*it)] != 0;
					}
				}
				if (total > 0)
					x += sum / total;
				if (folded && !normal.isZero(0) && workspace.edges.boundary[at(i)] == 0) {
					across /= static_cast<double>(workspace.vertex_faces.size(i));
					x += UNFOLDING_STEP *
						 (across - across.dot(normal) / normal.squaredNorm() * normal);
				}
			}
		});
	}
}

} // namespace orthopoly
