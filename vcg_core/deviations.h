// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <algorithm>
#include <vector>

namespace orthopoly {

/// Standard deviations of the noise along the normal, in the caller's length unit: the same
/// everywhere, or a vertex's own.
class Deviations {
public:
	/// The same everywhere. Implicit, since most noise is.
	Deviations(double overall) : overall_(overall) {} // NOLINT(google-explicit-constructor)
	/// @param factors #V, of a vertex over the overall one; positive. Empty: the same everywhere.
	/// Has to outlive this.
	Deviations(double overall, const std::vector<double>& factors) :
			overall_(overall), factors_(factors.empty() ? nullptr : &factors)
	{
	}

	double overall() const { return overall_; }
	void set_overall(double sigma) { overall_ = sigma; }
	double largest() const
	{
		return factors_ != nullptr ?
				   overall_ * *std::max_element(factors_->begin(), factors_->end()) :
				   overall_;
	}

	bool differ() const { return factors_ != nullptr; }
	/// Of a vertex, over the overall one.
	double factor(std::size_t vertex) const
	{
		return factors_ != nullptr ? (*factors_)[vertex] : 1;
	}
	double operator[](std::size_t vertex) const { return overall_ * factor(vertex); }
	/// Mean square at the corners of a face.
	double square_at(const Face& face) const
	{
		double squares = 0;
		for (const Index corner : face)
			squares += factor(at(corner)) * factor(at(corner));
		return overall_ * overall_ * (squares / 3);
	}

private:
	double overall_;
	const std::vector<double>* factors_ = nullptr;
};

} // namespace orthopoly
