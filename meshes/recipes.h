// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "triangle_mesh.h"

#include <functional>
#include <string>
#include <vector>

namespace orthopoly {

/// A mesh that can be made by name.
struct Recipe {
	std::string name;
	/// Makes the mesh with about this many faces; a mesh of one size pays no heed to it.
	std::function<TriangleMesh(Index faces)> make;
	/// Number of faces where none is asked for; 0 for a mesh of one size.
	Index default_faces = 0;
	/// False for the meshes that every method has to refuse.
	bool can_be_denoised = true;

	bool has_sizes() const { return default_faces > 0; }
	TriangleMesh make_default() const { return make(default_faces); }
};

/// All of them: the shapes first, then the defects.
const std::vector<Recipe>& recipes();

/// The recipe of that name. Throws InvalidParameter, naming those there are.
const Recipe& find_recipe(const std::string& name);

} // namespace orthopoly
