// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_level.h"

#include "interpolation.h"
#include "local_heights.h"
#include "sampling.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace orthopoly {

namespace {

/// A share of the residual variances and the same quantile of the normal distribution.
struct Quantile {
	double share;
	double normal;
};

// The share that is taken as free of features, which only ever add to the variances: low for coarse
// meshes with few flat places, but not so low that it is ruled by the tail of noise that is not
// Gaussian.
constexpr Quantile FLAT = {0.2, -0.8416};

// And one at which there are outliers among the neighbours.
constexpr Quantile ORDINARY = {0.5, 0};

// The quantile of so many variances is steady to about one per cent.
constexpr Index SAMPLES = 20000;

// Polynomials that tell the kind of noise: wide ones, since narrow ones follow an outlier, and
// fewer, since they are slow.
constexpr int WIDE_RINGS = 4;
constexpr std::size_t WIDE_SAMPLES = 2000;

// Noise leaves the same over any number of rings, detail as small as the triangles leaves more the
// wider they are. From two rings to three the detail's part grows by this factor at least, or by
// that from three to four where it is more.
constexpr double GROWTH_OF_DETAIL = 1.9;

// Growth of the variance that is not taken for that of detail: a little comes of curvature, and of
// noise that is not Gaussian.
constexpr double GROWTH_OF_NOISE = 1.1;

// Edges grow with the rings as well, but similar faces leave less than this part of what whole
// rings do then; of detail they leave the second part at least.
constexpr double EDGES = 0.85;
constexpr double NO_EDGES = 0.91;

// The shares of the variances that are compared.
constexpr std::array<Quantile, 3> GROWING = {
	Quantile {0.1, -1.2816}, Quantile {0.2, -0.8416}, Quantile {0.35, -0.3853}};

// Where a mesh is so coarse that edges are everywhere, polynomials over whole rings take them for
// noise. So do others, over the faces alone whose normals are within this cosine (37 degrees) of
// the vertex's. They need no share so low, and a few of them tell what the level is without the
// edges; it is taken where it is lower by more than what choosing the faces takes away.
constexpr double SIMILAR = 0.8;
constexpr Quantile SIMILAR_FLAT = {0.35, -0.3853};
constexpr std::size_t SIMILAR_SAMPLES = 5000;
constexpr double SIMILAR_LEVEL = 0.97;

// Between these levels, in edge lengths, the normals of the smoothed surface come to scatter as
// far as that, and the choice takes noise away.
constexpr double SIMILAR_TO = 0.33;
constexpr double SIMILAR_NEVER = 0.5;

// Noise leaves hardly a pair of faces in one plane, while surfaces that were drawn have many. Below
// the first share of what noise of the level makes of this share of the pairs there is none, from
// the second on there may be; strong noise, which bends edges less than it would were the surface
// flat, makes a third at least.
constexpr Quantile IN_PLANE = {0.2, 0.2533};
constexpr double DRAWN = 0.1;
constexpr double MEASURED = 0.25;

// A corner seen so far off the other face in its plane says more of the noise there than of the
// angle between both: sum of the sizes of its barycentric coordinates.
constexpr double FAR_OFF = 8;

// Triangles lower than this many deviations of the noise are turned by it so far that heights over
// the smoothed surface miss a part of it: half of it where they are half a deviation low. What is
// read at them is left out, but not at this share of the vertices, where triangles are highest.
constexpr double STEADY_HEIGHT = 1.5;
constexpr double LEAST_STEADY = 0.4;

// Each time with the level of the last; from the third on it stays.
constexpr int STEADY_ROUNDS = 3;

constexpr Index GRAIN = 64;

// Rings of vertices of a polynomial.
constexpr int RINGS = 2;

/// A residual variance, negative where there is none, and its degrees of freedom.
struct Variance {
	double value = -1;
	double free = 0;
};

/// Quadratic height polynomials over the similar faces around vertices.
class SimilarHeights {
public:
	SimilarHeights(
		const Workspace& workspace,
		const std::vector<Point>& noisy,
		const std::vector<Point>& smooth) :
			workspace_(workspace),
			noisy_(noisy), smooth_(smooth), ring_(workspace),
			stamps_(workspace.mesh.positions.size(), -1)
	{
	}

