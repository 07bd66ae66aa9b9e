// SPDX-License-Identifier: GPL-3.0-or-later
#include "uneven_noise.h"

#include "axis_noise.h"
#include "interpolation.h"
#include "local_heights.h"
#include "noise_level.h"
#include "sampling.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace orthopoly {

namespace {

// Places that a level is read at, and the vertices that it is read off. The level of so few is off
// by a tenth, but places are averaged, and a border between noisy and clean parts is found to half
// their width.
constexpr Index PLACES = 512;
constexpr std::size_t NEAREST = 40;

// One place in so many tells whether there is anything to look for.
constexpr std::size_t FIRST_LOOK = 4;

// Vertices turned away from a place are farther, since what a scanner sees at another angle has
// other noise: by as many widths of the place as the difference of the normals times this. The
// nearest ones are looked for among so many times as many that are nearest in space.
constexpr double TURN = 2;
constexpr std::size_t CANDIDATES = 10 * NEAREST;

// Vertices from which there are places enough to differ.
constexpr std::size_t FEWEST_VERTICES = 1500;

// The levels that are compared: the share of the vertices below the low and above the high one.
// Where these differ by the first factor it may be what the mesh is like, by the second it hardly
// is.
constexpr double LOW = 0.1;
constexpr double HIGH = 0.9;
constexpr double EVEN = 2;
constexpr double UNEVEN = 2.6;

// Share of the higher levels that has to be noise, and from which there is no doubt of it: detail
// differs from place to place as well.
constexpr double DETAILED = 0.7;
constexpr double WHITE = 0.85;

// Outliers are here and there, and not evenly so: the median ratio of the residuals up to which
// they make the noise (it is 0.66 at most where half of the vertices are some), and from which they
// do not (0.83 at least where half of a mesh is clean).
constexpr double OUTLYING = 0.67;
constexpr double INLYING = 0.75;

// With less certainty levels would differ by a tenth at most, which is nothing to tell of.
constexpr double LEAST_CERTAINTY = 0.1;

// No level is less than this part of the overall one: what is so much smoother than the rest is
// left alone anyway, and variances do not reach zero.
constexpr double LEAST_FACTOR = 0.1;

/// A place that a level is read at.
struct Place {
	Point position = Point::Zero();
	Point normal = Point::Zero();
	Index component = 0;
	/// Distance to the farthest vertex of the nearest in space, squared.
	double square_radius = 0;
	/// In mean edge lengths; negative where there is none.
	double level = -1;
};

/// The places that levels are read at, and the levels between them.
class Places {
public:
	Places(
		const Workspace& workspace,
		const std::vector<Point>& positions,
		const std::vector<Point>& smooth,
		const std::vector<Point>& normals,
		const NoiseSample& sample) :
			workspace_(workspace),
			smooth_(smooth), normals_(normals), sample_(sample),
			components_(number_components(workspace.mesh.faces, workspace.vertex_faces).numbers)
	{
		std::vector<double> areas;
		areas.reserve(sample.vertices.size());
		for (const Index vertex : sample.vertices)
			areas.push_back(area_around(workspace, positions, vertex));
		std::vector<std::size_t> numbers = subsample_by_value(areas, PLACES);
		// So that one in so many are the same ones however the mesh lies.
		std::sort(numbers.begin(), numbers.end(), [&](std::size_t a, std::size_t b) {
			return areas[a] < areas[b];
		});
		for (const std::size_t k : numbers) {
			const std::size_t vertex = at(sample.vertices[k]);
			places_.push_back({smooth[vertex], normals[vertex], components_[vertex]});
		}
	}

	/// Reads the levels at one place in so many, where that has not been done.
	void read(std::size_t one_in)
	{
		const auto count = static_cast<Index>((places_.size() + one_in - 1) / one_in);
		workspace_.execution.parallel_for(count, 1, [&](Index begin, Index end, int) {
			std::vector<Candidate> nearest;
			for (Index k = begin; k < end; ++k) {
				Place& place = places_[one_in * at(k)];
				if (place.level < 0)
					read(place, nearest);
			}
		});
	}

	/// Those that were read.
	std::vector<double> levels() const
	{
		std::vector<double> levels;
		for (const Place& place : places_) {
			if (place.level >= 0)
				levels.push_back(place.level);
		}
		return levels;
	}

	/// The level at a vertex: the mean of the places around it, those of its component if that has
	/// any. Zero where there are none.
	double level_at(Index vertex) const
	{
		const double level = level_at(vertex, components_[at(vertex)]);
		return level > 0 ? level : level_at(vertex, ANY);
	}

private:
	/// A squared distance and a number within the sample.
	using Candidate = std::pair<double, std::size_t>;

