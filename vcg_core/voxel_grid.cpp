// SPDX-License-Identifier: GPL-3.0-or-later
#include "voxel_grid.h"

#include "interpolation.h"
#include "sampling.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace orthopoly {

namespace {

// Faces whose edges are looked at. Of pairs of their edges one in twenty is across one axis, which
// makes hundreds where others are alone.
constexpr Index FACES = 7000;

// Edges below this part of the mean length may point where rounding has them point.
constexpr double LEAST_LENGTH = 0.3;

// Edges are paired with those so many places further in the order of their lengths: any others
// than their neighbours in the mesh.
constexpr std::array<std::size_t, 3> PARTNERS = {3, 7, 11};

// Sine of the angle from which two edges tell what is across to both.
constexpr double LEAST_SINE = 0.3;

// Size of the cells that votes for an axis are counted in, and the number of those looked at: the
// votes for one may be spread over eight, and planes of the surface have theirs.
constexpr double CELL = 0.01;
constexpr std::size_t CANDIDATES = 12;

// Cosines to an axis of the edges that it is found by, one after the other.
constexpr std::array<double, 4> NARROWING = {0.02, 0.005, 0.002, 0.002};

// Cosines to an axis up to which an edge is across to it, and axes to each other: single precision
// leaves 5e-4 in a grid of a thousand cubes a side. And where vertices may have been moved off the
// cubes' edges: a third to two thirds of the edges are within it then.
constexpr double ACROSS = 0.002;
constexpr double NEARLY_ACROSS = 0.01;

// Length of the longest tenth of the edges, over the mean. Cubes leave 1.5, of two sizes 1.75; what
// was drawn along the axes has faces of any size.
constexpr double LONG_EDGES = 2.1;
constexpr double SHORT_EDGES = 1.9;

constexpr std::size_t FEWEST_EDGES = 100;

struct Edge {
	double length;
	/// Unit vector along it.
	Point direction;
	/// Whether an end of it may move.
	bool moving;
};

// The edges of a sample of faces, in the order of their lengths.
std::vector<Edge>
sample_edges(const Workspace& workspace, const std::vector<Point>& positions, double mean_length)
{
	const std::vector<Index> faces =
		sample_by_value(face_geometry(workspace, positions).areas, FACES);
	const double least = LEAST_LENGTH * mean_length;
	std::vector<Edge> edges;
	edges.reserve(3 * faces.size());
	for (const Index i : faces) {
		const Face& face = workspace.mesh.faces[at(i)];
		for (std::size_t corner = 0; corner < 3; ++corner) {
			const Index from = face[corner];
			const Index to = face[(corner + 1) % 3];
			const Point edge = positions[at(to)] - positions[at(from)];
			const double length = edge.norm();
			if (length > least)
				edges.push_back(
					{length,
					 edge / length,
					 !workspace.mesh.is_fixed(from) || !workspace.mesh.is_fixed(to)});
		}
	}
	std::stable_sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) {
		return a.length < b.length;
	});
	return edges;
}

// A cell of the cube around the unit vectors, and its middle.
std::uint32_t cell_of(const Point& unit)
{
	const auto digit = [](double x) {
		return static_cast<std::uint32_t>(std::lround(x / CELL) + 128);
	};
	return digit(unit.x()) << 16U | digit(unit.y()) << 8U | digit(unit.z());
}

Point middle_of(std::uint32_t cell)
{
	const auto coordinate = [&](unsigned shift) {
		return CELL * (static_cast<double>(cell >> shift & 255U) - 128);
	};
	return Point(coordinate(16), coordinate(8), coordinate(0)).normalized();
}

