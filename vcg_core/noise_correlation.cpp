// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_correlation.h"

#include "interpolation.h"
#include "local_heights.h"
#include "sampling.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace orthopoly {

namespace {

// A factor: 0 up to (or from) one end, 1 from (or up to) the other.
struct Ramp {
	double zero;
	double one;

	double operator()(double value) const { return way_between(zero, one, value); }
};

// Irregularity of the view. Depth images in perspective have 0.2, a jittered grid as well; the
// visible half of a closed model hardly less than 0.4, and mostly 0.6.
constexpr Ramp ONE_VIEW = {0.40, 0.25};

// Share of the edges that are on a grid, and of those near it. Marching cubes leave 0.19 to 0.4 on
// it, other noisy meshes less than 0.04; moving least squares leave 0.06 to 0.2 near it.
constexpr Ramp ON_VOXELS = {0.08, 0.14};
constexpr Ramp NEAR_VOXELS = {0.05, 0.08};

// Correlation along edges over the flattest places. White noise gives 0.05 by chance and curvature,
// a depth camera 0.25, white noise smoothed by a few umbrella steps 0.16 to 0.5.
constexpr Ramp CORRELATED = {0.13, 0.20};

// The same where vertices are as marching cubes left them, so that none has noise of its own: 0.12
// to 0.5.
constexpr Ramp CORRELATED_ON_VOXELS = {0.06, 0.12};

// The same of noise that goes together over an edge or two (values of a volume that are off each by
// itself) and of noise that does over many (reconstructions of points). That of depth cameras does
// as well, but vertices have some of their own, which lowers the correlation.
constexpr Ramp FAR_REACHING = {0.28, 0.52};

// Residual of wide polynomials over that of narrow ones. Noise correlated over a few edges
// gives 1.1 to 1.8; waves and edges of the surface itself 2 and far more, but so does smoother
// noise.
constexpr Ramp SLOW_GROWTH = {2.2, 1.8};

// Residual of middle polynomials over that of narrow ones, of noise in a volume: 1.1 to 1.6 where
// it is worth removing, whether it is correlated over one edge (white noise in a volume) or four
// (reconstructions of points), clean volumes 1.6 and mostly more.
constexpr Ramp SLOW_GROWTH_OF_VOXELS = {1.7, 1.6};

// What wide polynomials leave at an ordinary place over what they leave in the flattest ones. Where
// it is much more, structures that wide would take away more of the surface than of the noise.
constexpr Ramp EVEN = {1.9, 1.5};

// Strength from which correlated noise is worse than the loss of detail in wide structures.
constexpr Ramp STRONG = {0.10, 0.25};

// The same of a volume, by narrow polynomials: structures are not that wide there. Clean smooth
// ones leave up to 0.02. Noise of more than half an edge over several of them would leave no
// surface to extract; coarse drawn boxes have so much.
constexpr Ramp STRONG_IN_VOXELS = {0.025, 0.045};
constexpr Ramp NOT_TOO_STRONG = {0.55, 0.48};

// Where nothing shows where a mesh comes from. The power of the rings that residuals rise by from
// two rings to four: 0.2 to 0.45 of white noise on smooth surfaces and up to 0.8 on fine detail,
// 0.65 to 1.2 of noise that was smoothed, remeshed or decimated, more of clean meshes (2 and more
// where their grooves are a few edges wide and end there, as noise does). From four to eight: 0.1
// to 0.7 of white noise, 0.3 to 0.8 of smoothed one, 0.9 and far more of clean meshes. The second
// is less than the first by 0.3 to 0.8 where noise was smoothed, by 0.25 at most where it is white.
constexpr Ramp RISES = {0.60, 0.75};
constexpr Ramp NOT_STEEPLY = {1.60, 1.30};
constexpr Ramp NO_FURTHER = {0.85, 0.70};
constexpr Ramp BENDS = {0.25, 0.40};

// Strength from which such noise is one: reconstructions of points whose directions are off have
// ripples of 0.012 to 0.026, which are seen on flat faces. Of 319 clean meshes (as drawn,
// decimated, smoothed, subdivided or remeshed) two rise so at all, at 0.009 and 0.013.
constexpr Ramp STRONG_BY_RISE = {0.006, 0.012};

// Noise of 0.25 leaves 0.15 once it was smoothed, noise of half an edge less than 0.3. More is
// features of a coarse mesh, a few edges wide, beyond which residuals do not rise either.
constexpr Ramp BELOW_FEATURES = {0.32, 0.24};

// Noise that was smoothed more, by three to six umbrella steps or ten pairs of Taubin smoothing,
// rises like detail up to four rings (by 1.4 to 2.3) and bends by 0.6 and more; its correlation
// along edges is 0.43 and more. Of clean meshes some look like that, but what narrow polynomials
// leave of noise is nearly the same in the flattest fifth of the places as in the flattest tenth:
// 1.1 to 1.17 times it, of those meshes 1.29 times and more, or they leave as much as features do.
// Of 685 clean ones a knot extracted anew is left, by a third.
constexpr Ramp RISES_STEEPLY = {1.20, 1.40};
constexpr Ramp NOT_STEEPEST = {2.60, 2.35};
constexpr Ramp BENDS_CLEARLY = {0.54, 0.64};
constexpr Ramp CORRELATED_CLEARLY = {0.32, 0.42};
constexpr Ramp ALIKE = {1.19, 1.16};
constexpr Ramp STRONG_BY_STEEP_RISE = {0.012, 0.020};
constexpr Ramp WELL_BELOW_FEATURES = {0.22, 0.17};

// Where a surface bends as much as a torus, horns and faces do, or has edges near most places, wide
// polynomials see it and residuals go on rising. Those of three rings hardly do: what they leave of
// noise that 3 to 10 pairs of Taubin smoothing went over is nearly the same everywhere, 1.26 to
// 1.45 times as much at an ordinary place as in the flattest tenth, or beside edges at least in the
// flattest fifth, 1.07 to 1.13 times, up to 1.19 after ten pairs. It goes together along edges
// (0.14 to 0.28; white noise 0.01, on fine detail 0.1). From three rings to four it rises by less
// than from two to three, two thirds of that power and up to 0.14; relief of all widths by 0.2 more
// than two thirds. Of 817 clean meshes blade reconstructed anew has all of it, a sphere remeshed by
// half and elk extracted anew and decimated by 0.4; a smoothed scan and a bull remeshed come close
// with 1.19 and 1.17 in the flattest fifth. Four to eight rings say how much there is beside noise:
// from a power of two on, structures as wide would take away more of the shape.
constexpr Ramp ALIKE_EVERYWHERE = {1.50, 1.40};
constexpr Ramp ALIKE_NEAR = {1.17, 1.13};
constexpr Ramp CORRELATED_NEAR = {0.110, 0.135};
constexpr Ramp RISES_NEAR = {0.85, 1.00};
constexpr Ramp NOT_STEEPEST_NEAR = {2.50, 2.30};
constexpr Ramp BENDS_NEAR = {0.22, 0.14};
constexpr Ramp MOSTLY_NOISE = {2.00, 1.75};
constexpr Ramp STRONG_NEAR = {0.012, 0.020};
constexpr Ramp BELOW_FEATURES_NEAR = {0.20, 0.16};

// How far noise that is found so is taken to go together: where residuals go on rising, a part of
// what wide structures see is the shape's. Of ten meshes 0.5 leaves 0.83 of the angles of before
// and 0.86 of the vertex error, 0.7 leaves 0.71 and 0.79, 0.9 leaves 0.64 and 0.80, all of it 0.63
// and 0.84, and more than the noise on detailed ones.
constexpr double SHARE_ANYWHERE = 0.8;

// Where it can be tried out what a run for such noise takes, residuals need not be alike, and those
// of many rings may be the shape's; nor do they have to rise quite as those of noise on plain
// ground. Faint ripples of reconstructed points go together a little less. What is taken of noise
// goes together by 0.3 to 0.75, rough ground as far or further.
constexpr Ramp HARDLY_STEEPER_NEAR = {2.55, 2.40};
constexpr Ramp HARDLY_STRAIGHTER_NEAR = {0.26, 0.20};
constexpr Ramp HARDLY_FAINT_NEAR = {0.008, 0.013};
constexpr Ramp RIPPLES = {0.060, 0.045};
constexpr Ramp CORRELATED_RIPPLES = {0.070, 0.088};
constexpr Ramp TAKEN_TOGETHER = {0.20, 0.28};
constexpr Ramp NOT_ALTOGETHER = {0.80, 0.72};

// Noise that one or two pairs of Taubin smoothing went over goes together but a little, in what is
// taken (0.09 to 0.16 and 0.24 to 0.32; white noise up to 0.03 where it is taken alike) as in the
// residuals (0.04 to 0.08 and 0.09 to 0.13), which rise up to three rings by 0.62 to 1.0 and then
// by less than two thirds of that; those of white noise do by 0.4 to 0.6. On detail that is the
// same all over they rise by more, go together and are taken alike; but then they rise further,
// too: by 0.03 more than two thirds where there are bumps of six edges, by 0.07 and more on rough
// ground.
constexpr Ramp RISES_A_LITTLE = {0.60, 0.64};
constexpr Ramp NOT_CLEARLY = {1.25, 1.05};
constexpr Ramp BENDS_A_LITTLE = {0.05, 0.01};
constexpr Ramp HARDLY_FURTHER = {1.50, 1.30};
constexpr Ramp CORRELATED_A_LITTLE = {0.030, 0.038};
constexpr Ramp BELOW_FEATURES_SLIGHTLY = {0.36, 0.31};
constexpr Ramp TAKEN_A_LITTLE_TOGETHER = {0.08, 0.10};
constexpr Ramp NO_MORE_TOGETHER = {0.36, 0.31};

// White noise that is taken for correlated by a little is worse off than the other way round.
constexpr Ramp MORE_THAN_A_LITTLE = {0.2, 1.0};

// What the deviation is more than middle polynomials leave, per squared correlation along edges.
// They leave 0.9 of noise that an umbrella step smoothed, whose correlation is 0.2, 0.73 to 0.9 of
// what two did, or three pairs of Taubin smoothing, where it is 0.35, and 0.6 to 0.7 where it is
// 0.5.
constexpr double FOLLOWED = 1.8;

// Rings of vertices of the narrowest, the narrow, the middle and the wide polynomials, and of those
// whose residuals are correlated: wide enough to leave what is correlated over several edges in the
// residual.
constexpr int NARROWEST_RINGS = 2;
constexpr int NEAR_RINGS = 3;
constexpr int NARROW_RINGS = 4;
constexpr int CORRELATED_RINGS = 5;
constexpr int MIDDLE_RINGS = 6;
constexpr int WIDE_RINGS = 8;

// The share of places that counts as the flattest.
constexpr double FLATTEST = 0.2;

// The same where polynomials that see more of the surface tell noise from it.
constexpr double VERY_FLATTEST = 0.1;

// So many polynomials reach every place of an ordinary mesh several times.
constexpr Index SAMPLES = 1500;

// But a mesh that has fewer has no place where the wide ones do not see everything.
constexpr std::size_t FEWEST_SAMPLES = 600;

constexpr Index GRAIN = 32;

/// What is measured around a vertex; negative variances where there is no polynomial.
struct Residuals {
	double narrowest = -1;
	double near = -1;
	double narrow = -1;
	double correlated = -1;
	double middle = -1;
	double wide = -1;
	double correlation = 0;
	double near_correlation = 0;
};

double deviation(LocalHeights& heights, Index vertex, int rings)
{
	return heights.fit(vertex, rings) ? std::sqrt(heights.variance()) : -1;
}

// The residual deviation at a share of the places that have a polynomial, those in order; zero
// without any.
double at_share(const std::vector<Residuals>& found, double Residuals::*deviation, double share)
{
	std::vector<double> values;
	values.reserve(found.size());
	for (const Residuals& residuals : found) {
		if (residuals.*deviation >= 0)
			values.push_back(residuals.*deviation);
	}
	return values.empty() ? 0 : quantile(values, share);
}

// The power of the rings that the residual deviation in the flattest tenth of the places rises by.
// None where a clean mesh leaves none.
double rise(
	const std::vector<Residuals>& found,
	double Residuals::*few,
	int few_rings,
	double Residuals::*many,
	int many_rings)
{
	const double from = at_share(found, few, VERY_FLATTEST);
	const double to = at_share(found, many, VERY_FLATTEST);
	if (!(from > 0 && to > 0))
		return 0;
	return std::log(to / from) / std::log(static_cast<double>(many_rings) / few_rings);
}

double first_rise(const std::vector<Residuals>& found)
{
	return rise(found, &Residuals::narrowest, NARROWEST_RINGS, &Residuals::narrow, NARROW_RINGS);
}

double near_rise(const std::vector<Residuals>& found)
{
	return rise(found, &Residuals::narrowest, NARROWEST_RINGS, &Residuals::near, NEAR_RINGS);
}

// The mean over the flattest places, as that deviation tells them.
double mean_in_flattest(
	const std::vector<Residuals>& found, double Residuals::*deviation, double Residuals::*value)
{
	const double flattest = at_share(found, deviation, FLATTEST);
	double sum = 0;
	double count = 0;
	for (const Residuals& residuals : found) {
		if (residuals.*deviation >= 0 && residuals.*deviation <= flattest) {
			sum += residuals.*value;
			count += 1;
		}
	}
	return count > 0 ? sum / count : 0;
}

double irregularity_of_view(const std::vector<Point>& positions, const std::vector<Face>& faces)
{
	// The view w (direction over mean area) for which the areas a.w of all faces are closest to 1.
	// The scale keeps the squares of areas within a double's range.
	const double edge = mean_edge_length(positions, faces);
	if (!(edge > 0))
		return 1;
	Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
	Point sum = Point::Zero();
	for (const Face& face : faces) {
		const Point area = face_cross_product(positions, face) / (edge * edge);
		squares += area * area.transpose();
		sum += area;
	}
	const auto count = static_cast<double>(faces.size());
	const Point view = squares.completeOrthogonalDecomposition().solve(sum);
	return std::sqrt(std::max(0.0, 1 - view.dot(sum) / count));
}

NoiseCorrelation::Near near_of(const std::vector<Residuals>& found, double edge_length)
{
	const double near = at_share(found, &Residuals::near, VERY_FLATTEST);
	NoiseCorrelation::Near result;
	if (!(near > 0))
		return result;
	result.level = near / edge_length;
	result.spread = at_share(found, &Residuals::near, FLATTEST) / near;
	result.unevenness = at_share(found, &Residuals::near, 0.5) / near;
	result.edge_correlation =
		mean_in_flattest(found, &Residuals::near, &Residuals::near_correlation);
	result.rise = near_rise(found);
	result.next_rise = rise(found, &Residuals::near, NEAR_RINGS, &Residuals::narrow, NARROW_RINGS);
	return result;
}

} // namespace

