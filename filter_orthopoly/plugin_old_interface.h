// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filter.h"

#include <QObject>
#include <common/interfaces.h>

/// The filters as plugin of MeshLab 2020.09.
class FilterOrthopolyPlugin final : public QObject, public MeshFilterInterface {
	Q_OBJECT
	MESHLAB_PLUGIN_IID_EXPORTER(MESH_FILTER_INTERFACE_IID)
	Q_INTERFACES(MeshFilterInterface)

public:
	FilterOrthopolyPlugin();

	QString pluginName() const override;
	QString filterName(FilterIDType id) const override;
	QString filterInfo(FilterIDType id) const override;
	FilterClass getClass(QAction* action) override;
	FILTER_ARITY filterArity(QAction* action) const override;
	int postCondition(QAction* action) const override;
	void initParameterSet(
		QAction* action, MeshDocument& document, RichParameterList& parameters) override;
	bool applyFilter(
		QAction* action,
		MeshDocument& document,
		const RichParameterList& parameters,
		vcg::CallBackPos* callback) override;

private:
	const orthopoly::Filter& filter_of(QAction* action) const;

	// What the filter may change in the document whose parameters were asked for last, or what it
	// has changed if it has been applied since. The host asks for both by postCondition().
	int changed_;
};
