// SPDX-License-Identifier: GPL-3.0-or-later
#include "unfolding.h"

#include "fold_aims.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <unordered_map>

namespace orthopoly {

namespace {

// A face within this cosine of the mean around it needs no closer look: where two out of three
// faces across its edges look the other way, the mean is much further off.
constexpr double PLAIN = 0.8;

// Steps of a try, and tries, each with a ring of vertices more: nearly all folds open in the first.
constexpr int STEPS = 30;
constexpr int TRIES = 3;

/// A face near a fold.
struct FoldFace {
	Index face;
	FoldAim aim;
	/// Its weight in the sum over all of them.
	double weight;
	/// Before the first step.
	double cosine;
};

/// A fold and what is around it.
struct Fold {
	std::vector<FoldFace> faces;
	/// Those that may move.
	std::vector<Index> vertices;
	/// Where in `vertices` each of them is.
	std::unordered_map<Index, std::size_t> places;

	template<class Visit>
	void for_each_corner(const Face& face, Visit visit) const
	{
		for (std::size_t k = 0; k < 3; ++k) {
			const auto place = places.find(face[k]);
			if (place != places.end())
				visit(k, place->second);
		}
	}
};

void make_unique(std::vector<Index>& indices)
{
	std::sort(indices.begin(), indices.end());
	indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

class Unfolder {
public:
	Unfolder(
		const Workspace& workspace,
		const std::vector<Point>& normals,
		std::vector<Point>& positions) :
			workspace_(workspace),
			faces_(workspace.mesh.faces), normals_(normals), positions_(positions)
	{
	}

	// One fold after another, since they may have vertices around them in common: in an order that
	// does not depend on how the mesh is numbered or lies.
	bool run()
	{
		bool moved = false;
		std::vector<std::vector<Index>> groups = group(find_folded());
		std::stable_sort(groups.begin(), groups.end(), [&](const auto& a, const auto& b) {
			return largest_square(a) < largest_square(b);
		});
		const int count = static_cast<int>(groups.size());
		for (int k = 0; k < count; ++k) {
			workspace_.execution.begin_part(k, count);
			moved = unfold(groups[static_cast<std::size_t>(k)]) || moved;
		}
		return moved;
	}

private:
	Point cross_product(Index face) const
	{
		return face_cross_product(positions_, faces_[at(face)]);
	}

	// Of the cross products of some faces, as measured.
	double largest_square(const std::vector<Index>& faces) const
	{
		double largest = 0;
		for (const Index face : faces)
			largest = std::max(
				largest,
				face_cross_product(workspace_.mesh.positions, faces_[at(face)]).squaredNorm());
		return largest;
	}

	FoldAim aim_of(Index face) const { return fold_aim(workspace_, normals_, positions_, face); }

	bool is_folded(Index face, const FoldAim& aim) const
	{
		return orthopoly::is_folded(cross_product(face), aim);
	}

	std::vector<Index> find_folded() const
	{
		const std::vector<Point> sums = cross_products_around(workspace_, positions_);
		std::vector<std::uint8_t> flags(faces_.size(), 0);
		workspace_.execution.for_each(workspace_.mesh.face_count(), [&](std::size_t i) {
			const auto face = static_cast<Index>(i);
			const Point cross = cross_product(face);
			const Point around = cross_product_beside(faces_[i], cross, sums);
			const double length = cross.norm();
			if (cross.dot(normals_[i]) <= FOLDED * length ||
				cross.dot(around) <= PLAIN * length * around.norm())
				flags[i] = is_folded(face, aim_of(face)) ? 1 : 0;
		});
		std::vector<Index> folded;
		for (std::size_t i = 0; i < flags.size(); ++i) {
			if (flags[i] != 0)
				folded.push_back(static_cast<Index>(i));
		}
		return folded;
	}

	// Puts folded faces together whose rings have a face in common.
	std::vector<std::vector<Index>> group(const std::vector<Index>& folded) const
	{
		std::vector<std::size_t> parents(folded.size());
		std::iota(parents.begin(), parents.end(), std::size_t(0));
		const auto root = [&](std::size_t k) {
			while (parents[k] != k)
				k = parents[k] = parents[parents[k]];
			return k;
		};
		std::unordered_map<Index, std::size_t> owners;
		for (std::size_t k = 0; k < folded.size(); ++k) {
			for (const Index corner : faces_[at(folded[k])]) {
				for (const Index* it = workspace_.vertex_faces.begin(corner);
					 it != workspace_.vertex_faces.end(corner);
					 ++it) {
					const std::size_t other = root(owners.emplace(*it, k).first->second);
					const std::size_t own = root(k);
					parents[std::max(own, other)] = std::min(own, other);
				}
			}
		}
		std::vector<std::vector<Index>> groups;
		std::vector<std::size_t> places(folded.size());
		for (std::size_t k = 0; k < folded.size(); ++k) {
			const std::size_t first = root(k);
			if (first == k) {
				places[k] = groups.size();
				groups.emplace_back();
			}
			groups[places[first]].push_back(folded[k]);
		}
		return groups;
	}

	Fold fold_around(std::vector<Index> faces, int rings) const
	{
		Fold fold;
		for (int ring = 0; ring <= rings; ++ring) {
			fold.vertices.clear();
			for (const Index face : faces)
				fold.vertices.insert(
					fold.vertices.end(), faces_[at(face)].begin(), faces_[at(face)].end());
			make_unique(fold.vertices);
			faces.clear();
			for (const Index vertex : fold.vertices)
				faces.insert(
					faces.end(),
					workspace_.vertex_faces.begin(vertex),
					workspace_.vertex_faces.end(vertex));
			make_unique(faces);
		}
		// The outline stays, but for the tip of a face with two edges on it: the face has no other
		// corner to be turned back by.
		const auto stays = [&](Index vertex) {
			return workspace_.mesh.is_fixed(vertex) ||
				   (workspace_.edges.irregular[at(vertex)] != 0 &&
					workspace_.vertex_faces.size(vertex) > 1);
		};
		fold.vertices.erase(
			std::remove_if(fold.vertices.begin(), fold.vertices.end(), stays), fold.vertices.end());
		for (std::size_t k = 0; k < fold.vertices.size(); ++k)
			fold.places[fold.vertices[k]] = k;
		for (const Index face : faces) {
			FoldAim aim = aim_of(face);
			const Point cross = cross_product(face);
			const double square = longest_edge_squared(positions_, faces_[at(face)]);
			// The others keep what they have.
			if (!is_folded(face, aim))
				aim.area =
					square > 0 ? std::min(UNFOLDED_AREA, cross.dot(aim.witness) / square) : 0.0;
			fold.faces.push_back({face, aim, cross.norm(), cosine_of(face, aim)});
		}
		return fold;
	}

	// To what it has to be like and what it has to look towards, both the same but at edges.
	double cosine_of(Index face, const FoldAim& aim) const
	{
		const Point cross = cross_product(face);
		const double length = cross.norm();
		return length > 0 ? 0.5 * cross.dot(aim.target + aim.witness) / length : 0;
	}

	// A step of eq. 12, weighted by area.
	void step_to_targets(const Fold& fold)
	{
		std::vector<Point> sums(fold.vertices.size(), Point::Zero());
		std::vector<double> weights(fold.vertices.size(), 0);
		for (const FoldFace& entry : fold.faces) {
			const Face& face = faces_[at(entry.face)];
			const Point& n = entry.aim.target;
			if (n.isZero(0))
				continue;
			const double area = cross_product(entry.face).norm();
			const Point centroid = face_centroid(positions_, face);
			fold.for_each_corner(face, [&](std::size_t k, std::size_t place) {
				sums[place] += area * n.dot(centroid - positions_[at(face[k])]) * n;
				weights[place] += area;
			});
		}
		for (std::size_t k = 0; k < sums.size(); ++k) {
			if (weights[k] > 0)
				positions_[at(fold.vertices[k])] += sums[k] / weights[k];
		}
	}

	// The mean of the least moves that give each face its area.
	void step_to_areas(const Fold& fold)
	{
		std::vector<Point> sums(fold.vertices.size(), Point::Zero());
		std::vector<int> counts(fold.vertices.size(), 0);
		for (const FoldFace& entry : fold.faces) {
			const Face& face = faces_[at(entry.face)];
			const double side = longest_edge_squared(positions_, face);
			const double missing =
				entry.aim.area * side - cross_product(entry.face).dot(entry.aim.witness);
			if (entry.aim.witness.isZero(0) || missing <= 0 || side <= 0)
				continue;
			std::array<Point, 3> gradients;
			double square = 0;
			fold.for_each_corner(face, [&](std::size_t k, std::size_t) {
				const Point& next = positions_[at(face[(k + 1) % 3])];
				const Point& last = positions_[at(face[(k + 2) % 3])];
				gradients[k] = (next - last).cross(entry.aim.witness);
				square += gradients[k].squaredNorm();
			});
			// No further than about the longest side, however little a move changes.
			square = std::max(square, 0.25 * side);
			fold.for_each_corner(face, [&](std::size_t k, std::size_t place) {
				sums[place] += missing / square * gradients[k];
				++counts[place];
			});
		}
		for (std::size_t k = 0; k < sums.size(); ++k) {
			if (counts[k] > 0)
				positions_[at(fold.vertices[k])] += sums[k] / counts[k];
		}
	}

	Index count_folded(const Fold& fold) const
	{
		return static_cast<Index>(
			std::count_if(fold.faces.begin(), fold.faces.end(), [&](const FoldFace& entry) {
				return is_folded(entry.face, entry.aim);
			}));
	}

	// Whether all faces together are closer to its targets than before, no face of it folded anew.
	bool is_better(const Fold& fold) const
	{
		double gain = 0;
		for (const FoldFace& entry : fold.faces) {
			const double cosine = cosine_of(entry.face, entry.aim);
			if (cosine < std::min(entry.cosine, FOLDED))
				return false;
			gain += entry.weight * (cosine - entry.cosine);
		}
		return gain >= 0;
	}

	bool unfold(const std::vector<Index>& folded)
	{
		bool moved = false;
		for (int rings = 0; rings < TRIES; ++rings) {
			const Fold fold = fold_around(folded, rings);
			std::vector<Point> kept;
			for (const Index vertex : fold.vertices)
				kept.push_back(positions_[at(vertex)]);
			const Index before = count_folded(fold);
			if (before == 0)
				break;
			for (int step = 0; step < STEPS; ++step) {
				step_to_targets(fold);
				step_to_areas(fold);
			}
			if (count_folded(fold) < before && is_better(fold)) {
				moved = true;
				continue;
			}
			for (std::size_t k = 0; k < kept.size(); ++k)
				positions_[at(fold.vertices[k])] = kept[k];
		}
		return moved;
	}

	const Workspace& workspace_;
	const std::vector<Face>& faces_;
	const std::vector<Point>& normals_;
	std::vector<Point>& positions_;
};

} // namespace

bool unfold_faces(
	const Workspace& workspace, const std::vector<Point>& normals, std::vector<Point>& positions)
{
	return Unfolder(workspace, normals, positions).run();
}

} // namespace orthopoly
