// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "deviations.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Tells what a method leaves of the noise of a mesh.
///
/// The method is run again on its own result with noise that is known, as much as was taken (a
/// parametric bootstrap, Efron 1979). What it leaves of that, it left of the mesh's own noise about
/// as well; and how far it goes along with the known signs is the share of the noise that it
/// follows (as in Ramani, Blu, Unser 2008, but by all of the noise at once: a method that chooses
/// follows a little more noise than there is otherwise).
class Probe {
public:
	/// @param workspace        its mesh as measured; has to outlive this
	/// @param noise            that was taken, in the caller's length unit; > 0
	/// @param positions        #V denoised, whose normals the probe moves vertices along
	/// @param edge_correlation of the noise of vertices that an edge joins; 0 for white noise
	Probe(
		const Workspace& workspace,
		const Deviations& noise,
		const std::vector<Point>& positions,
		double edge_correlation = 0);

	/// #V denoised, with the probe along the normals. Across these vertices are where they were
	/// measured, so that triangles are as uneven as they were.
	std::vector<Point> with_probe(const std::vector<Point>& positions) const;

	/// #V signs, or for noise that goes together averages of such with a mean square of 1; zero for
	/// fixed vertices and such without a normal, which the probe leaves alone.
	const std::vector<double>& draws() const { return draws_; }
	bool is_white() const { return is_white_; }
	/// #V unit normals, or zero.
	const std::vector<Point>& normals() const { return normals_; }
	/// As given.
	const Deviations& noise() const { return noise_; }
	/// A vertex's draw times its deviation, over the overall one.
	double noise_at(std::size_t vertex) const { return noise_.factor(vertex) * draws_[vertex]; }

	/// What the method leaves of the probe, in units of its overall deviation: #V.
	///
	/// @param positions #V denoised
	/// @param probed    #V the same method's result for `with_probe`
	std::vector<Point>
	responses(const std::vector<Point>& positions, const std::vector<Point>& probed) const;

	/// That of one vertex along its normal, no more than what a filter's may be.
	double bounded_response(const std::vector<Point>& responses, std::size_t vertex) const;

private:
	const Workspace& workspace_;
	Deviations noise_;
	std::vector<Point> normals_;
	std::vector<double> draws_;
	bool is_white_;
};

} // namespace orthopoly
