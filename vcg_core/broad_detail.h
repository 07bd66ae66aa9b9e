// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "moves.h"
#include "probe.h"
#include "workspace.h"

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace orthopoly {

/// Gives back the detail, a few edges wide and wider, that a method took along with the noise.
///
/// A low-pass filter (Taubin 1995) of what was taken keeps such detail and a ninth of the noise.
/// What it keeps is added (Tukey's twicing) by the gain that leaves the least square error: one
/// less the share of it that is noise (Stein 1981). How much noise there is in what was taken
/// depends on how far the method follows noise itself, which it does the more the more detail it
/// keeps, and which a probe tells.
class BroadDetail {
public:
	/// @param workspace its mesh as measured; has to outlive this
	/// @param probe     of that mesh; has to outlive this
	/// @param positions #V denoised
	BroadDetail(
		const Workspace& workspace, const Probe& probe, const std::vector<Point>& positions);

	/// The share of the noise in the filter's band that the method follows, 0 to 1.
	///
	/// @param responses #V of the method to the probe
	/// @param inner     #V flags of the vertices to look at, or empty for all
	double share_followed(
		const std::vector<Point>& responses, const std::vector<std::uint8_t>& inner = {}) const;

	/// How certain it is that detail was taken at those vertices where the method follows that
	/// share of the noise, 0 to 1.
	double certainty(double share_followed, const std::vector<std::uint8_t>& inner = {}) const;

	/// Moves the positions, in place; fixed vertices stay bit for bit. O(#V); the same bits on any
	/// number of threads. Throws Cancelled.
	void give_back(double share_followed, std::vector<Point>& positions) const;

private:
	/// Where the probe says something: edges take no part.
	bool is_probed(std::size_t vertex) const
	{
		return probe_.draws()[vertex] != 0 && moves_.lengths[vertex] != 0;
	}
	/// Of the values of those vertices that have faces.
	template<class Value>
	double sum(const std::vector<std::uint8_t>& inner, const Value& value) const;

	/// Of one vertex, or means over several: products of what was taken and what is kept of
	/// it, of the probe and what is kept of that, and the square of what is kept.
	using Products = Eigen::Array3d;
	Products products(std::size_t vertex) const;
	/// The mean over those vertices, and how many have faces.
	struct Mean {
		Products products;
		double count;
	};
	Mean mean_of(const std::vector<std::uint8_t>& inner) const;
	double certainty_of(const Mean& mean, double share_followed) const;
	/// The gain that leaves the least.
	static double gain_for(const Products& products, double share_followed);

	const Workspace& workspace_;
	const Probe& probe_;
	Moves moves_;
	/// #V moves and signs that the filter keeps.
	std::vector<Eigen::Array2d> kept_;
};

} // namespace orthopoly
