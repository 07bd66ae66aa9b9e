// SPDX-License-Identifier: GPL-3.0-or-later
#include "noise_filter.h"

#include "layers.h"
#include "noise.h"

#include <algorithm>
#include <cmath>

namespace orthopoly {

std::string NoiseFilter::name() const
{
	return "Gaussian Noise";
}

std::string NoiseFilter::python_name() const
{
	return "apply_coord_gaussian_noise";
}

std::string NoiseFilter::info() const
{
	return "Moves the vertices of the current layer by Gaussian noise, to see what a denoiser makes of "
		   "it: copy a clean mesh, add noise to the copy, denoise it, and compare it with the "
		   "original.<br><br>"
		   "The same mesh, parameters and seed give the same noise on every computer. Applied twice it "
		   "adds twice: choose another seed then.";
}

Menu NoiseFilter::menu() const
{
	return Menu::Smoothing;
}

bool NoiseFilter::works_on_current_layer() const
{
	return true;
}

int NoiseFilter::may_change(const MeshDocument&) const
{
	return MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
}

FilterParameters NoiseFilter::parameters(const MeshDocument& document) const
{
	FilterParameters parameters = table_parameters(noise_parameters());
	parameters.push_back(only_selected_parameter(document));
	return parameters;
}

void NoiseFilter::apply(FilterRun& run) const
{
	const NoiseOptions options = table_options(noise_parameters(), run.values);
	const VcgArrays arrays = read_current_layer(run);
	const std::vector<Point> positions = add_noise(arrays.mesh, options);

	Index moved = 0;
	double sum = 0;
	double largest = 0;
	for (std::size_t i = 0; i < positions.size(); ++i) {
		const double distance = (positions[i] - arrays.mesh.positions[i]).norm();
		moved += distance > 0 ? 1 : 0;
		sum += distance;
		largest = std::max(largest, distance);
	}
	const double mean = sum / static_cast<double>(positions.size());
	const double edge = mean_edge_length(arrays.mesh.positions, arrays.mesh.faces);
	if (moved > 0)
		write_current_layer(run, arrays, positions);
	run.log(
		"moved " + std::to_string(moved) + " of " +
		count_of(arrays.mesh.vertex_count(), "vertex", "vertices") + " by " + in_words(mean) +
		" (mean of all), " + in_words(largest) + " at most; the mean edge length was " +
		in_words(edge));
	run.outputs = {
		{"moved_vertices", static_cast<int>(moved)},
		{"mean_displacement", mean},
		{"max_displacement", largest},
		{"mean_edge_length", edge},
	};
}

} // namespace orthopoly
