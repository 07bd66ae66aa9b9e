// SPDX-License-Identifier: GPL-3.0-or-later
#include "inspection.h"

#include "adjacency.h"
#include "seams.h"

#include <algorithm>

namespace orthopoly {

namespace {

// How many elements equal one before them; puts them in order.
template<class Element, class Less>
Index count_repeated(std::vector<Element>& elements, Less less)
{
	std::sort(elements.begin(), elements.end(), less);
	const auto end =
		std::unique(elements.begin(), elements.end(), [&](const Element& a, const Element& b) {
			return !less(a, b) && !less(b, a);
		});
	return static_cast<Index>(elements.end() - end);
}

Index count_duplicate_vertices(const TriangleMesh& mesh)
{
	std::vector<Point> points;
	std::copy_if(
		mesh.positions.begin(),
		mesh.positions.end(),
		std::back_inserter(points),
		[](const Point& point) { return point.allFinite(); });
	return count_repeated(points, comes_before);
}

Index count_duplicate_faces(const TriangleMesh& mesh)
{
	std::vector<Face> faces = mesh.faces;
	for (Face& face : faces)
		std::sort(face.begin(), face.end());
	return count_repeated(faces, std::less<>());
}

} // namespace

Inspection inspect(const TriangleMesh& mesh)
{
	Inspection found;
	for (const Point& point : mesh.positions)
		found.not_finite_vertices += point.allFinite() ? 0 : 1;
	const IndexLists around = vertex_faces(mesh.vertex_count(), mesh.faces);
	for (Index i = 0; i < mesh.vertex_count(); ++i)
		found.unreferenced_vertices += around.size(i) == 0 ? 1 : 0;
	for (const Face& face : mesh.faces)
		found.degenerate_faces += is_degenerate(mesh.positions, face) ? 1 : 0;
	Progress silent;
	Execution execution(1, silent);
	const EdgeDefects edges = find_edge_defects(mesh.faces, around, execution);
	for (const std::uint8_t flag : edges.boundary)
		found.boundary_vertices += flag;
	if (found.not_finite_vertices == 0)
		found.seam_vertices = find_seams(mesh, around, edges).repeated;
	found.duplicate_vertices = count_duplicate_vertices(mesh);
	found.duplicate_faces = count_duplicate_faces(mesh);
	found.non_manifold_edges = edges.non_manifold;
	found.components = number_components(mesh.faces, around).count;
	return found;
}

} // namespace orthopoly
