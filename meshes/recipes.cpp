// SPDX-License-Identifier: GPL-3.0-or-later
#include "recipes.h"

#include "defects.h"
#include "errors.h"
#include "shapes.h"

namespace orthopoly {

namespace {

Recipe of_one_size(const char* name, TriangleMesh (*make)(), bool can_be_denoised = true)
{
	return {name, [make](Index) { return make(); }, 0, can_be_denoised};
}

} // namespace

const std::vector<Recipe>& recipes()
{
	static const std::vector<Recipe> table = {
		{"cube", make_cube, 12288},
		{"sphere", make_sphere, 8000},
		{"torus", make_torus, 10000},
		{"part", make_part, 16000},
		{"thin_plate", make_thin_plate, 4096},
		{"height_field", make_height_field, 12000},
		{"scan_lines", make_scan_lines, 9000},
		of_one_size("non_manifold_edge", make_non_manifold_edge),
		of_one_size("non_manifold_vertex", make_non_manifold_vertex),
		of_one_size("degenerate_face", make_degenerate_face),
		of_one_size("duplicate_vertex", make_duplicate_vertex),
		of_one_size("seam", make_seam),
		of_one_size("loose_triangles", make_loose_triangles),
		of_one_size("duplicate_face", make_duplicate_face),
		of_one_size("unreferenced_vertex", make_unreferenced_vertex),
		of_one_size("isolated_face", make_isolated_face),
		of_one_size("mixed_orientation", make_mixed_orientation),
		of_one_size("two_components", make_two_components),
		of_one_size("empty", make_empty, false),
		of_one_size("points_only", make_points_only, false),
		of_one_size("nan_coordinate", make_nan_coordinate, false),
	};
	return table;
}

const Recipe& find_recipe(const std::string& name)
{
	std::string known;
	for (const Recipe& recipe : recipes()) {
		if (recipe.name == name)
			return recipe;
		known += (known.empty() ? "" : ", ") + recipe.name;
	}
	throw InvalidParameter("there is no mesh '" + name + "'; there are " + known);
}

} // namespace orthopoly