	static constexpr Index ANY = -1;

	// The same by the places of a component.
	double level_at(Index vertex, Index component) const
	{
		const Point& normal = normals_[at(vertex)];
		double sum = 0;
		double weights = 0;
		for (const Place& place : places_) {
			const bool is_asked = component == ANY || place.component == component;
			if (!(is_asked && place.level >= 0 && place.square_radius > 0))
				continue;
			const double away = (smooth_[at(vertex)] - place.position).squaredNorm();
			const double turned = (normal - place.normal).squaredNorm();
			const double relative = 1 + away / place.square_radius + TURN * TURN * turned;
			const double weight = 1 / (relative * relative * relative);
			sum += weight * place.level;
			weights += weight;
		}
		return weights > 0 ? sum / weights : 0;
	}

	// Leaves the nearest of some candidates; returns the distance of the farthest of them.
	static double keep_nearest(std::size_t count, std::vector<Candidate>& candidates)
	{
		if (candidates.empty())
			return 0;
		const std::size_t kept = std::min(count, candidates.size());
		const auto last = candidates.begin() + static_cast<std::ptrdiff_t>(kept - 1);
		std::nth_element(candidates.begin(), last, candidates.end());
		const double distance = last->first;
		candidates.resize(kept);
		return distance;
	}

	// The variances at the nearest of the candidates that have any.
	static std::vector<ResidualVariance> nearest_variances(
		std::vector<Candidate> candidates, const std::vector<ResidualVariance>& variances)
	{
		const auto has_none = [&](const Candidate& candidate) {
			return variances[candidate.second].value < 0;
		};
		candidates.erase(
			std::remove_if(candidates.begin(), candidates.end(), has_none), candidates.end());
		keep_nearest(NEAREST, candidates);
		std::vector<ResidualVariance> found;
		found.reserve(candidates.size());
		for (const Candidate& candidate : candidates)
			found.push_back(variances[candidate.second]);
		return found;
	}

	void read(Place& place, std::vector<Candidate>& nearest) const
	{
		nearest.clear();
		for (std::size_t k = 0; k < sample_.vertices.size(); ++k) {
			const std::size_t vertex = at(sample_.vertices[k]);
			if (components_[vertex] == place.component)
				nearest.emplace_back((smooth_[vertex] - place.position).squaredNorm(), k);
		}
		// What has no more vertices says nothing of its own.
		if (nearest.size() < NEAREST)
			return;
		keep_nearest(CANDIDATES, nearest);
		std::vector<Candidate> in_space = nearest;
		place.square_radius = keep_nearest(NEAREST, in_space);
		for (Candidate& candidate : nearest) {
			const Point& normal = normals_[at(sample_.vertices[candidate.second])];
			candidate.first +=
				TURN * TURN * place.square_radius * (normal - place.normal).squaredNorm();
		}
		const std::vector<ResidualVariance> whole = nearest_variances(nearest, sample_.whole[0]);
		const std::vector<ResidualVariance> similar = nearest_variances(nearest, sample_.similar);
		if (!whole.empty())
			place.level = level_beside_edges(
				level_of(whole, FLAT), level_of(similar, SIMILAR_FLAT), sample_.edge_length);
	}

	const Workspace& workspace_;
	const std::vector<Point>& smooth_;
	const std::vector<Point>& normals_;
	const NoiseSample& sample_;
	/// #V.
	std::vector<Index> components_;
	std::vector<Place> places_;
};

/// The levels that are compared.
struct Contrast {
	double low = 0;
	double high = 0;

