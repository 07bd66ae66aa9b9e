// SPDX-License-Identifier: GPL-3.0-or-later
#include "residual_variances.h"

#include "interpolation.h"
#include "sampling.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace orthopoly {

namespace {

// From two rings to three the detail's part of what they leave grows by this factor at least, or by
// that from three to four where it is more.
constexpr double GROWTH_OF_DETAIL = 1.9;

// Growth of the variance that is not taken for that of detail: a little comes of curvature, and of
// noise that is not Gaussian.
constexpr double GROWTH_OF_NOISE = 1.1;

// The shares of the variances that are compared.
constexpr std::array<Quantile, 3> GROWING = {
	Quantile {0.1, -1.2816}, Quantile {0.2, -0.8416}, Quantile {0.35, -0.3853}};

// Between these levels, in edge lengths, the normals of the smoothed surface come to scatter as far
// as the choice of similar faces allows, and it takes noise away. It takes a little in any case.
constexpr double SIMILAR_LEVEL = 0.97;
constexpr double SIMILAR_TO = 0.33;
constexpr double SIMILAR_NEVER = 0.5;

// Below the first share of what noise of the level makes of this share of the pairs of faces there
// is none, from the second on there may be; strong noise, which bends edges less than it would were
// the surface flat, makes a third at least.
constexpr Quantile IN_PLANE = {0.2, 0.2533};
constexpr double DRAWN = 0.1;
constexpr double MEASURED = 0.25;

// A corner seen so far off the other face in its plane says more of the noise there than of the
// angle between both: sum of the sizes of its barycentric coordinates.
constexpr double FAR_OFF = 8;

// The quantile of the mean of squares over so many degrees of freedom, for noise of variance one
// (Wilson and Hilferty 1931).
double quantile_of_variance(const Quantile& quantile, double free)
{
	const double spread = 2 / (9 * free);
	return std::pow(1 - spread + quantile.normal * std::sqrt(spread), 3);
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

} // namespace

double level_of(const std::vector<ResidualVariance>& variances, const Quantile& wanted)
{
	std::vector<double> values;
	for (const ResidualVariance& variance : variances) {
		if (variance.value >= 0)
			values.push_back(variance.value / quantile_of_variance(wanted, variance.free));
	}
	return std::sqrt(quantile(values, wanted.share));
}

double level_beside_edges(double whole, double similar, double length)
{
	const double without = similar / SIMILAR_LEVEL;
	if (!(without > 0 && without < whole))
		return whole / length;
	const double share = way_between(SIMILAR_NEVER, SIMILAR_TO, without / length);
	return (whole + share * (without - whole)) / length;
}

double share_of_noise(const VariancesByRings& variances)
{
	double sum = 0;
	for (const Quantile& wanted : GROWING) {
		std::array<double, 3> squares;
		for (std::size_t k = 0; k < squares.size(); ++k) {
			const double deviation = level_of(variances[k], wanted);
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

double share_drawn(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Index>& vertices,
	double level)
{
	return way_between(MEASURED, DRAWN, level_in_plane(workspace, positions, vertices) / level);
}

} // namespace orthopoly
