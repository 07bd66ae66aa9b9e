// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "workspace.h"

#include <vector>

namespace orthopoly {

/// A face's cosine to its target up to which it is folded, as in the vertex update.
constexpr double FOLDED = 0.3;

/// Doubled projected area over the square of the longest side, for equal heights their ratio, that
/// a face turned back is given: as narrow as triangles of common meshes are, and wide enough that
/// what is left of the noise does not turn it again.
constexpr double UNFOLDED_AREA = 0.1;

/// What a face has to look towards so as not to be folded.
struct FoldAim {
	/// Unit direction; zero: anywhere.
	Point witness = Point::Zero();
	/// Cosine to the witness up to which the face is folded.
	double folded = 0;
	/// Unit direction of what the face has to be like; zero where nothing is known.
	Point target = Point::Zero();
	/// What it is given when it is turned back, along the witness; see UNFOLDED_AREA.
	double area = 0;
};

/// The aim of a face by its target normal and by those across its edges.
///
/// A target that agrees with none of those around is not to be believed: where these agree with
/// each other, they say where the face has to look, and so they do where it has none. Edges have
/// targets of two sides. What of them is folded is a face turned beyond both, and which of both it
/// belongs to is doubtful where it is a sliver or where two faces across its edges are of the other
/// side: there it has to be within a right angle of either. At knife edges nobody knows.
///
/// @param normals   #F target unit normals, zero where there is none
/// @param positions #V as they are now
FoldAim fold_aim(
	const Workspace& workspace,
	const std::vector<Point>& normals,
	const std::vector<Point>& positions,
	Index face);

/// Whether a face with that cross product is folded; one without an area is.
inline bool is_folded(const Point& cross, const FoldAim& aim)
{
	return !aim.witness.isZero(0) && cross.dot(aim.witness) <= aim.folded * cross.norm();
}

} // namespace orthopoly
