// SPDX-License-Identifier: GPL-3.0-or-later
#include "plugin_new_interface.h"

#include "errors.h"

#include <QAction>

// MeshLab gave its percentages another name in 2023.
#if __has_include(<common/parameters/rich_parameter/rich_percentage.h>)
using RichLength = RichPercentage;
#else
using RichLength = RichAbsPerc;
#endif

using namespace orthopoly;

namespace {

QString text(const std::string& utf8)
{
	return QString::fromStdString(utf8);
}

QStringList choices(const FilterParameter& parameter)
{
	QStringList list;
	for (const std::string& choice : parameter.choices)
		list.push_back(text(choice));
	return list;
}

// How a kind of parameter is shown and read back.
struct Kind {
	void (*add)(const FilterParameter&, const MeshDocument&, RichParameterList&);
	double (*read)(const RichParameterList&, const QString&);
};

template<class Rich, class Value>
void add_value(const FilterParameter& p, const MeshDocument&, RichParameterList& list)
{
	list.addParam(Rich(
		text(p.name),
		static_cast<Value>(p.default_value),
		text(p.label),
		text(p.tooltip),
		p.advanced));
}

void add_choice(const FilterParameter& p, const MeshDocument&, RichParameterList& list)
{
	list.addParam(RichEnum(
		text(p.name),
		static_cast<int>(p.default_value),
		choices(p),
		text(p.label),
		text(p.tooltip),
		p.advanced));
}

void add_layer(const FilterParameter& p, const MeshDocument& document, RichParameterList& list)
{
	list.addParam(RichMesh(
		text(p.name),
		static_cast<unsigned int>(p.default_value),
		&document,
		text(p.label),
		text(p.tooltip),
		p.advanced));
}

void add_length(const FilterParameter& p, const MeshDocument&, RichParameterList& list)
{
	list.addParam(RichLength(
		text(p.name),
		static_cast<Scalarm>(p.default_value),
		Scalarm(0),
		static_cast<Scalarm>(p.full_length),
		text(p.label),
		text(p.tooltip),
		p.advanced));
}

Kind kind_of(const FilterParameter& parameter)
{
	using List = RichParameterList;
	using Name = QString;
	if (parameter.input == FilterParameter::Input::Layer)
		return {add_layer, [](const List& l, const Name& n) { return double(l.getMeshId(n)); }};
	if (parameter.input == FilterParameter::Input::Length)
		return {add_length, [](const List& l, const Name& n) { return double(l.getAbsPerc(n)); }};
	switch (parameter.type) {
	case ParameterType::Boolean:
		return {add_value<RichBool, bool>, [](const List& l, const Name& n) {
					return l.getBool(n) ? 1.0 : 0.0;
				}};
	case ParameterType::Integer:
		return {add_value<RichInt, int>, [](const List& l, const Name& n) {
					return double(l.getInt(n));
				}};
	case ParameterType::Choice:
		return {add_choice, [](const List& l, const Name& n) { return double(l.getEnum(n)); }};
	case ParameterType::Real: break;
	}
	return {add_value<RichFloat, Scalarm>, [](const List& l, const Name& n) {
				return as_written(float(l.getFloat(n)));
			}};
}

ParameterValues
read_values(const Filter& filter, const RichParameterList& list, MeshDocument& document)
{
	ParameterValues values;
	for (const FilterParameter& parameter : filter.parameters(document)) {
		const QString name = text(parameter.name);
		// A script may leave parameters out.
		const double value =
			list.hasParameter(name) ? kind_of(parameter).read(list, name) : parameter.default_value;
		if (parameter.input == FilterParameter::Input::Layer)
			values.layers[parameter.name] = document.getMesh(static_cast<unsigned int>(value));
		else
			values.numbers[parameter.name] = value;
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
		kind_of(parameter).add(parameter, document, list);
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
		throw MLException(text(error.what()));
	}
}
