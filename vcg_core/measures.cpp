// SPDX-License-Identifier: GPL-3.0-or-later
#include "measures.h"

#include "errors.h"
#include "execution.h"
#include "workspace.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

namespace orthopoly {

namespace {

constexpr double DEGREES_PER_RADIAN = 57.295779513082320877;
constexpr double RIGHT_ANGLE = 90 / DEGREES_PER_RADIAN;

// Stays exact for angles near 0 and 180 degrees, where the arc cosine loses half the digits.
double angle_between(const Point& a, const Point& b)
{
	return std::atan2(a.cross(b).norm(), a.dot(b));
}

// A third of the area of the faces around each vertex would do as well: eq. 13 divides by the sum.
std::vector<double>
areas_around_vertices(const TriangleMesh& mesh, const std::vector<double>& areas)
{
	std::vector<double> sums(mesh.positions.size(), 0.0);
	for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
		for (const Index vertex : mesh.faces[i])
			sums[at(vertex)] += areas[i];
	}
	return sums;
}

std::vector<std::uint8_t> vertices_of_faces(const TriangleMesh& mesh)
{
	std::vector<std::uint8_t> flags(mesh.positions.size(), 0);
	for (const Face& face : mesh.faces) {
		for (const Index vertex : face)
			flags[at(vertex)] = 1;
	}
	return flags;
}

// A query walks through a few dozen nodes of the tree, in about a microsecond.
constexpr Index QUERIES_GRAIN = 256;

// Calls body(i) for every index in [0, count) on the threads.
template<class Body>
void for_each_query(Execution& execution, std::size_t count, Body body)
{
	execution.parallel_for(
		static_cast<Index>(count), QUERIES_GRAIN, [&](Index begin, Index end, int) {
			for (Index i = begin; i < end; ++i)
				body(at(i));
		});
}

/// What a mesh is measured against.
struct Reference {
	const TriangleMesh& mesh;
	const ClosestPointIndex& index;
	const MeasureOptions& options;
};

/// One measurement: what both of its halves need.
class Measurement {
public:
	Measurement(const TriangleMesh& mesh, const Reference& reference, Execution& execution) :
			mesh_(mesh), reference_(reference), execution_(execution),
			geometry_(face_geometry(mesh.positions, mesh.faces))
	{
	}

	ErrorMeasures run()
	{
		const char* const words = "measuring the distance to the reference";
		execution_.begin_phase(0, 0.4, words);
		measure_vertices();
		execution_.begin_phase(0.4, 0.8, words);
		measure_faces();
		execution_.begin_phase(0.8, 1, words);
		count_folded_in_reference();
		return std::move(measures_);
	}

private:
	bool too_far(double distance) const
	{
		return reference_.options.max_distance > 0 && distance > reference_.options.max_distance;
	}

	// Eq. 13.
	void measure_vertices()
	{
		const std::vector<std::uint8_t> used = vertices_of_faces(mesh_);
		const std::vector<double> weights = areas_around_vertices(mesh_, geometry_.areas);
		measures_.vertex_distances.assign(mesh_.positions.size(), -1.0);
		for_each_query(execution_, mesh_.positions.size(), [&](std::size_t i) {
			if (used[i] == 0)
				return;
			const double distance = reference_.index.find(mesh_.positions[i]).distance;
			if (!too_far(distance))
				measures_.vertex_distances[i] = distance;
		});
		double sum = 0;
		double weight_sum = 0;
		for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
			const double distance = measures_.vertex_distances[i];
			if (distance < 0)
				continue;
			measures_.max_distance = std::max(measures_.max_distance, distance);
			sum += weights[i] * distance * distance;
			weight_sum += weights[i];
		}
		if (weight_sum > 0)
			measures_.vertex_error = std::sqrt(sum / weight_sum);
	}

