// SPDX-License-Identifier: GPL-3.0-or-later
#include "measures.h"

#include "closest_point.h"
#include "errors.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>

namespace orthopoly {

namespace {

constexpr double DEGREES_PER_RADIAN = 57.295779513082320877;

std::size_t at(Index index)
{
	return static_cast<std::size_t>(index);
}

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

/// One measurement: what both of its halves need.
class Measurement {
public:
	Measurement(
		const TriangleMesh& mesh, const TriangleMesh& reference, const MeasureOptions& options) :
			mesh_(mesh),
			reference_(reference), options_(options), index_(reference),
			geometry_(face_geometry(mesh.positions, mesh.faces)),
			reference_geometry_(face_geometry(reference.positions, reference.faces))
	{
	}

	ErrorMeasures run()
	{
		measure_vertices();
		measure_faces();
		return std::move(measures_);
	}

private:
	bool too_far(double distance) const
	{
		return options_.max_distance > 0 && distance > options_.max_distance;
	}

	// Eq. 13.
	void measure_vertices()
	{
		const std::vector<std::uint8_t> used = vertices_of_faces(mesh_);
		const std::vector<double> weights = areas_around_vertices(mesh_, geometry_.areas);
		measures_.vertex_distances.assign(mesh_.positions.size(), -1.0);
		double sum = 0;
		double weight_sum = 0;
		for (std::size_t i = 0; i < mesh_.positions.size(); ++i) {
			if (used[i] == 0)
				continue;
			const double distance = index_.find(mesh_.positions[i]).distance;
			if (too_far(distance))
				continue;
			measures_.vertex_distances[i] = distance;
			measures_.max_distance = std::max(measures_.max_distance, distance);
			sum += weights[i] * distance * distance;
			weight_sum += weights[i];
		}
		if (weight_sum > 0)
			measures_.vertex_error = std::sqrt(sum / weight_sum);
		measures_.relative_vertex_error =
			measures_.vertex_error / mean_edge_length(reference_.positions, reference_.faces);
	}

	// Eq. 14.
	void measure_faces()
	{
		measures_.paired_by_index = mesh_.faces == reference_.faces;
		measures_.face_angles.assign(mesh_.faces.size(), -1.0);
		double sum = 0;
		double squared_sum = 0;
		double folded_squared_sum = 0;
		for (std::size_t i = 0; i < mesh_.faces.size(); ++i) {
			const Point& normal = geometry_.normals[i];
			const Point paired = paired_normal(static_cast<Index>(i));
			if (normal.isZero(0) || paired.isZero(0))
				continue;
			const double angle = angle_between(normal, paired);
			measures_.face_angles[i] = DEGREES_PER_RADIAN * angle;
			measures_.max_angle = std::max(measures_.max_angle, measures_.face_angles[i]);
			sum += angle;
			squared_sum += angle * angle;
			++measures_.measured_faces;
			if (normal.dot(paired) < 0) {
				++measures_.folded_faces;
				folded_squared_sum += angle * angle;
			}
		}
		if (measures_.measured_faces > 0) {
			measures_.mean_angle = DEGREES_PER_RADIAN * sum / measures_.measured_faces;
			measures_.msae = squared_sum / measures_.measured_faces;
		}
		if (measures_.measured_faces > measures_.folded_faces)
			measures_.msae_without_folded = (squared_sum - folded_squared_sum) /
											(measures_.measured_faces - measures_.folded_faces);
	}

	// Zero where the face has no pair.
	Point paired_normal(Index face) const
	{
		if (measures_.paired_by_index && options_.max_distance <= 0)
			return reference_geometry_.normals[at(face)];
		const ClosestPoint closest = index_.find(geometry_.centroids[at(face)]);
		if (too_far(closest.distance))
			return Point::Zero();
		return reference_geometry_.normals[at(measures_.paired_by_index ? face : closest.face)];
	}

	const TriangleMesh& mesh_;
	const TriangleMesh& reference_;
	const MeasureOptions& options_;
	const ClosestPointIndex index_;
	const FaceGeometry geometry_;
	const FaceGeometry reference_geometry_;
	ErrorMeasures measures_;
};

} // namespace

ErrorMeasures
measure(const TriangleMesh& mesh, const TriangleMesh& reference, const MeasureOptions& options)
{
	validate(mesh);
	validate(reference);
	if (std::all_of(mesh.faces.begin(), mesh.faces.end(), [&](const Face& face) {
			return is_degenerate(mesh.positions, face);
		}))
		throw InvalidMesh(
			"none of the " + std::to_string(mesh.face_count()) +
			" faces of the mesh has an area, so there is no angle to measure; check the coordinates");
	return Measurement(mesh, reference, options).run();
}

} // namespace orthopoly
