// SPDX-License-Identifier: GPL-3.0-or-later
#include "layers.h"

#include "errors.h"
#include "execution.h"

#include <locale>
#include <sstream>
#include <vcg/complex/algorithms/update/bounding.h>
#include <vcg/complex/algorithms/update/normal.h>

namespace orthopoly {

namespace {

std::string label_of(const MeshModel& layer)
{
	return "'" + layer.label().toStdString() + "'";
}

// A polygon is a chain of triangles joined by faux edges: a fan of n triangles has n - 1 of them,
// each seen from both sides.
Index count_polygons(const CMeshO& mesh)
{
	Index triangles = 0;
	Index faux_sides = 0;
	for (const CFaceO& face : mesh.face) {
		if (face.IsD() || !face.IsAnyF())
			continue;
		++triangles;
		for (int k = 0; k < 3; ++k)
			faux_sides += face.IsF(k) ? 1 : 0;
	}
	return triangles - faux_sides / 2;
}

const vcg::Color4b UNMEASURED(160, 160, 160, 255);

vcg::Color4b angle_color(double angle, double max_angle)
{
	if (angle < 0)
		return UNMEASURED;
	// vcglib's ramp runs from red to blue; with its ends swapped, from blue to red.
	vcg::Color4b color;
	color.SetColorRamp(static_cast<float>(max_angle), 0.0f, static_cast<float>(angle));
	return color;
}

} // namespace

MeshModel& current_layer(FilterRun& run)
{
	if (run.document.mm() == nullptr)
		throw InvalidMesh("the document has no layer; open a mesh first");
	return *run.document.mm();
}

void report_or_stop(Progress& progress, double fraction, const char* words)
{
	if (!progress.report(fraction, words))
		throw Cancelled();
}

VcgArrays read_layer(const MeshModel& layer, VcgRegion region)
{
	const std::string label = label_of(layer);
	// Whatever the layer's MM_POLYGONAL says: what subdivides into quads in MeshLab 2025.07 leaves
	// it unset.
	const Index polygons = count_polygons(layer.cm);
	if (polygons > 0)
		throw InvalidMesh(
			"layer " + label + " has " + count_of(polygons, "polygon", "polygons") +
			" with more than three corners; apply 'Turn into a Pure-Triangular mesh' "
			"(meshing_poly_to_tri in Python) to it first");
	if (layer.cm.fn == 0)
		throw InvalidMesh(
			"layer " + label + " has " + count_of(layer.cm.vn, "vertex", "vertices") +
			" and no faces; choose a layer with a surface, or reconstruct one first");
	try {
		VcgArrays arrays = read_vcg_mesh(layer.cm, region);
		validate(arrays.mesh);
		return arrays;
	}
	catch (const InvalidMesh& error) {
		throw InvalidMesh("layer " + label + ": " + error.what());
	}
}

VcgArrays read_current_layer(FilterRun& run)
{
	const MeshModel& layer = current_layer(run);
	if (!run.values.is_on("only_selected"))
		return read_layer(layer);
	VcgArrays arrays = read_layer(layer, VcgRegion::SelectedFaces);
	const std::string all = std::to_string(arrays.mesh.face_count());
	if (arrays.selected_faces == 0)
		throw InvalidParameter(
			"only_selected is on, but none of the " + all +
			" faces is selected; select the faces to work on, or turn only_selected off");
	if (arrays.free_vertices == 0)
		throw InvalidParameter(
			"only_selected is on, but no vertex has all its faces among the " +
			std::to_string(arrays.selected_faces) + " selected of " + all +
			", so nothing can move; select a larger region, or turn only_selected off");
	run.log(
		"restricted to " + std::to_string(arrays.selected_faces) + " of " + all +
		" faces (the selection): " + std::to_string(arrays.free_vertices) + " of " +
		count_of(arrays.mesh.vertex_count(), "vertex", "vertices") + " may move");
	return arrays;
}

TriangleMesh read_reference(FilterRun& run)
{
	const MeshModel& current = current_layer(run);
	const MeshModel* reference = run.values.layers.at("reference");
	if (reference == nullptr) {
		std::string known;
		for_each_layer(run.document, [&](const MeshModel& layer) {
			known +=
				(known.empty() ? "" : ", ") + std::to_string(layer.id()) + " " + label_of(layer);
		});
		throw InvalidParameter(
			"the reference is a layer that is not there; choose one of those there are: " + known);
	}
	if (reference == &current)
		throw InvalidParameter(
			"the reference is the current layer " + label_of(current) +
			" itself; choose another layer as the reference, or make another one current");
	if (!(reference->cm.Tr == current.cm.Tr))
		run.log(
			"Warning: the two layers have different transformation matrices, which are not taken into "
			"account; apply 'Matrix: Freeze Current Matrix' to both if they should be.");
	try {
		return read_layer(*reference).mesh;
	}
	catch (const InvalidMesh& error) {
		throw InvalidMesh(std::string("the reference cannot be used: ") + error.what());
	}
}

void write_current_layer(
	FilterRun& run, const VcgArrays& arrays, const std::vector<Point>& positions)
{
	MeshModel& layer = current_layer(run);
	write_positions(layer.cm, arrays, positions);
	vcg::tri::UpdateBounding<CMeshO>::Box(layer.cm);
	vcg::tri::UpdateNormal<CMeshO>::PerFaceNormalized(layer.cm);
	vcg::tri::UpdateNormal<CMeshO>::PerVertexAngleWeighted(layer.cm);
	run.changed |= MeshModel::MM_VERTCOORD | MeshModel::MM_VERTNORMAL | MeshModel::MM_FACENORMAL;
}

void paint_errors(
	FilterRun& run, const VcgArrays& arrays, const ErrorMeasures& errors, double max_angle)
{
	MeshModel& layer = current_layer(run);
	const int painted =
		MeshModel::MM_FACECOLOR | MeshModel::MM_FACEQUALITY | MeshModel::MM_VERTQUALITY;
	layer.updateDataMask(painted);
	for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
		CFaceO& face = layer.cm.face[arrays.faces[i]];
		face.C() = angle_color(errors.face_angles[i], max_angle);
		face.Q() = static_cast<CFaceO::QualityType>(errors.face_angles[i]);
	}
	for (std::size_t i = 0; i < arrays.vertices.size(); ++i)
		layer.cm.vert[arrays.vertices[i]].Q() =
			static_cast<CVertexO::QualityType>(errors.vertex_distances[i]);
	run.changed |= painted;
}

