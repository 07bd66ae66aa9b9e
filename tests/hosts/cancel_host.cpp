// SPDX-License-Identifier: GPL-3.0-or-later
// The least host of MeshLab 2020.09's plugin interface, for what its own hosts never do: answer
// false to a progress report, and tell the names and defaults of parameters. A library, so that
// MeshLab's own can be loaded before it.
#include <QApplication>
#include <QPluginLoader>
#include <chrono>
#include <cmath>
#include <common/interfaces.h>
#include <cstdio>
#include <vcg/complex/algorithms/create/platonic.h>
#include <vector>

namespace {

int calls = 0;
int calls_after = 0;
int last_percent = 0;
bool stopped = false;
std::chrono::steady_clock::time_point refused;

bool callback(const int percent, const char*)
{
	++calls;
	if (stopped)
		++calls_after;
	else if (percent >= last_percent) {
		stopped = true;
		refused = std::chrono::steady_clock::now();
	}
	return !stopped;
}

const char* menu_of(MeshFilterInterface::FilterClass classes)
{
	switch (classes) {
	case MeshFilterInterface::Smoothing: return "Smoothing";
	case MeshFilterInterface::Quality: return "Quality";
	default: return "another";
	}
}

std::vector<Point3m> positions(const CMeshO& mesh)
{
	std::vector<Point3m> all;
	for (const CVertexO& vertex : mesh.vert)
		all.push_back(vertex.cP());
	return all;
}

} // namespace

/// Applies a filter of a plugin to an uneven sphere beside an even one, with a callback that
/// answers false from that percentage on; with a switch of the filter turned on, unless its name is
/// empty. Prints what came of it, a word and its value a line.
extern "C" __attribute__((visibility("default"))) int
apply_and_cancel(const char* plugin_path, const char* filter, int percent, const char* on)
{
	int argc = 0;
	QApplication application(argc, nullptr);
	last_percent = percent;
	QPluginLoader loader(plugin_path);
	auto* plugin = qobject_cast<MeshFilterInterface*>(loader.instance());
	if (plugin == nullptr) {
		std::fprintf(stderr, "%s\n", qUtf8Printable(loader.errorString()));
		return 2;
	}

	MeshDocument document;
	for (int i = 0; i < 2; ++i) {
		MeshModel& layer = *document.addNewMesh("", QString("layer %1").arg(i), true);
		vcg::tri::Sphere(layer.cm, 5);
		for (CVertexO& vertex : layer.cm.vert) {
			// Any uneven surface will do.
			const Point3m p = vertex.P();
			vertex.P() =
				p * float(1 + 0.01 * i * std::sin(4000 * p[0] + 5000 * p[1] + 6000 * p[2]));
		}
		layer.UpdateBoxAndNormals();
	}

	QAction* action = plugin->AC(QString(filter));
	RichParameterList parameters;
	plugin->initParameterSet(action, document, parameters);
	if (*on != '\0')
		parameters.setValue(on, BoolValue(true));
	const std::vector<Point3m> before = positions(document.mm()->cm);
	const bool applied = plugin->applyFilter(action, document, parameters, &callback);
	const auto waited = std::chrono::steady_clock::now() - refused;

	const bool painted = document.mm()->hasDataMask(MeshModel::MM_FACECOLOR) ||
						 document.mm()->hasDataMask(MeshModel::MM_FACEQUALITY);
	std::printf("menu %s\n", menu_of(plugin->getClass(action)));
	std::printf("calls %d\n", calls);
	std::printf("calls_after %d\n", calls_after);
	std::printf("applied %d\n", applied ? 1 : 0);
	std::printf("changed %d\n", before != positions(document.mm()->cm) || painted ? 1 : 0);
	if (stopped)
		std::printf(
			"milliseconds %.3f\n", std::chrono::duration<double, std::milli>(waited).count());
	std::printf("message %s\n", qUtf8Printable(plugin->errorMsg()));
	for (const RichParameter& parameter : parameters) {
		const Value& value = parameter.value();
		double number = 0;
		if (value.isBool())
			number = value.getBool() ? 1 : 0;
		else if (value.isMesh())
			number = document.meshList.indexOf(value.getMesh());
		else if (value.isAbsPerc())
			number = value.getAbsPerc();
		else if (value.isEnum())
			number = value.getEnum();
		else if (value.isInt())
			number = value.getInt();
		else
			number = value.getFloat();
		std::printf(
			"parameter %s %s %.9g\n",
			qUtf8Printable(parameter.name()),
			qUtf8Printable(parameter.stringType()),
			number);
	}
	std::fflush(stdout);
	return 0;
}