	Variance fit(Index vertex)
	{
		Point normal = cross_product_around(workspace_, smooth_, vertex);
		const double length = normal.norm();
		if (!(length > 0))
			return {};
		normal /= length;
		collect(vertex, normal);
		if (members_.size() < TERMS + FEWEST_FREE)
			return {};
		return {
			residual(smooth_[at(vertex)], normal), static_cast<double>(members_.size() - TERMS)};
	}

private:
	static constexpr std::size_t TERMS = 6;
	static constexpr std::size_t FEWEST_FREE = 4;
	using Terms = Eigen::Matrix<double, static_cast<int>(TERMS), 1>;
	using Gram = Eigen::Matrix<double, static_cast<int>(TERMS), static_cast<int>(TERMS)>;

	// The corners of the similar faces around the vertex and its neighbours.
	void collect(Index vertex, const Point& normal)
	{
		ring_.collect(vertex, 1);
		members_.clear();
		const IndexLists& around = workspace_.vertex_faces;
		for (const Index i : ring_.vertices()) {
			for (const Index* face = around.begin(i); face != around.end(i); ++face) {
				const Face& corners = workspace_.mesh.faces[at(*face)];
				const Point cross = face_cross_product(smooth_, corners);
				if (!(cross.dot(normal) > SIMILAR * cross.norm()))
					continue;
				for (const Index corner : corners) {
					if (stamps_[at(corner)] != vertex)
						members_.push_back(corner);
					stamps_[at(corner)] = vertex;
				}
			}
		}
	}

	// The residual variance over the members; negative where they do not fix a quadratic.
	double residual(const Point& center, const Point& normal) const
	{
		const Point tangent = normal.unitOrthogonal();
		const Point bitangent = normal.cross(tangent);
		double extent = 0;
		for (const Index i : members_)
			extent = std::max(extent, (smooth_[at(i)] - center).norm());
		if (!(extent > 0))
			return -1;
		const double scale = 1 / extent;
		Gram gram = Gram::Zero();
		Terms moments = Terms::Zero();
		double energy = 0;
		for (const Index i : members_) {
			const Point node = scale * (smooth_[at(i)] - center);
			const double x = node.dot(tangent);
			const double y = node.dot(bitangent);
			const double height = (noisy_[at(i)] - center).dot(normal);
			Terms terms;
			terms << 1, x, y, x * x, x * y, y * y;
			gram.selfadjointView<Eigen::Lower>().rankUpdate(terms);
			moments += height * terms;
			energy += height * height;
		}
		const Eigen::LLT<Gram> cholesky(gram);
		if (cholesky.info() != Eigen::Success || !(cholesky.rcond() > LEAST_CONDITION))
			return -1;
		const Terms solved = cholesky.matrixL().solve(moments);
		return std::max(0.0, energy - solved.squaredNorm()) /
			   static_cast<double>(members_.size() - TERMS);
	}

	// Nodes nearly on a conic do not fix a quadratic.
	static constexpr double LEAST_CONDITION = 1e-8;