double NoiseCorrelation::Near::bend() const
{
	// Of the power of three rings, what noise leaves to four.
	return next_rise - 2.0 / 3 * rise;
}

double NoiseCorrelation::certainty() const
{
	const double camera = ONE_VIEW(view_irregularity) * EVEN(unevenness) * STRONG(level);
	const double volume = SLOW_GROWTH_OF_VOXELS(middle_growth) * STRONG_IN_VOXELS(narrow_level) *
						  NOT_TOO_STRONG(narrow_level);
	const double on_voxels = ON_VOXELS(voxels.on) * volume * CORRELATED_ON_VOXELS(edge_correlation);
	// What is only near a grid may be a coarse box with white noise, that its edges grow in.
	const double elsewhere = std::max(camera, NEAR_VOXELS(voxels.near) * volume);
	return std::max(on_voxels, elsewhere * CORRELATED(edge_correlation) * SLOW_GROWTH(growth));
}

NoiseCorrelation::ByRise NoiseCorrelation::by_rise() const
{
	const double bend = first_rise - further_rise;
	const double little = RISES(first_rise) * NOT_STEEPLY(first_rise) * NO_FURTHER(further_rise) *
						  BENDS(bend) * STRONG_BY_RISE(middle_level) * BELOW_FEATURES(middle_level);
	const double more = RISES_STEEPLY(first_rise) * NOT_STEEPEST(first_rise) * BENDS_CLEARLY(bend) *
						CORRELATED_CLEARLY(edge_correlation) * ALIKE(narrow_spread) *
						STRONG_BY_STEEP_RISE(middle_level) * WELL_BELOW_FEATURES(middle_level);
	const double anywhere = std::max(ALIKE_EVERYWHERE(near.unevenness), ALIKE_NEAR(near.spread)) *
							CORRELATED_NEAR(near.edge_correlation) * RISES_NEAR(near.rise) *
							NOT_STEEPEST_NEAR(near.rise) * BENDS_NEAR(near.bend()) *
							MOSTLY_NOISE(further_rise) * STRONG_NEAR(near.level) *
							BELOW_FEATURES_NEAR(near.level);
	return {
		std::max({little, more, anywhere}), std::max({little, more, SHARE_ANYWHERE * anywhere})};
}

