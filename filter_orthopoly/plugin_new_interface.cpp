// SPDX-License-Identifier: GPL-3.0-or-later
#include "plugin_new_interface.h"

#include "rich_values.h"

#include <QAction>

// MeshLab gave its percentages another name in 2023.
#if __has_include(<common/parameters/rich_parameter/rich_percentage.h>)
using RichLength = RichPercentage;
#else
using RichLength = RichAbsPerc;
#endif

using namespace orthopoly;

namespace {

// The last argument puts a parameter behind the arrow of the dialog.
template<class Rich, class... Values>
void add(RichParameterList& list, const FilterParameter& p, const Values&... values)
{
	list.addParam(Rich(text(p.name), values..., text(p.label), text(p.tooltip), p.advanced));
}

void add_parameter(const FilterParameter& p, const MeshDocument& document, RichParameterList& list)
{
	const auto number = static_cast<Scalarm>(p.default_value);
	const auto whole = static_cast<int>(p.default_value);
	if (p.input == FilterParameter::Input::Layer)
		return add<RichMesh>(list, p, static_cast<unsigned int>(whole), &document);
	if (p.input == FilterParameter::Input::Length)
		return add<RichLength>(list, p, number, Scalarm(0), static_cast<Scalarm>(p.full_length));
	switch (p.type) {
	case ParameterType::Boolean: return add<RichBool>(list, p, whole != 0);
	case ParameterType::Integer: return add<RichInt>(list, p, whole);
	case ParameterType::Choice: return add<RichEnum>(list, p, whole, choices(p));
	case ParameterType::Real: return add<RichFloat>(list, p, number);
	}
}

ParameterValues
read_values(const Filter& filter, const RichParameterList& list, MeshDocument& document)
{
	ParameterValues values;
	for (const FilterParameter& parameter : filter.parameters(document)) {
		const QString name = text(parameter.name);
		// A script may leave parameters out.
		const bool given = list.hasParameter(name);
		if (parameter.input == FilterParameter::Input::Layer)
			values.layers[parameter.name] = document.getMesh(
				given ? list.getMeshId(name) : static_cast<unsigned int>(parameter.default_value));
		else
			values.numbers[parameter.name] =
				given ? read_number(parameter, list) : parameter.default_value;
	}
	return values;
}

} // namespace

FilterOrthopolyPlugin::FilterOrthopolyPlugin() : may_change_(MeshModel::MM_NONE)
{
	for (std::size_t i = 0; i < filters().size(); ++i) {
		const auto id = static_cast<ActionIDType>(i);
		typeList.push_back(id);
		actionList.push_back(new QAction(filterName(id), this));
	}
}

const Filter& FilterOrthopolyPlugin::filter_of(const QAction* action) const
{
	return *filters().at(static_cast<std::size_t>(ID(action)));
}

QString FilterOrthopolyPlugin::pluginName() const
{
	return "FilterOrthopoly";
}

QString FilterOrthopolyPlugin::vendor() const
{
	return "filter_orthopoly " ORTHOPOLY_VERSION;
}

QString FilterOrthopolyPlugin::filterName(ActionIDType id) const
{
	return text(filters().at(static_cast<std::size_t>(id))->name());
}

QString FilterOrthopolyPlugin::pythonFilterName(ActionIDType id) const
{
	return text(filters().at(static_cast<std::size_t>(id))->python_name());
}

QString FilterOrthopolyPlugin::filterInfo(ActionIDType id) const
{
	return text(filters().at(static_cast<std::size_t>(id))->info());
}

FilterPlugin::FilterClass FilterOrthopolyPlugin::getClass(const QAction* action) const
{
	return filter_of(action).menu() == Menu::Smoothing ? Smoothing : Quality;
}

FilterPlugin::FilterArity FilterOrthopolyPlugin::filterArity(const QAction* action) const
{
	return filter_of(action).works_on_current_layer() ? SINGLE_MESH : FIXED;
}

int FilterOrthopolyPlugin::postCondition(const QAction*) const
{
	return may_change_;
}

RichParameterList
FilterOrthopolyPlugin::initParameterList(const QAction* action, const MeshDocument& document)
{
	const Filter& filter = filter_of(action);
	may_change_ = filter.may_change(document);
	RichParameterList list;
	for (const FilterParameter& parameter : filter.parameters(document))
		add_parameter(parameter, document, list);
	return list;
}

std::map<std::string, QVariant> FilterOrthopolyPlugin::applyFilter(
	const QAction* action,
	const RichParameterList& parameters,
	MeshDocument& document,
	unsigned int& post_condition_mask,
	vcg::CallBackPos* callback)
{
	// MLException is the one that every host turns into a message.
	try {
		const Filter& filter = filter_of(action);
		FilterRun run {document, read_values(filter, parameters, document), callback, {}};
		run.log = [this](const std::string& line) { log(GLLogStream::FILTER, "%s", line.c_str()); };
		apply_filter(filter, run);
		post_condition_mask = static_cast<unsigned int>(run.changed);

		std::map<std::string, QVariant> outputs;
		for (const auto& [name, value] : run.outputs)
			outputs[name] = std::visit([](auto number) { return QVariant(number); }, value);
		return outputs;
	}
	catch (const MLException&) {
		throw;
	}
	catch (const std::exception& error) {
		log(GLLogStream::WARNING, "%s", error.what());
		throw MLException(text(error.what()));
	}
}