	// Levels below the least there is to remove are all alike.
	explicit Contrast(std::vector<double> levels) :
			low(std::max(LEAST_NOISE, quantile(levels, LOW))), high(quantile(levels, HIGH))
	{
	}
	/// How far they are further apart than features make them, 0 to 1.
	double certainty() const
	{
		return high > low ? way_between(std::log(EVEN), std::log(UNEVEN), std::log(high / low)) : 0;
	}
};

// How far what is higher than a level is noise, 0 to 1.
double certainty_of_noise(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const NoiseSample& sample,
	const std::vector<double>& levels,
	double least)
{
	VariancesByRings variances;
	std::vector<Index> vertices;
	double squares = 0;
	for (std::size_t i = 0; i < levels.size(); ++i) {
		if (levels[i] < least)
			continue;
		vertices.push_back(sample.vertices[i]);
		squares += levels[i] * levels[i];
		for (std::size_t k = 0; k < variances.size(); ++k) {
			ResidualVariance variance = sample.whole[k][i];
			variance.value /= levels[i] * levels[i];
			variances[k].push_back(variance);
		}
	}
	const double level = std::sqrt(squares / static_cast<double>(vertices.size()));
	return way_between(DETAILED, WHITE, share_of_noise(variances)) *
		   (1 - share_drawn(workspace, positions, vertices, level * sample.edge_length));
}

/// The levels that the noise would have if it were of one kind, in mean edge lengths.
struct Levels {
	double certainty = 0;
	/// #V; empty where it is not certain enough.
	std::vector<double> of_noise;
	/// What detail leaves everywhere beside it.
	double detail = 0;
};

// By what is read around places.
Levels levels_by_place(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth,
	const std::vector<Point>& normals,
	const NoiseSample& sample)
{
	Levels result;
	if (sample.vertices.size() < FEWEST_VERTICES)
		return result;
	Places places(workspace, positions, smooth, normals, sample);
	places.read(FIRST_LOOK);
	if (Contrast(places.levels()).certainty() == 0)
		return result;
	places.read(1);
	std::vector<double> levels(sample.vertices.size());
	workspace.execution.for_each(static_cast<Index>(levels.size()), [&](std::size_t i) {
		levels[i] = places.level_at(sample.vertices[i]);
	});
	const Contrast contrast(levels);
	result.certainty = contrast.certainty();
	if (result.certainty > 0)
		result.certainty *= certainty_of_noise(
			workspace, positions, sample, levels, std::sqrt(contrast.low * contrast.high));
	if (result.certainty < LEAST_CERTAINTY)
		return result;
	result.of_noise.resize(positions.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		result.of_noise[i] = places.level_at(static_cast<Index>(i));
	});
	return result;
}

// By the angles to one axis.
Levels levels_by_axis(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& normals,
	const NoiseSample& sample)
{
	const AxisNoise noise = find_axis_noise(workspace, positions, normals, sample);
	Levels result;
	result.certainty = noise.certainty;
	result.detail = noise.detail;
	if (result.certainty < LEAST_CERTAINTY)
		return result;
	result.of_noise.resize(normals.size());
	workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
		result.of_noise[i] = noise.level_along(normals[i]);
	});
	return result;
}

// How far what was read at the vertices of the sample is from the levels: mean size of the
// logarithm.
double misfit(const Levels& levels, const NoiseSample& sample)
{
	double sum = 0;
	double count = 0;
	for (std::size_t i = 0; i < sample.vertices.size(); ++i) {
		const double variance = sample.whole[0][i].value;
		const double level = levels.of_noise[at(sample.vertices[i])];
		const double square = (level * level + levels.detail * levels.detail) * sample.edge_length *
							  sample.edge_length;
		if (!(variance > 0 && square > 0))
			continue;
		sum += std::abs(std::log(variance / square));
		count += 1;
	}
	return count > 0 ? sum / count : 0;
}

} // namespace

UnevenNoise find_uneven_noise(
	const Workspace& workspace,
	const std::vector<Point>& positions,
	const std::vector<Point>& smooth,
	const NoiseSample& sample)
{
	const double without_outliers = way_between(OUTLYING, INLYING, sample.median_ratio);
	if (!(sample.edge_length > 0) || without_outliers == 0)
		return {};
	const std::vector<Point> normals = vertex_normals(workspace, smooth);
	Levels by_place = levels_by_place(workspace, positions, smooth, normals, sample);
	Levels by_axis = levels_by_axis(workspace, positions, normals, sample);
	UnevenNoise result;
	result.certainty = without_outliers * std::max(by_place.certainty, by_axis.certainty);
	if (result.certainty < LEAST_CERTAINTY)
		return {};
	const bool is_axis =
		by_place.of_noise.empty() ||
		(!by_axis.of_noise.empty() && misfit(by_axis, sample) < misfit(by_place, sample));
	std::vector<double>& factors = result.factors;
	factors = std::move(is_axis ? by_axis.of_noise : by_place.of_noise);
	// Of the vertices that were asked: others may be fixed, and have any noise.
	double squares = 0;
	for (const Index vertex : sample.vertices)
		squares += factors[at(vertex)] * factors[at(vertex)];
	result.level = std::sqrt(squares / static_cast<double>(sample.vertices.size()));
	for (double& factor : factors)
		factor = std::pow(std::max(LEAST_FACTOR, factor / result.level), result.certainty);
	return result;
}

} // namespace orthopoly