	const Workspace& workspace_;
	const std::vector<Point>& noisy_;
	const std::vector<Point>& smooth_;
	VertexRings ring_;
	std::vector<Index> members_;
	/// The vertex each was last collected for.
	std::vector<Index> stamps_;
};

// How noise across the normals lengthens edges, per square of it in edge lengths: an edge takes
// half of the noise of both ends across itself, 2 / 2, and a little more in the next order.
constexpr double LENGTHENING = 1.2;

// The quantile of the mean of squares over so many degrees of freedom, for noise of variance one
// (Wilson and Hilferty 1931).
double quantile_of_variance(const Quantile& quantile, double free)
{
	const double spread = 2 / (9 * free);
	return std::pow(1 - spread + quantile.normal * std::sqrt(spread), 3);
}

// The mean edge length of the surface below the noise, whose deviation along the normals is given
// in the caller's length unit.
//
// Smoothing takes the noise out of the edges, but evens irregular triangles out and shortens the
// mean so. The noisy edges without their part along the normals keep the irregularity, and the
// noise across the normals, if there is any, lengthens them. Both err to one side then, if the
// latter are shortened by what noise in all directions would lengthen them.
double clean_edge_length(
	const Workspace& workspace,
	const std::vector<Point>& noisy,
	const std::vector<Point>& smooth,
	double sigma)
{
	std::vector<Point> flattened = noisy;
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		const Point normal = cross_product_around(workspace, smooth, static_cast<Index>(i));
		const double square = normal.squaredNorm();
		if (square > 0)
			flattened[i] += (smooth[i] - noisy[i]).dot(normal) / square * normal;
	});
	const double smoothed = mean_edge_length(workspace, smooth);
	if (!(smoothed > 0))
		return 0;
	const double relative = sigma / smoothed;
	return std::max(
		smoothed, mean_edge_length(workspace, flattened) / (1 + LENGTHENING * relative * relative));
}

// The level that so many variances tell; zero where there is none.
double level(const std::vector<Variance>& variances, const Quantile& wanted)
{
	std::vector<double> values;
	for (const Variance& variance : variances) {
		if (variance.value >= 0)
			values.push_back(variance.value / quantile_of_variance(wanted, variance.free));
	}
	return std::sqrt(quantile(values, wanted.share));
}

// The mean height of the triangles around each of some vertices, over their longest sides.
std::vector<double> triangle_heights(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Index>& vertices)
{
	std::vector<double> heights(vertices.size(), 0);
	workspace.execution.for_each(static_cast<Index>(vertices.size()), [&](std::size_t i) {
		const IndexLists& around = workspace.vertex_faces;
		const Index vertex = vertices[i];
		for (const Index* it = around.begin(vertex); it != around.end(vertex); ++it) {
			const Face& face = workspace.mesh.faces[static_cast<std::size_t>(*it)];
			const double longest = std::sqrt(longest_edge_squared(positions, face));
			if (longest > 0)
				heights[i] += face_cross_product(positions, face).norm() / longest;
		}
		heights[i] /= std::max<double>(1, around.size(vertex));
	});
	return heights;
}

// Takes the variances of every so-manieth vertex away where its triangles are lower than that.
void leave_out_lower(
	const std::vector<double>& heights,
	std::size_t every,
	double least,
	std::vector<Variance>& variances)
{
	for (std::size_t i = 0; i < variances.size(); ++i) {
		if (heights[every * i] < least)
			variances[i].value = -1;
	}
}

// The height of triangles from which the variances of as many vertices tell all of the noise.
double
least_steady_height(const std::vector<double>& heights, const std::vector<Variance>& variances)
{
	std::vector<double> values = heights;
	const double largest = quantile(values, 1 - LEAST_STEADY);
	double least = 0;
	for (int round = 0; round < STEADY_ROUNDS; ++round) {
		std::vector<Variance> kept = variances;
		leave_out_lower(heights, 1, least, kept);
		least = std::min(largest, STEADY_HEIGHT * level(kept, FLAT));
	}
	return least;
}

std::vector<Variance> similar_variances(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth,
	const std::vector<Index>& sample,
	std::size_t every)
{
	std::vector<Variance> variances(sample.size() / every);
	std::vector<SimilarHeights> heights(
		static_cast<std::size_t>(workspace.execution.threads()),
		SimilarHeights(workspace, positions, smooth));
	workspace.execution.parallel_for(
		static_cast<Index>(variances.size()), GRAIN, [&](Index begin, Index end, int worker) {
			for (Index i = begin; i < end; ++i) {
				const auto at = static_cast<std::size_t>(i);
				variances[at] = heights[static_cast<std::size_t>(worker)].fit(sample[every * at]);
			}
		});
	return variances;
}

