// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filter_parameters.h"
#include "meshlab_document.h"

#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>
#include <wrap/callback.h>

namespace orthopoly {

/// Values a filter returns to a script, in the order they are reported.
using Outputs = std::vector<std::pair<std::string, std::variant<bool, int, double>>>;

/// One application of a filter: what the host gives, and what the filter leaves.
struct FilterRun {
	MeshDocument& document;
	ParameterValues values;
	/// May be null.
	vcg::CallBackPos* callback = nullptr;
	std::function<void(const std::string&)> log;

	Outputs outputs = {};
	/// MeshModel::MeshElement bits of what has changed in the current layer.
	int changed = MeshModel::MM_NONE;
};

/// The place of a filter in MeshLab's Filters menu.
enum class Menu { Smoothing, Quality };

/// A filter as every host sees it. The plugin classes only translate this.
class Filter {
public:
	virtual ~Filter() = default;

	/// Menu entry, and the name in an .mlx script.
	virtual std::string name() const = 0;
	virtual std::string python_name() const = 0;
	/// A page for the top of the dialog, in the simple HTML that MeshLab shows.
	virtual std::string info() const = 0;
	virtual Menu menu() const = 0;
	/// True where only the current layer is concerned, so that a preview can be offered.
	virtual bool works_on_current_layer() const = 0;
	/// MeshModel::MeshElement bits of what the filter may change in this document.
	virtual int may_change(const MeshDocument& document) const = 0;
	virtual FilterParameters parameters(const MeshDocument& document) const = 0;

	/// Does the work. Throws Error with a message for the user; the document is then as it was.
	virtual void apply(FilterRun& run) const = 0;
};

/// All filters of the plugin, in the order of their ids. A new one is a line here.
const std::vector<const Filter*>& filters();

/// Applies a filter for a host. Whatever goes wrong comes out as an Error with a message for the
/// user; nothing else is ever thrown.
void apply_filter(const Filter& filter, FilterRun& run);

} // namespace orthopoly
