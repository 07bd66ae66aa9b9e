// SPDX-License-Identifier: GPL-3.0-or-later
#include "ambiguity.h"

namespace orthopoly {

namespace {

constexpr int RINGS = 2;

// Normals further apart than this cosine (60 degrees) are plainly apart.
constexpr double APART = 0.5;

constexpr Index GRAIN = 512;

std::size_t at(Index index)
{
	return static_cast<std::size_t>(index);
}

// 0 for normals that agree or are apart, 1 halfway (in the cosine) between.
double doubt(double cosine)
{
	const double agreement = (cosine - APART) / (1 - APART);
	return agreement > 0 ? 4 * agreement * (1 - agreement) : 0;
}

} // namespace

std::vector<LocalAmbiguity> measure_ambiguity(
	const Workspace& workspace, const std::vector<Point>& normals, const std::vector<double>& areas)
{
	std::vector<LocalAmbiguity> result(normals.size());
	std::vector<RingCollector> rings = workspace.ring_collectors();
	workspace.execution.parallel_for(
		workspace.mesh.face_count(), GRAIN, [&](Index begin, Index end, int worker) {
			RingCollector& ring = rings[static_cast<std::size_t>(worker)];
			for (Index i = begin; i < end; ++i) {
				ring.collect(i, RINGS);
				LocalAmbiguity& local = result[at(i)];
				for (const Index j : ring.faces()) {
					local.ambiguity += doubt(normals[at(i)].dot(normals[at(j)]));
					local.mean_area += areas[at(j)];
				}
				const auto count = static_cast<double>(ring.faces().size());
				local.ambiguity /= count;
				local.mean_area /= count;
			}
		});
	return result;
}

} // namespace orthopoly