/// Of whole rings around vertices: the narrow ones, and two wider.
using VariancesByRings = std::array<std::vector<Variance>, 3>;

// The share of the noise in what the narrow rings leave, the rest being detail.
double share_of_noise(const VariancesByRings& variances)
{
	double sum = 0;
	for (const Quantile& wanted : GROWING) {
		std::array<double, 3> squares;
		for (std::size_t k = 0; k < squares.size(); ++k) {
			const double deviation = level(variances[k], wanted);
			squares[k] = deviation * deviation;
		}
		const double growth = squares[1] - GROWTH_OF_NOISE * squares[0];
		if (!(growth > 0 && squares[0] > 0)) {
			sum += 1;
			continue;
		}
		const double factor = std::max(GROWTH_OF_DETAIL, (squares[2] - squares[1]) / growth);
		sum += std::max(0.0, 1 - growth / (factor - 1) / squares[0]);
	}
	return sum / static_cast<double>(GROWING.size());
}

// How far the corner of a face is from the plane of another, over the deviation that noise of one
// everywhere would give it; negative where the other has no area or is too far off.
double height_over_plane(const std::vector<Point>& positions, const Face& plane, Index corner)
{
	const Point& a = positions[static_cast<std::size_t>(plane[0])];
	const Point ab = positions[static_cast<std::size_t>(plane[1])] - a;
	const Point ac = positions[static_cast<std::size_t>(plane[2])] - a;
	const Point to = positions[static_cast<std::size_t>(corner)] - a;
	const Point normal = ab.cross(ac);
	const double square = normal.squaredNorm();
	if (!(square > 0))
		return -1;
	const double b = to.cross(ac).dot(normal) / square;
	const double c = ab.cross(to).dot(normal) / square;
	const Eigen::Vector3d shares(1 - b - c, b, c);
	if (!(shares.lpNorm<1>() < FAR_OFF))
		return -1;
	return std::abs(to.dot(normal)) / std::sqrt(square * (1 + shares.squaredNorm()));
}

// The level that faces nearly in a plane with their neighbours allow; infinite where there are no
// neighbours.
double level_in_plane(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Index>& sample)
{
	// The corners of a face that follow the vertex: the last one first, to look faces up by.
	struct Spoke {
		Index last;
		Index next;
		Index face;
	};
	std::vector<Spoke> spokes;
	std::vector<double> heights;
	for (const Index vertex : sample) {
		spokes.clear();
		const Index* const end = workspace.vertex_faces.end(vertex);
		for (const Index* it = workspace.vertex_faces.begin(vertex); it != end; ++it) {
			const Face& face = workspace.mesh.faces[static_cast<std::size_t>(*it)];
			const auto own = std::find(face.begin(), face.end(), vertex) - face.begin();
			const auto after = [&](std::ptrdiff_t k) {
				return face[static_cast<std::size_t>((own + k) % 3)];
			};
			spokes.push_back({after(2), after(1), *it});
		}
		std::sort(spokes.begin(), spokes.end(), [](const Spoke& a, const Spoke& b) {
			return a.last != b.last ? a.last < b.last : a.face < b.face;
		});
		for (const Spoke& spoke : spokes) {
			// The face across the edge to the next corner has that one as its last.
			const auto across = std::lower_bound(
				spokes.begin(), spokes.end(), spoke.next, [](const Spoke& other, Index corner) {
					return other.last < corner;
				});
			if (across == spokes.end() || across->last != spoke.next)
				continue;
			const Face& face = workspace.mesh.faces[static_cast<std::size_t>(spoke.face)];
			const double height = height_over_plane(positions, face, across->next);
			if (height >= 0)
				heights.push_back(height);
		}
	}
	if (heights.empty())
		return std::numeric_limits<double>::infinity();
	return quantile(heights, IN_PLANE.share) / IN_PLANE.normal;
}

