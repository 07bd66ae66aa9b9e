// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filter_parameters.h"

#include <QString>
#include <QStringList>

namespace orthopoly {

inline QString text(const std::string& utf8)
{
	return QString::fromStdString(utf8);
}

inline QStringList choices(const FilterParameter& parameter)
{
	QStringList list;
	for (const std::string& choice : parameter.choices)
		list.push_back(text(choice));
	return list;
}

/// The value of a parameter that is not a layer, from the parameter list of any version of MeshLab.
template<class RichParameterList>
double read_number(const FilterParameter& parameter, const RichParameterList& list)
{
	const QString name = text(parameter.name);
	if (parameter.input == FilterParameter::Input::Length)
		return static_cast<double>(list.getAbsPerc(name));
	switch (parameter.type) {
	case ParameterType::Boolean: return list.getBool(name) ? 1 : 0;
	case ParameterType::Integer: return list.getInt(name);
	case ParameterType::Choice: return list.getEnum(name);
	case ParameterType::Real: break;
	}
	// All versions keep it in single precision.
	return as_written(static_cast<float>(list.getFloat(name)));
}

} // namespace orthopoly
