// SPDX-License-Identifier: GPL-3.0-or-later
#include "plugin_old_interface.h"

#include "rich_values.h"

#include <QAction>
#include <locale>
#include <sstream>

using namespace orthopoly;

namespace {

template<class Rich, class... Values>
void add(RichParameterList& list, const FilterParameter& p, const Values&... values)
{
	list.addParam(Rich(text(p.name), values..., text(p.label), text(p.tooltip)));
}

void add_parameter(const FilterParameter& p, MeshDocument& document, RichParameterList& list)
{
	const auto number = static_cast<float>(p.default_value);
	const auto whole = static_cast<int>(p.default_value);
	if (p.input == FilterParameter::Input::Layer) {
		// The host insists on a mesh of the document, where it is given one.
		MeshModel* layer = document.mm() == nullptr ? nullptr : document.getMesh(whole);
		return add<RichMesh>(list, p, layer, layer == nullptr ? nullptr : &document);
	}
	if (p.input == FilterParameter::Input::Length)
		return add<RichAbsPerc>(list, p, number, 0.0f, static_cast<float>(p.full_length));
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
		if (parameter.input == FilterParameter::Input::Layer)
			values.layers[parameter.name] = list.getMesh(text(parameter.name));
		else
			values.numbers[parameter.name] = read_number(parameter, list);
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
		add_parameter(parameter, document, parameters);
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
		std::ostringstream outputs;
		outputs.imbue(std::locale::classic());
		outputs.precision(9);
		for (const auto& [name, value] : run.outputs) {
			outputs << ' ' << name << '=';
			std::visit([&outputs](auto number) { outputs << number; }, value);
		}
		run.log("output values:" + outputs.str());
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
