// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filter.h"

namespace orthopoly {

/// Angular Error from Reference Mesh: measures the current layer against another and draws the
/// result.
class AngularErrorFilter : public Filter {
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