// The level of whole rings, or that of similar faces where it shows edges in the first; in edge
// lengths.
double level_beside_edges(double whole, double similar, double length)
{
	const double without = similar / SIMILAR_LEVEL;
	if (!(without > 0 && without < whole))
		return whole / length;
	const double share = way_between(SIMILAR_NEVER, SIMILAR_TO, without / length);
	return (whole + share * (without - whole)) / length;
}

} // namespace

NoiseLevels estimate_noise_levels(const Workspace& workspace, const std::vector<Point>& positions)
{
	const std::vector<Point> smooth = surface_below_heights(workspace, positions);
	const std::vector<Index> sample = sample_vertices(workspace, positions, SAMPLES);
	std::vector<LocalHeights> heights(
		static_cast<std::size_t>(workspace.execution.threads()),
		LocalHeights(workspace, positions, smooth));
	// Calls visit(local, i) for every so-manieth of the sample, where there is a fit.
	const auto fit_each = [&](std::size_t count, std::size_t every, int rings, auto visit) {
		workspace.execution.parallel_for(
			static_cast<Index>(count), GRAIN, [&](Index begin, Index end, int worker) {
				LocalHeights& local = heights[static_cast<std::size_t>(worker)];
				for (Index i = begin; i < end; ++i) {
					const auto at = static_cast<std::size_t>(i);
					if (local.fit(sample[every * at], rings))
						visit(local, at);
				}
			});
	};
	VariancesByRings variances;
	variances[0].resize(sample.size());
	fit_each(sample.size(), 1, RINGS, [&](const LocalHeights& local, std::size_t i) {
		variances[0][i] = {local.variance(), local.free()};
	});
	const std::size_t every = std::max<std::size_t>(1, sample.size() / WIDE_SAMPLES);
	const std::size_t wide = sample.size() / every;
	std::vector<double> ratios(wide, -1);
	for (std::size_t k = 1; k < variances.size(); ++k) {
		variances[k].resize(wide);
		const int rings = RINGS + static_cast<int>(k);
		fit_each(wide, every, rings, [&](LocalHeights& local, std::size_t i) {
			variances[k][i] = {local.variance(), local.free()};
			if (rings == WIDE_RINGS)
				ratios[i] = local.median_ratio();
		});
	}
	ratios.erase(std::remove(ratios.begin(), ratios.end(), -1), ratios.end());
	NoiseLevels result;
	if (!ratios.empty())
		result.median_ratio = quantile(ratios, 0.5);
	const std::vector<double> triangles = triangle_heights(workspace, smooth, sample);
	const double least = least_steady_height(triangles, variances[0]);
	for (std::size_t k = 0; k < variances.size(); ++k)
		leave_out_lower(triangles, k == 0 ? 1 : every, least, variances[k]);
	const double flat = level(variances[0], FLAT);
	const double length = clean_edge_length(workspace, positions, smooth, flat);
	if (length > 0) {
		const std::size_t seldom = std::max<std::size_t>(1, sample.size() / SIMILAR_SAMPLES);
		std::vector<Variance> similar =
			similar_variances(workspace, positions, smooth, sample, seldom);
		leave_out_lower(triangles, seldom, least, similar);
		const double without_edges = level(similar, SIMILAR_FLAT);
		result.rough = level_beside_edges(flat, without_edges, length);
		result.flat = result.rough;
		const double share = way_between(EDGES, NO_EDGES, without_edges / flat);
		if (share > 0) {
			const double white = std::sqrt(share_of_noise(variances)) * flat / length;
			result.flat -= share * std::max(0.0, result.rough - white);
		}
		const double in_plane = level_in_plane(workspace, positions, sample) / length;
		result.drawn = way_between(MEASURED, DRAWN, in_plane / result.flat);
		result.ordinary = level(variances[0], ORDINARY) / length;
	}
	return result;
}

double estimate_noise_level(const Workspace& workspace, const std::vector<Point>& positions)
{
	const NoiseLevels levels = estimate_noise_levels(workspace, positions);
	return (1 - levels.drawn) * levels.flat;
}

} // namespace orthopoly
