// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "closest_point.h"
#include "progress.h"
#include "triangle_mesh.h"

#include <vector>

namespace orthopoly {

/// How far a result is from its ground truth.
struct ErrorMeasures {
	/// Angle between the normals of paired faces, degrees: mean and largest.
	double mean_angle = 0;
	double max_angle = 0;
	/// Mean square angular error, radians squared (eq. 14).
	double msae = 0;
	/// The same over the faces that are not folded: a few folded faces outweigh all others.
	double msae_without_folded = 0;
	/// Area-weighted root mean square distance of the vertices to the whole reference surface, the
	/// caller's length unit (eq. 13), and over the reference's mean edge length.
	double vertex_error = 0;
	double relative_vertex_error = 0;
	/// Largest distance of a vertex to the reference surface.
	double max_distance = 0;
	/// Faces whose normal is more than 90 degrees away from its pair's.
	Index folded_faces = 0;
	/// Those of them whose pair is folded over against its own surroundings: the reference's doing.
	/// Zero where faces are not paired by index.
	Index folded_in_reference = 0;
	/// Faces that were measured: pairs in which both have an area.
	Index measured_faces = 0;
	/// True where face i was paired with face i of the reference, false where each centroid was
	/// paired with the closest point of it.
	bool paired_by_index = false;

	/// #F angles in degrees; -1 where the face was not measured.
	std::vector<double> face_angles;
	/// #V distances; -1 where the vertex was not measured (no face, or farther than the limit).
	std::vector<double> vertex_distances;
};

/// Options of `measure`.
struct MeasureOptions {
	/// Faces and vertices farther than this from the reference are not measured (a partial
	/// reference); the caller's length unit. Not positive: no limit.
	double max_distance = 0;
	/// Threads to run on; 0 means one per processor. Does not change the result.
	int threads = 0;
};

/// A reference that several meshes are measured against.
class ReferenceMeasure {
public:
	/// Throws InvalidMesh where the reference has no face with an area.
	explicit ReferenceMeasure(TriangleMesh reference, const MeasureOptions& options = {});

	/// Measures a mesh. Faces pair by index where both have the same faces, else by the closest
	/// point. Throws InvalidMesh where the mesh has no face with an area, and Cancelled
	/// (execution.h) where the progress asks to stop.
	ErrorMeasures measure(const TriangleMesh& mesh, Progress& progress) const;

private:
	TriangleMesh reference_;
	MeasureOptions options_;
	ClosestPointIndex index_;
	double mean_edge_length_;
};

/// Measures one mesh against a reference, as `ReferenceMeasure` does, and tells nobody how far it
/// is.
ErrorMeasures measure(
	const TriangleMesh& mesh, const TriangleMesh& reference, const MeasureOptions& options = {});

} // namespace orthopoly
