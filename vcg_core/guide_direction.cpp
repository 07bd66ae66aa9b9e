// SPDX-License-Identifier: GPL-3.0-or-later
#include "guide_direction.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace orthopoly {

namespace {

constexpr double PI = 3.14159265358979323846;

// Faces a thread takes at a time: about a millisecond of work at the default ring.
constexpr Index GRAIN = 256;

// Finds guide directions one after the other. Keeps scratch memory, so one object per thread.
class TensorVoting {
public:
	TensorVoting(
		const Workspace& workspace,
		const FaceGeometry& geometry,
		const GuideDirectionOptions& options) :
			ring_(workspace.ring_collector()),
			geometry_(geometry), rings_(options.ring),
			angle_scale_(1.0 - std::cos(options.sigma_theta * PI / 180.0))
	{
	}

	Point direction(Index face)
	{
		const Point& n = geometry_.normals[at(face)];
		if (n.isZero(0))
			return Point::Zero();
		ring_.collect(face, rings_);
		const double sigma_p_squared = 4.0 * largest_distance_squared();

		Eigen::Matrix3d tensor = Eigen::Matrix3d::Zero();
		Point mean = Point::Zero();
		for (const Index j : ring_.faces()) {
			const Point& n_j = geometry_.normals[at(j)];
			const double distance_squared =
				(geometry_.centroids[at(face)] - geometry_.centroids[at(j)]).squaredNorm();
			const double spread = (1.0 - n.dot(n_j)) / angle_scale_;
			// All centroids in one point: the distance says nothing.
			const double eta =
				sigma_p_squared > 0 ? std::exp(-distance_squared / sigma_p_squared) : 1.0; // eq. 2
			const double phi = std::exp(-spread * spread);                                 // eq. 3
			tensor += (eta * phi) * n_j * n_j.transpose(); // eqs. 1 and 4
			mean += (eta * phi) * n_j;
		}
		Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
		solver.computeDirect(tensor);
		const Point v = solver.eigenvectors().col(2);
		return v.dot(mean) < 0 ? Point(-v) : v;
	}

private:
	// Of two centroids of the ring.
	double largest_distance_squared()
	{
		// Two points are no farther apart than the sum of their distances from a third. Taken from
		// the outermost inwards, few pairs are left to try once the first have set the mark.
		const std::vector<Point>& points = geometry_.centroids;
		const Point& center = points[at(ring_.faces().front())];
		by_radius_.clear();
		for (const Index i : ring_.faces())
			by_radius_.emplace_back((points[at(i)] - center).norm(), i);
		std::sort(by_radius_.begin(), by_radius_.end(), std::greater<>());
		double largest = 0;
		double mark = 0;
		for (std::size_t a = 0; a < by_radius_.size(); ++a) {
			for (std::size_t b = a + 1; b < by_radius_.size(); ++b) {
				if (by_radius_[a].first + by_radius_[b].first <= mark)
					break;
				const double squared =
					(points[at(by_radius_[a].second)] - points[at(by_radius_[b].second)])
						.squaredNorm();
				if (squared > largest) {
					largest = squared;
					mark = std::sqrt(largest);
				}
			}
		}
		return largest;
	}

	RingCollector ring_;
	const FaceGeometry& geometry_;
	int rings_;
	double angle_scale_;
	std::vector<std::pair<double, Index>> by_radius_;
};

} // namespace

std::vector<Point> guide_directions(
	const Workspace& workspace, const FaceGeometry& geometry, const GuideDirectionOptions& options)
{
	std::vector<Point> guides(geometry.normals.size());
	std::vector<TensorVoting> voting(
		at(workspace.execution.threads()), TensorVoting(workspace, geometry, options));
	workspace.execution.parallel_for(
		workspace.mesh.face_count(), GRAIN, [&](Index begin, Index end, int worker) {
			for (Index i = begin; i < end; ++i)
				guides[at(i)] = voting[at(worker)].direction(i);
		});
	return guides;
}

} // namespace orthopoly
