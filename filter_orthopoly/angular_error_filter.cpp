// SPDX-License-Identifier: GPL-3.0-or-later
#include "angular_error_filter.h"

#include "errors.h"
#include "layers.h"

namespace orthopoly {

std::string AngularErrorFilter::name() const
{
	return "Angular Error from Reference Mesh";
}

std::string AngularErrorFilter::python_name() const
{
	return "compute_scalar_by_angular_error_per_face";
}

std::string AngularErrorFilter::info() const
{
	return "Measures how far the current layer is from a reference, such as the clean original of a "
		   "denoised mesh. The geometry does not change.<br><br>"
		   "Every face gets the angle between its normal and the reference's, in degrees, as its "
		   "quality and as its colour (blue: none, red: the colour range and more; grey: not "
		   "measured, quality -1). Every vertex gets its distance to the reference as its quality. The "
		   "log and the output values tell the mean and largest angle, the mean square angular error "
		   "(MSAE, radians squared), the vertex error (area-weighted root mean square distance; in the "
		   "mesh's unit and in mean edge lengths of the reference) and the number of faces folded over "
		   "(more than 90 degrees off; those that the reference itself has folded are counted among them "
		   "and by themselves).<br><br>"
		   "Where both layers have the same faces, they pair by number; else each face pairs with the "
		   "closest point of the reference.";
}

Menu AngularErrorFilter::menu() const
{
	return Menu::Quality;
}

bool AngularErrorFilter::works_on_current_layer() const
{
	return false;
}

int AngularErrorFilter::may_change(const MeshDocument&) const
{
	return MeshModel::MM_FACECOLOR | MeshModel::MM_FACEQUALITY | MeshModel::MM_VERTQUALITY;
}

FilterParameters AngularErrorFilter::parameters(const MeshDocument& document) const
{
	return {
		reference_parameter(document, "The layer to compare with: the true shape."),
		max_angle_parameter(),
		max_distance_parameter(document),
	};
}

void AngularErrorFilter::apply(FilterRun& run) const
{
	const double max_angle = checked_value(max_angle_parameter(), run.values);
	MeasureOptions options;
	options.max_distance = checked_value(max_distance_parameter(run.document), run.values);

	const VcgArrays arrays = read_layer(current_layer(run));
	Progress progress = vcg_progress(run.callback);
	report_or_stop(progress, 0, "reading the reference");
	const ReferenceMeasure reference(read_reference(run), options);
	const ErrorMeasures errors = reference.measure(arrays.mesh, progress);
	if (errors.measured_faces == 0)
		throw InvalidParameter(
			"none of the " + std::to_string(arrays.mesh.face_count()) +
			" faces has an area and lies within max_distance = " + in_words(options.max_distance) +
			" of the reference; raise max_distance (0: no limit), or align the two layers first");
	report_or_stop(progress, 1, "done");

	paint_errors(run, arrays, errors, max_angle);
	report_errors(run, errors, "");
	run.outputs.emplace_back("paired_by_index", errors.paired_by_index);
	run.log(describe_pairing(errors, arrays));
	run.log(describe_errors(errors));
}

} // namespace orthopoly