double NoiseCorrelation::looks_smoothed() const
{
	const double correlated = std::max(
		CORRELATED_NEAR(near.edge_correlation),
		RIPPLES(near.level) * CORRELATED_RIPPLES(near.edge_correlation));
	return correlated * RISES_NEAR(near.rise) * HARDLY_STEEPER_NEAR(near.rise) *
		   HARDLY_STRAIGHTER_NEAR(near.bend()) * HARDLY_FAINT_NEAR(near.level) *
		   BELOW_FEATURES_NEAR(near.level);
}

double NoiseCorrelation::looks_hardly_smoothed() const
{
	return CORRELATED_A_LITTLE(near.edge_correlation) * RISES_A_LITTLE(near.rise) *
		   NOT_CLEARLY(near.rise) * BENDS_A_LITTLE(near.bend()) * HARDLY_FURTHER(further_rise) *
		   STRONG_NEAR(near.level) * BELOW_FEATURES_SLIGHTLY(near.level);
}

double NoiseCorrelation::worth_trying() const
{
	return std::max(looks_smoothed(), looks_hardly_smoothed());
}

double NoiseCorrelation::by_trial(const CorrelatedMoves& taken) const
{
	const double clearly =
		TAKEN_TOGETHER(taken.edge_correlation) * NOT_ALTOGETHER(taken.edge_correlation);
	const double slightly =
		TAKEN_A_LITTLE_TOGETHER(taken.edge_correlation) * NO_MORE_TOGETHER(taken.edge_correlation);
	const double together =
		std::max(clearly * looks_smoothed(), slightly * looks_hardly_smoothed());
	return MORE_THAN_A_LITTLE(taken.are_alike() * together);
}

