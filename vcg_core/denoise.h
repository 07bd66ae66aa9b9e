// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "progress.h"
#include "triangle_mesh.h"

#include <optional>
#include <vector>

namespace orthopoly {

enum class Method {
	/// Everything resolved from the mesh: polynomials on the scattered nodes of the surface itself.
	Adaptive,
	/// Normals filtered by discrete orthogonal polynomials over non-local similar structures.
	Paper,
};

/// What the noise of neighbouring vertices has to do with each other.
enum class NoiseType {
	/// Read off the mesh; as White wherever it is not clear.
	Automatic,
	/// Nothing: independent from vertex to vertex.
	White,
	/// Correlated over several edges, as depth cameras, structured-light scanners and volumes leave
	/// it.
	Scanner,
};

/// How much of the estimated noise to take away.
enum class Strength { Gentle, Normal, Strong };

/// Options of `denoise`. An empty optional is resolved by the method, which says in the result
/// what it chose. Ranges, labels and explanations are in the table of parameters.h.
struct DenoiseOptions {
	Method method = Method::Adaptive;
	/// Adaptive: half, once or twice the estimated noise level.
	Strength strength = Strength::Normal;
	/// The result says which of the two it was taken for; in between, which it was closer to.
	NoiseType noise_type = NoiseType::Automatic;
	/// Adaptive: standard deviation of the noise along the normal before `strength` is applied to
	/// it, in mean edge lengths of the surface below the noise (which lengthens them); where the
	/// noise differs from place to place, the root mean square. One that is given is used however
	/// small; below an estimate of 0.025 nothing is done but put back spikes.
	std::optional<double> noise_level;
	/// Rounds of normal filtering and vertex update (n_iter of the paper: 5).
	std::optional<int> iterations;
	/// Steps of the vertex update in each of them (v_iter of the paper: 10).
	std::optional<int> vertex_iterations;
	/// Leave vertices on open boundaries where they are.
	bool keep_boundary = false;
	/// Most rings that either of the next two may have.
	static constexpr int MAX_RINGS = 10;
	/// Paper: rings r of the local structure S_i, in face rings.
	int guide_ring = 1;
	/// Rings R of the non-local structure, in face rings (automatic in the paper's method: one more
	/// than the guide ring, where that is allowed); adaptive: the largest tried for normals, those
	/// of heights being wider in the same measure as by themselves.
	std::optional<int> structure_ring;
	/// Paper: sigma_theta of eq. 3, degrees.
	double sigma_theta = 30.0;
	/// Cosine of the largest angle between directions that count as similar (section 2.2).
	std::optional<double> cos_threshold;
	/// Added to it after each iteration (delta d).
	std::optional<double> cos_threshold_increment;
	/// Paper: orders a and b of the polynomials along and across the matrix of eq. 11. The paper
	/// names neither these nor r and R; the defaults are what measured best (polynomial_fit.h).
	int order_x = 2;
	int order_y = 0;
	/// Threads to run on; 0 means one per processor. Does not change the result.
	int threads = 0;
};

/// What `denoise` did.
struct DenoiseResult {
	enum class Status {
		Done,
		/// The caller asked to stop; positions are those given.
		Cancelled,
		/// No noise worth removing was found; positions are those given.
		NothingToDo,
	};
	Status status = Status::Done;
	/// #V, in the caller's order. Fixed vertices are bit for bit those given.
	std::vector<Point> positions;
	/// The options with every automatic value filled in (only those the method uses).
	DenoiseOptions resolved;
	/// Adaptive: estimated noise along the normal, in the unit of `noise_level`, also where a level
	/// was given.
	double estimated_noise = 0;
	/// What a tenth of the vertices is below and another tenth above, where the noise differs from
	/// place to place; `estimated_noise` is the root mean square then. The same as that elsewhere.
	double estimated_noise_low = 0;
	double estimated_noise_high = 0;
	/// Adaptive: vertices that stood far out by themselves (spikes.h) and were put back first; the
	/// noise above is that without them.
	Index spikes = 0;
	int iterations_done = 0;
	/// Faces without area, which are neither filtered nor vote.
	Index degenerate_faces = 0;
	/// Edges with more than two faces or two faces of opposite orientation.
	Index non_manifold_edges = 0;
	/// Vertices that are the same as another on a seam (seams.h), and moved with it.
	Index seam_vertices = 0;
	/// Faces more than 90 degrees away from the mean normal of those around them.
	Index folded_faces_before = 0;
	Index folded_faces_after = 0;
	/// Vertices moved, and by how much (mean over all vertices and largest, the caller's length
	/// unit).
	Index moved_vertices = 0;
	double mean_displacement = 0;
	double max_displacement = 0;
};

/// Throws InvalidParameter where an option is not finite, out of its range (parameters.h) or at
/// odds with another (a guide ring wider than the structure ring).
void validate(const DenoiseOptions& options);

/// Denoises a mesh. Faces keep their order and vertices; only positions change.
///
/// The input is never changed. Same result bit for bit for any number of threads. Throws
/// InvalidMesh as `validate` of a mesh does and for one without a face that has an area,
/// InvalidParameter as `validate` of the options does.
DenoiseResult denoise(const TriangleMesh& mesh, const DenoiseOptions& options, Progress& progress);

} // namespace orthopoly
