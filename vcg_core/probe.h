// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "deviations.h"
#include "workspace.h"

#include <vector>

namespace orthopoly {

/// Tells how far a method follows the noise of a mesh.
///
/// The method is run again with a little noise more, whose signs are known: how far its result goes
/// along with these is the trace of its response, which is what estimates of its error need to tell
/// the noise that it left from detail (Stein 1981; Ramani, Blu, Unser 2008).
class Probe {
public:
	/// @param workspace its mesh as measured; has to outlive this
	/// @param noise     that was taken, in the caller's length unit; > 0
	/// @param positions #V denoised, whose normals the probe moves vertices along
	Probe(const Workspace& workspace, const Deviations& noise, const std::vector<Point>& positions);

	/// #V as measured, with the probe.
	std::vector<Point> with_probe() const;

	/// #V signs; zero for fixed vertices and such without a normal, which the probe leaves alone.
	const std::vector<double>& signs() const { return signs_; }
	/// #V unit normals, or zero.
	const std::vector<Point>& normals() const { return normals_; }
	/// As given.
	const Deviations& noise() const { return noise_; }
	/// A vertex's sign times its deviation, over the overall one.
	double noise_at(std::size_t vertex) const { return noise_.factor(vertex) * signs_[vertex]; }

	/// How far results of the method differ, in units of the probe's overall deviation: #V.
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
	std::vector<double> signs_;
};

} // namespace orthopoly
