// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "filter.h"
#include "measures.h"
#include "vcg_adapter.h"

#include <string>

namespace orthopoly {

/// The current layer of the run's document. Throws InvalidMesh where there is none.
MeshModel& current_layer(FilterRun& run);

/// Reports progress. Throws Cancelled where the user wants the work to stop; call it only before
/// anything is written.
void report_or_stop(Progress& progress, double fraction, const char* words);

/// Reads a layer whose surface is wanted. Throws InvalidMesh, naming the layer, where it is made of
/// polygons or has no faces, or where it cannot be read.
VcgArrays read_layer(const MeshModel& layer, VcgRegion region = VcgRegion::All);

/// Reads the current layer with the vertices fixed that `only_selected` leaves alone, and logs how
/// far the selection reaches. Throws InvalidParameter where nothing is left to move.
VcgArrays read_current_layer(FilterRun& run);

/// Reads the layer that the parameter `reference` names. Throws InvalidParameter where that is the
/// current one or none at all.
TriangleMesh read_reference(FilterRun& run);

/// Writes new positions into the current layer and brings normals and bounding box up to date.
/// Vertices that did not move are not touched.
void write_current_layer(
	FilterRun& run, const VcgArrays& arrays, const std::vector<Point>& positions);

/// Draws what was measured on the current layer: faces in colour by angular error with `max_angle`
/// in red, the angles as face quality (degrees), the distances as vertex quality.
void paint_errors(
	FilterRun& run, const VcgArrays& arrays, const ErrorMeasures& errors, double max_angle);

/// Reports measures as outputs, each name with this prefix.
void report_errors(FilterRun& run, const ErrorMeasures& errors, const std::string& prefix);

/// How faces found their pairs in the reference, and how many of them, in words.
std::string describe_pairing(const ErrorMeasures& errors, const VcgArrays& arrays);

/// Measures in words, for the log.
std::string describe_errors(const ErrorMeasures& errors);

/// A number for the log: four digits.
std::string in_words(double value);

/// "1 face", "2 faces".
std::string count_of(Index count, const char* one, const char* many);

} // namespace orthopoly