double NoiseCorrelation::is_of_voxels() const
{
	return std::max(ON_VOXELS(voxels.on), NEAR_VOXELS(voxels.near));
}

double NoiseCorrelation::deviation() const
{
	const double correlation = std::max(0.0, edge_correlation);
	return (1 + FOLLOWED * correlation * correlation) * middle_level;
}

double NoiseCorrelation::reach() const
{
	return std::max(ONE_VIEW(view_irregularity), FAR_REACHING(edge_correlation));
}

NoiseCorrelation measure_noise_correlation(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth,
	bool in_any_case)
{
	NoiseCorrelation result;
	result.view_irregularity = irregularity_of_view(positions, workspace.mesh.faces);
	result.voxels = voxel_shares(workspace, positions);
	const bool shows_origin = ONE_VIEW(result.view_irregularity) > 0 || result.is_of_voxels() > 0;
	const std::vector<Index> sample = sample_vertices(workspace, positions, SAMPLES);
	std::vector<Residuals> found(sample.size());
	std::vector<LocalHeights> heights(
		static_cast<std::size_t>(workspace.execution.threads()),
		LocalHeights(workspace, positions, smooth));
	const auto measure = [&](const auto& measure_at) {
		workspace.execution.parallel_for(
			static_cast<Index>(sample.size()), GRAIN, [&](Index begin, Index end, int worker) {
				for (Index k = begin; k < end; ++k) {
					const auto place = static_cast<std::size_t>(k);
					measure_at(
						heights[static_cast<std::size_t>(worker)], sample[place], found[place]);
				}
			});
	};
	measure([](LocalHeights& local, Index vertex, Residuals& residuals) {
		residuals.narrowest = deviation(local, vertex, NARROWEST_RINGS);
		residuals.near = deviation(local, vertex, NEAR_RINGS);
		if (residuals.near >= 0)
			residuals.near_correlation = local.edge_correlation();
		residuals.narrow = deviation(local, vertex, NARROW_RINGS);
	});
	const bool rises = RISES(first_rise(found)) > 0 || RISES_A_LITTLE(near_rise(found)) > 0;
	if (!in_any_case && !shows_origin && !rises)
		return result;
	measure([](LocalHeights& local, Index vertex, Residuals& residuals) {
		residuals.correlated = deviation(local, vertex, CORRELATED_RINGS);
		if (residuals.correlated >= 0)
			residuals.correlation = local.edge_correlation();
		residuals.middle = deviation(local, vertex, MIDDLE_RINGS);
		residuals.wide = deviation(local, vertex, WIDE_RINGS);
	});
	found.erase(
		std::remove_if(
			found.begin(),
			found.end(),
			[](const Residuals& r) {
				return std::min({r.narrow, r.correlated, r.middle, r.wide}) < 0;
			}),
		found.end());
	if (found.size() < FEWEST_SAMPLES)
		return result;

	const double narrow = at_share(found, &Residuals::narrow, FLATTEST);
	const double wide = at_share(found, &Residuals::wide, FLATTEST);
	result.edge_correlation =
		mean_in_flattest(found, &Residuals::correlated, &Residuals::correlation);
	if (!(narrow > 0 && wide > 0))
		return result;
	result.growth = wide / narrow;
	result.middle_growth = at_share(found, &Residuals::middle, FLATTEST) / narrow;
	result.unevenness = at_share(found, &Residuals::wide, 0.5) / wide;
	result.first_rise = first_rise(found);
	result.further_rise =
		rise(found, &Residuals::narrow, NARROW_RINGS, &Residuals::wide, WIDE_RINGS);
	result.narrow_spread = narrow / at_share(found, &Residuals::narrow, VERY_FLATTEST);
	const double edge = mean_edge_length(workspace, smooth);
	result.near = near_of(found, edge);
	result.level = wide / edge;
	result.narrow_level = narrow / edge;
	result.middle_level = at_share(found, &Residuals::middle, VERY_FLATTEST) / edge;
	return result;
}

} // namespace orthopoly