// The cells that most pairs of edges are across to, the fullest first.
std::vector<std::uint32_t> fullest_cells(const std::vector<Point>& directions)
{
	std::vector<std::uint32_t> votes;
	votes.reserve(PARTNERS.size() * directions.size());
	for (const std::size_t further : PARTNERS) {
		for (std::size_t k = further; k < directions.size(); ++k) {
			Point across = directions[k - further].cross(directions[k]);
			const double sine = across.norm();
			if (sine < LEAST_SINE)
				continue;
			Index largest = 0;
			across.cwiseAbs().maxCoeff(&largest);
			votes.push_back(cell_of(across / (across[largest] < 0 ? -sine : sine)));
		}
	}
	std::sort(votes.begin(), votes.end());
	std::vector<std::pair<std::size_t, std::uint32_t>> cells;
	for (auto it = votes.begin(); it != votes.end();) {
		const auto end = std::upper_bound(it, votes.end(), *it);
		cells.emplace_back(static_cast<std::size_t>(end - it), *it);
		it = end;
	}
	const std::size_t count = std::min(CANDIDATES, cells.size());
	std::partial_sort(
		cells.begin(),
		cells.begin() + static_cast<std::ptrdiff_t>(count),
		cells.end(),
		[](const auto& a, const auto& b) { return a > b; });
	std::vector<std::uint32_t> fullest;
	for (std::size_t k = 0; k < count; ++k)
		fullest.push_back(cells[k].second);
	return fullest;
}

// The direction that the edges about across to one are most across to.
Point sharpened(Point axis, const std::vector<Point>& directions)
{
	for (const double cosine : NARROWING) {
		Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
		for (const Point& direction : directions) {
			if (std::abs(direction.dot(axis)) < cosine)
				squares += direction * direction.transpose();
		}
		axis = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(squares).eigenvectors().col(0);
	}
	return axis;
}

double share_across(const Point& axis, const std::vector<Point>& directions, double cosine)
{
	const auto count = std::count_if(directions.begin(), directions.end(), [&](const Point& d) {
		return std::abs(d.dot(axis)) < cosine;
	});
	return static_cast<double>(count) / static_cast<double>(directions.size());
}

// The share of the edges that are across the one of three axes that has the fewest, for the axes
// that have the most of those that two of the given ones make.
double
best_share(const std::vector<Point>& axes, const std::vector<Point>& directions, double cosine)
{
	std::vector<double> shares;
	shares.reserve(axes.size());
	for (const Point& axis : axes)
		shares.push_back(share_across(axis, directions, cosine));
	double best = 0;
	for (std::size_t i = 0; i < axes.size(); ++i) {
		for (std::size_t j = i + 1; j < axes.size(); ++j) {
			const double two = std::min(shares[i], shares[j]);
			if (two <= best || std::abs(axes[i].dot(axes[j])) > cosine)
				continue;
			const Point third = axes[i].cross(axes[j]);
			best = std::max(best, std::min(two, share_across(third, directions, cosine)));
		}
	}
	return best;
}

VoxelShares shares_of(const std::vector<Edge>& edges, double mean_length)
{
	if (edges.size() < FEWEST_EDGES)
		return {};
	const double longest = edges[edges.size() / 10 * 9].length;
	const double of_cubes = way_between(LONG_EDGES, SHORT_EDGES, longest / mean_length);
	if (of_cubes == 0)
		return {};
	std::vector<Point> directions;
	directions.reserve(edges.size());
	for (const Edge& edge : edges)
		directions.push_back(edge.direction);
	std::vector<Point> axes;
	for (const std::uint32_t cell : fullest_cells(directions))
		axes.push_back(sharpened(middle_of(cell), directions));
	return {
		of_cubes * best_share(axes, directions, ACROSS),
		of_cubes * best_share(axes, directions, NEARLY_ACROSS)};
}

} // namespace

VoxelShares voxel_shares(const Workspace& workspace, const std::vector<Point>& positions)
{
	const double mean_length = mean_edge_length(workspace, positions);
	std::vector<Edge> edges = sample_edges(workspace, positions, mean_length);
	const VoxelShares all = shares_of(edges, mean_length);
	if (workspace.mesh.fixed.empty())
		return all;
	edges.erase(
		std::remove_if(edges.begin(), edges.end(), [](const Edge& edge) { return !edge.moving; }),
		edges.end());
	const VoxelShares moving = shares_of(edges, mean_length);
	return {std::min(all.on, moving.on), std::min(all.near, moving.near)};
}

} // namespace orthopoly
