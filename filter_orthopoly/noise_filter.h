// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filter.h"

namespace orthopoly {

/// Gaussian Noise: adds noise to the current layer, to try a denoiser on.
class NoiseFilter : public Filter {
public:
	std::string name() const override;
	std::string python_name() const override;
	std::string info() const override;
	Menu menu() const override;
	bool works_on_current_layer() const override;
	int may_change(const MeshDocument& document) const override;
	FilterParameters parameters(const MeshDocument& document) const override;
	void apply(FilterRun& run) const override;
};

} // namespace orthopoly
