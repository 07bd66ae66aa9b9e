// SPDX-License-Identifier: GPL-3.0-or-later
#include "plugin_old_interface.h"

#include "errors.h"

#include <QAction>

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

// How a kind of parameter is shown and read back. A layer is read as a mesh, not as a number.
struct Kind {
	void (*add)(const FilterParameter&, MeshDocument&, RichParameterList&);
	double (*read)(const RichParameterList&, const QString&);
};

template<class Rich, class Value>
void add_value(const FilterParameter& p, MeshDocument&, RichParameterList& list)
{
	list.addParam(
		Rich(text(p.name), static_cast<Value>(p.default_value), text(p.label), text(p.tooltip)));
}

void add_choice(const FilterParameter& p, MeshDocument&, RichParameterList& list)
{
	list.addParam(RichEnum(
		text(p.name),
		static_cast<int>(p.default_value),
		choices(p),
		text(p.label),
		text(p.tooltip)));
}

void add_layer(const FilterParameter& p, MeshDocument& document, RichParameterList& list)
{
	// The host insists on a mesh of the document, where it is given one.
	const bool empty = document.mm() == nullptr;
	MeshModel* layer = empty ? nullptr : document.getMesh(static_cast<int>(p.default_value));
	list.addParam(
		RichMesh(text(p.name), layer, empty ? nullptr : &document, text(p.label), text(p.tooltip)));
}

void add_length(const FilterParameter& p, MeshDocument&, RichParameterList& list)
{
	list.addParam(RichAbsPerc(
		text(p.name),
		static_cast<float>(p.default_value),
		0.0f,
		static_cast<float>(p.full_length),
		text(p.label),
		text(p.tooltip)));
}

Kind kind_of(const FilterParameter& parameter)
{
	using List = RichParameterList;
	using Name = QString;
	if (parameter.input == FilterParameter::Input::Layer)
		return {add_layer, nullptr};
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
	return {add_value<RichFloat, float>, [](const List& l, const Name& n) {
				return as_written(l.getFloat(n));
			}};
}

ParameterValues
read_values(const Filter& filter, const RichParameterList& list, MeshDocument& document)
{
	ParameterValues values;
	for (const FilterParameter& parameter : filter.parameters(document)) {
		const QString name = text(parameter.name);
		if (parameter.input == FilterParameter::Input::Layer)
			values.layers[parameter.name] = list.getMesh(name);
		else
			values.numbers[parameter.name] = kind_of(parameter).read(list, name);
	}
	return values;
}

} // namespace

FilterOrthopolyPlugin::FilterOrthopolyPlugin() : changed_(MeshModel::MM_NONE)
{
	for (std::size_t i = 0; i < filters().size(); ++i) {
		const auto id = static_cast<FilterIDType>(i);
		typeList.push_back(id);
		actionList.push_back(new QAction(filterName(id), this));
	}
}

const Filter& FilterOrthopolyPlugin::filter_of(QAction* action) const
{
	return *filters().at(static_cast<std::size_t>(ID(action)));
}

QString FilterOrthopolyPlugin::pluginName() const
{
	return "FilterOrthopoly";
}

QString FilterOrthopolyPlugin::filterName(FilterIDType id) const
{
	return text(filters().at(static_cast<std::size_t>(id))->name());
}

QString FilterOrthopolyPlugin::filterInfo(FilterIDType id) const
{
	return text(filters().at(static_cast<std::size_t>(id))->info());
}

MeshFilterInterface::FilterClass FilterOrthopolyPlugin::getClass(QAction* action)
{
	return filter_of(action).menu() == Menu::Smoothing ? Smoothing : Quality;
}

MeshFilterInterface::FILTER_ARITY FilterOrthopolyPlugin::filterArity(QAction* action) const
{
	return filter_of(action).works_on_current_layer() ? SINGLE_MESH : FIXED;
}

int FilterOrthopolyPlugin::postCondition(QAction*) const
{
	return changed_;
}

void FilterOrthopolyPlugin::initParameterSet(
	QAction* action, MeshDocument& document, RichParameterList& parameters)
{
	const Filter& filter = filter_of(action);
	changed_ = filter.may_change(document);
	for (const FilterParameter& parameter : filter.parameters(document))
		kind_of(parameter).add(parameter, document, parameters);
}

bool FilterOrthopolyPlugin::applyFilter(
	QAction* action,
	MeshDocument& document,
	const RichParameterList& parameters,
	vcg::CallBackPos* callback)
{
	// This host ends on any exception: everything becomes a message.
	try {
		const Filter& filter = filter_of(action);
		FilterRun run {document, read_values(filter, parameters, document), callback, {}};
		run.log = [this](const std::string& line) { Log(GLLogStream::FILTER, "%s", line.c_str()); };
		apply_filter(filter, run);
		changed_ = run.changed;
		// This host has no output values for its scripts: the log tells them.
		for (const auto& [name, value] : run.outputs) {
			const double number = std::visit([](auto n) { return static_cast<double>(n); }, value);
			Log(GLLogStream::FILTER, "%s = %.9g", name.c_str(), number);
		}
		return true;
	}
	catch (const std::exception& error) {
		changed_ = MeshModel::MM_NONE;
		errorMessage = text(error.what());
		// The server prints the log only.
		Log(GLLogStream::FILTER, "Error: %s", error.what());
		return false;
	}
	catch (...) {
		changed_ = MeshModel::MM_NONE;
		errorMessage = "unexpected error without a description";
		return false;
	}
}