	// Eq. 14.
	void measure_faces()
	{
		measures_.paired_by_index = mesh_.faces == reference_.mesh.faces;
		measures_.face_angles.assign(mesh_.faces.size(), -1.0);
		for_each_query(execution_, mesh_.faces.size(), [&](std::size_t i) {
			const Point paired = paired_normal(i);
			if (!geometry_.normals[i].isZero(0) && !paired.isZero(0))
				measures_.face_angles[i] = angle_between(geometry_.normals[i], paired);
		});
		double sum = 0;
		double squared_sum = 0;
		double folded_squared_sum = 0;
		for (double& angle : measures_.face_angles) {
			if (angle < 0)
				continue;
			sum += angle;
			squared_sum += angle * angle;
			++measures_.measured_faces;
			if (angle > RIGHT_ANGLE) {
				++measures_.folded_faces;
				folded_squared_sum += angle * angle;
			}
			angle *= DEGREES_PER_RADIAN;
			measures_.max_angle = std::max(measures_.max_angle, angle);
		}
		if (measures_.measured_faces > 0) {
			measures_.mean_angle = DEGREES_PER_RADIAN * sum / measures_.measured_faces;
			measures_.msae = squared_sum / measures_.measured_faces;
		}
		if (measures_.measured_faces > measures_.folded_faces)
			measures_.msae_without_folded = (squared_sum - folded_squared_sum) /
											(measures_.measured_faces - measures_.folded_faces);
	}

	void count_folded_in_reference()
	{
		if (measures_.folded_faces == 0 || !measures_.paired_by_index)
			return;
		const TriangleMesh& mesh = reference_.mesh;
		const std::vector<std::uint8_t> folded =
			folded_faces(mesh.positions, Workspace(mesh, execution_));
		for (std::size_t i = 0; i < folded.size(); ++i) {
			if (folded[i] != 0 && measures_.face_angles[i] > 90)
				++measures_.folded_in_reference;
		}
	}

	// Zero where the face has no pair.
	Point paired_normal(std::size_t face) const
	{
		if (measures_.paired_by_index && reference_.options.max_distance <= 0)
			return normal_of_reference(face);
		const ClosestPoint closest = reference_.index.find(geometry_.centroids[face]);
		if (too_far(closest.distance))
			return Point::Zero();
		return normal_of_reference(measures_.paired_by_index ? face : at(closest.face));
	}

	Point normal_of_reference(std::size_t face) const
	{
		const TriangleMesh& mesh = reference_.mesh;
		if (is_degenerate(mesh.positions, mesh.faces[face]))
			return Point::Zero();
		return face_cross_product(mesh.positions, mesh.faces[face]).normalized();
	}

	const TriangleMesh& mesh_;
	const Reference& reference_;
	Execution& execution_;
	const FaceGeometry geometry_;
	ErrorMeasures measures_;
};

} // namespace

ReferenceMeasure::ReferenceMeasure(TriangleMesh reference, const MeasureOptions& options) :
		reference_((validate(reference), std::move(reference))), options_(options),
		index_(reference_),
		mean_edge_length_(mean_edge_length(reference_.positions, reference_.faces))
{
}

ErrorMeasures ReferenceMeasure::measure(const TriangleMesh& mesh, Progress& progress) const
{
	validate(mesh);
	if (std::all_of(mesh.faces.begin(), mesh.faces.end(), [&](const Face& face) {
			return is_degenerate(mesh.positions, face);
		}))
		throw InvalidMesh(
			"none of the " + std::to_string(mesh.face_count()) +
			" faces of the mesh has an area, so there is no angle to measure; check the coordinates");
	Execution execution(options_.threads, progress);
	const Reference reference = {reference_, index_, options_};
	ErrorMeasures measures = Measurement(mesh, reference, execution).run();
	measures.relative_vertex_error = measures.vertex_error / mean_edge_length_;
	return measures;
}

ErrorMeasures
measure(const TriangleMesh& mesh, const TriangleMesh& reference, const MeasureOptions& options)
{
	Progress silent;
	return ReferenceMeasure(reference, options).measure(mesh, silent);
}

} // namespace orthopoly