void report_errors(FilterRun& run, const ErrorMeasures& errors, const std::string& prefix)
{
	run.outputs.insert(
		run.outputs.end(),
		{
			{prefix + "mean_angle", errors.mean_angle},
			{prefix + "max_angle", errors.max_angle},
			{prefix + "msae", errors.msae},
			{prefix + "msae_without_folded", errors.msae_without_folded},
			{prefix + "vertex_error", errors.vertex_error},
			{prefix + "relative_vertex_error", errors.relative_vertex_error},
			{prefix + "max_distance", errors.max_distance},
			{prefix + "folded_faces", static_cast<int>(errors.folded_faces)},
			{prefix + "folded_in_reference", static_cast<int>(errors.folded_in_reference)},
			{prefix + "measured_faces", static_cast<int>(errors.measured_faces)},
		});
}

std::string describe_pairing(const ErrorMeasures& errors, const VcgArrays& arrays)
{
	return std::to_string(errors.measured_faces) + " of " +
		   count_of(arrays.mesh.face_count(), "face", "faces") + " measured, paired " +
		   (errors.paired_by_index ? "by number (both layers have the same faces)" :
									 "with the closest point of the reference");
}

std::string describe_errors(const ErrorMeasures& errors)
{
	return "mean angle " + in_words(errors.mean_angle) + " degrees, largest " +
		   in_words(errors.max_angle) + ", MSAE " + in_words(errors.msae) + " rad^2 (eq. 14; " +
		   in_words(errors.msae_without_folded) + " without folded faces), vertex error " +
		   in_words(errors.vertex_error) + " (eq. 13) = " + in_words(errors.relative_vertex_error) +
		   " mean edge lengths, largest distance " + in_words(errors.max_distance) + ", " +
		   count_of(errors.folded_faces, "face", "faces") + " folded over" +
		   (errors.folded_in_reference > 0 ?
				", " + std::to_string(errors.folded_in_reference) + " of them in the reference" :
				"");
}

std::string in_words(double value)
{
	std::ostringstream text;
	text.imbue(std::locale::classic());
	text.precision(4);
	text << value;
	return text.str();
}

std::string count_of(Index count, const char* one, const char* many)
{
	return std::to_string(count) + " " + (count == 1 ? one : many);
}

} // namespace orthopoly
