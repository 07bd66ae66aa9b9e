// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filter.h"

#include <QObject>
#include <common/plugins/interfaces/filter_plugin.h>

/// The filters as plugin of MeshLab 2021.07 and later, and of pymeshlab.
class FilterOrthopolyPlugin final : public QObject, public FilterPlugin {
	Q_OBJECT
	MESHLAB_PLUGIN_IID_EXPORTER(FILTER_PLUGIN_IID)
	Q_INTERFACES(FilterPlugin)

public:
	FilterOrthopolyPlugin();

	QString pluginName() const override;
	QString vendor() const override;
	QString filterName(ActionIDType id) const override;
	QString pythonFilterName(ActionIDType id) const override;
	QString filterInfo(ActionIDType id) const override;
	FilterClass getClass(const QAction* action) const override;
	FilterArity filterArity(const QAction* action) const override;
	int postCondition(const QAction* action) const override;
	RichParameterList
	initParameterList(const QAction* action, const MeshDocument& document) override;
	std::map<std::string, QVariant> applyFilter(
		const QAction* action,
		const RichParameterList& parameters,
		MeshDocument& document,
		unsigned int& post_condition_mask,
		vcg::CallBackPos* callback) override;

private:
	const orthopoly::Filter& filter_of(const QAction* action) const;

	// What the filter whose parameters were asked for last may change in that document.
	int may_change_;
};
