// SPDX-License-Identifier: GPL-3.0-or-later
#include "vertex_update.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace orthopoly {

namespace {

// Faces or vertices a thread takes at a time: some tens of microseconds of work.
constexpr Index GRAIN = 2048;

// Share of the way to the mean of the centroids around it that a vertex at a fold takes: half of
// the way to the mean of its neighbours, which is half as far again.
constexpr double UNFOLDING_STEP = 0.75;

// Share of the way to where it rests that a vertex takes in a step: little beside what the normals
// ask for, and enough to hold it where they ask for nothing.
constexpr double PULL = 0.1;

// Mean square angle (10 degrees) of faces to their targets from which a vertex feels all of the
// pull. Where normals fit a surface the angles fall to a fraction of this in the first steps.
constexpr double UNFIT = 0.03;

// Vertices ahead whose faces are fetched from memory meanwhile: which ones these are, the processor
// cannot guess.
constexpr Index FETCHED_AHEAD = 8;

// Factor by which the accelerated steps together reduce all of the spectrum above their cutoff.
constexpr double REDUCTION = 1e-3;

/// Chebyshev semi-iteration for a spectrum within (cutoff, 1) (Saad 2003, section 12.3): how much
/// of the last move a step repeats, and how much of the descent it adds.
class ChebyshevSteps {
public:
	/// The cutoff is the one that so many steps reduce as far as said; a single step is a plain
	/// one.
	explicit ChebyshevSteps(int steps)
	{
		const double root = std::tanh(0.5 * std::acosh(1 / REDUCTION) / steps);
		const double cutoff = root * root;
		center_ = 0.5 * (1 + cutoff);
		radius_ = 0.5 * (1 - cutoff);
	}

	void next()
	{
		if (ratio_ == 0) {
			ratio_ = radius_ / center_;
			descent = 1 / center_;
			return;
		}
		const double last = ratio_;
		ratio_ = 1 / (2 * center_ / radius_ - last);
		repeat = ratio_ * last;
		descent = 2 * ratio_ / radius_;
	}

	double repeat = 0;
	double descent = 1;

private:
	double center_;
	double radius_;
	double ratio_ = 0;
};

/// What a step reads of a face: a cache line.
struct alignas(64) FaceState {
	/// Target; zero where there is none.
	Point normal;
	Point centroid;
	/// Zero, too, where there is no target.
	double weight;
	/// Squared angle between face and target (to second order; at most 4).
	float turned;
	/// Whether there is a target.
	bool aimed;
	/// Turned away from it.
	bool folded;
};

void measure(
	const std::vector<Point>& positions,
	const Face& face,
	const VertexUpdateOptions& options,
	FaceState& state)
{
	state.centroid = face_centroid(positions, face);
	if (!options.area_weights && options.unfold_cosine <= -1 && options.rest == nullptr)
		return;
	const Point cross = face_cross_product(positions, face);
	const double length = cross.norm();
	if (options.area_weights && state.aimed)
		state.weight = 0.5 * length;
	const double along = cross.dot(state.normal);
	state.folded =
		state.aimed && options.unfold_cosine > -1 && along < options.unfold_cosine * length;
	state.turned = length > 0 ? static_cast<float>(2 - 2 * along / length) : 0;
}

// How far a vertex at a fold goes along the surface, to the middle of the faces around it.
Point way_aside(
	const Workspace& workspace, const std::vector<FaceState>& states, Index vertex, const Point& x)
{
	Point normal = Point::Zero();
	Point across = Point::Zero();
	const Index* const end = workspace.vertex_faces.end(vertex);
	for (const Index* it = workspace.vertex_faces.begin(vertex); it != end; ++it) {
		const FaceState& face = states[at(*it)];
		normal += face.weight * face.normal;
		across += face.centroid - x;
	}
	if (normal.isZero(0) || workspace.edges.irregular[at(vertex)] != 0)
		return Point::Zero();
	across /= static_cast<double>(workspace.vertex_faces.size(vertex));
	return UNFOLDING_STEP * (across - across.dot(normal) / normal.squaredNorm() * normal);
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
	const bool pulled = options.rest != nullptr;
	std::vector<FaceState> states(mesh.faces.size());
	execution.for_each(mesh.face_count(), [&](std::size_t i) {
		const bool aimed = !normals[i].isZero(0);
		states[i] = {normals[i], Point::Zero(), aimed ? 1.0 : 0.0, 0, aimed, false};
	});

	ChebyshevSteps chebyshev(std::max(1, options.iterations));
	std::vector<Point> moves(options.accelerated ? positions.size() : 0, Point::Zero());

	for (int step = 0; step < options.iterations; ++step) {
		execution.begin_part(step, options.iterations);
		execution.for_each(mesh.face_count(), [&](std::size_t i) {
			measure(positions, mesh.faces[i], options, states[i]);
		});
		chebyshev.next();
		// A vertex reads centroids and its own position only, so moving in place is safe.
		execution.parallel_for(mesh.vertex_count(), GRAIN, [&](Index begin, Index end, int) {
			for (Index i = begin; i < end; ++i) {
#if defined(__GNUC__)
				// Not in a function of its own, which would be taken for one that does nothing.
				const Index ahead = std::min(i + FETCHED_AHEAD, end - 1);
				for (const Index* it = workspace.vertex_faces.begin(ahead);
					 it != workspace.vertex_faces.end(ahead);
					 ++it)
					__builtin_prefetch(&states[at(*it)]);
#endif
				if (mesh.is_fixed(i))
					continue;
				Point& x = positions[at(i)];
				const Point to_rest = pulled ? Point((*options.rest)[at(i)] - x) : Point::Zero();
				Point sum = Point::Zero();
				Point taken = Point::Zero();
				double total = 0;
				double turned = 0;
				bool folded = false;
				for (const Index* it = workspace.vertex_faces.begin(i);
					 it != workspace.vertex_faces.end(i);
					 ++it) {
					const FaceState& face = states[at(*it)];
					const Point& n = face.normal;
					sum += (face.weight * n.dot(face.centroid - x)) * n; // eq. 12
					total += face.weight;
					if (pulled) {
						taken += (face.weight * n.dot(to_rest)) * n;
						turned += face.weight * static_cast<double>(face.turned);
					}
					folded |= face.folded;
				}
				const Point aside =
					folded ? way_aside(workspace, states, i, x) : Point(Point::Zero());
				if (total > 0) {
					Point move = sum / total;
					if (pulled) {
						const double unfit = std::min(1.0, turned / (total * UNFIT));
						move += PULL * unfit * (to_rest - taken / total);
					}
					if (options.paces != nullptr)
						move *= (*options.paces)[at(i)];
					if (options.accelerated) {
						Point& last = moves[at(i)];
						last = chebyshev.repeat * last + chebyshev.descent * move;
						move = last;
					}
					x += move;
				}
				if (folded)
					x += aside;
			}
		});
	}
}

} // namespace orthopoly
