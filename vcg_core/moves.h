// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "deviations.h"
#include "prefilter.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// How vertices were moved from where they were measured.
struct Moves {
	/// Back along the normals, in deviations of the noise: #V; zero where there is no normal.
	std::vector<double> lengths;
	/// #V sums of the cross products around, along the normals; zero where there is none.
	std::vector<Point> crosses;
};

/// Of the workspace's mesh from `positions` (#V) back to where it was measured. No move counts for
/// more than three deviations, so that a vertex far off, be it an outlier or moved on purpose, does
/// not make its surroundings detail.
Moves moves_along_normals(
	const Workspace& workspace, const Deviations& sigma, const std::vector<Point>& positions);

/// The same, zero for vertices on edges: those slide along the edge, which no normal of theirs
/// tells.
Moves moves_beside_edges(
	const Workspace& workspace, const Deviations& sigma, const std::vector<Point>& positions);

/// The share of a mean square that is not noise of that variance, as a Wiener filter has it: 0
/// to 1.
double share_beyond(double noise, double square);

/// Takes a vertex, unless it is fixed, that share of the way back to where it was measured.
void give_back(
	const Workspace& workspace, std::size_t vertex, double share, std::vector<Point>& positions);

/// Takes means of #V values over each vertex and its neighbours, these weighed by the faces shared,
/// so many times.
template<class Value>
void average(const Workspace& workspace, int times, std::vector<Value>& values)
{
	const std::vector<Face>& faces = workspace.mesh.faces;
	const IndexLists& around = workspace.vertex_faces;
	std::vector<Value> sums(faces.size());
	for (int k = 0; k < times; ++k) {
		workspace.execution.for_each(workspace.mesh.face_count(), [&](std::size_t i) {
			const Face& face = faces[i];
			sums[i] = values[at(face[0])] + values[at(face[1])] + values[at(face[2])];
		});
		workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
			const auto vertex = static_cast<Index>(i);
			const Index* const first = around.begin(vertex);
			const Index* const end = around.end(vertex);
			if (first == end)
				return;
			Value sum = sums[at(*first)];
			for (const Index* face = first + 1; face != end; ++face)
				sum += sums[at(*face)];
			values[i] = sum / (3.0 * static_cast<double>(end - first));
		});
	}
}

/// Means of the squares of #V values: so many averages.
std::vector<double>
mean_squares(const Workspace& workspace, int times, const std::vector<double>& values);

/// Sums value(from, to) over the edges of the faces, each edge that two faces share being met
/// twice.
template<class Value>
double sum_over_edges(const Workspace& workspace, const Value& value)
{
	const std::vector<Face>& faces = workspace.mesh.faces;
	return workspace.execution.sum(workspace.mesh.face_count(), [&](Index index) {
		const Face& face = faces[at(index)];
		double sum = 0;
		for (std::size_t k = 0; k < 3; ++k)
			sum += value(at(face[k]), at(face[(k + 1) % 3]));
		return sum;
	});
}

/// Keeps what is broad of #V values: so many pairs of Taubin's filter (see prefilter.h).
template<class Value>
void low_pass(
	const Workspace& workspace,
	int pairs,
	std::vector<Value>& values,
	double inflate = TAUBIN_INFLATE)
{
	for (int pair = 0; pair < pairs; ++pair) {
		for (const double step : {TAUBIN_SHRINK, inflate}) {
			std::vector<Value> means = values;
			average(workspace, 1, means);
			// Of the mean's three thirds the vertex itself is one.
			workspace.execution.for_each(workspace.mesh.vertex_count(), [&](std::size_t i) {
				values[i] += 1.5 * step * (means[i] - values[i]);
			});
		}
	}
}

} // namespace orthopoly
