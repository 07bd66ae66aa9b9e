// SPDX-License-Identifier: GPL-3.0-or-later
// Writes the meshes of recipes.h to files: generate_meshes --out DIR [--size FACES] [NAME...]
#include "errors.h"
#include "mesh_io.h"
#include "recipes.h"

#include <exception>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

namespace {

using namespace orthopoly;

struct Arguments {
	std::string folder;
	// 0: each mesh at its own size.
	Index faces = 0;
	std::vector<std::string> names;
};

Index read_size(const std::string& text)
{
	std::size_t end = 0;
	int size = 0;
	try {
		size = std::stoi(text, &end);
	}
	catch (const std::exception&) {
		end = 0;
	}
	if (end != text.size() || size < 1)
		throw InvalidParameter("--size is '" + text + "'; give a number of faces, 1 or more");
	return size;
}

Arguments read_arguments(int argc, char** argv)
{
	Arguments arguments;
	for (int i = 1; i < argc; ++i) {
		const std::string word = argv[i];
		const bool takes_value = word == "--out" || word == "--size";
		if (takes_value && i + 1 == argc)
			throw InvalidParameter(word + " needs a value");
		if (word == "--out")
			arguments.folder = argv[++i];
		else if (word == "--size")
			arguments.faces = read_size(argv[++i]);
		else
			arguments.names.push_back(word);
	}
	if (arguments.folder.empty())
		throw InvalidParameter("usage: generate_meshes --out DIR [--size FACES] [NAME...]");
	return arguments;
}

// The meshes that were named, or all of them; those of one size are not there in another.
std::vector<const Recipe*> chosen_recipes(const Arguments& arguments)
{
	std::vector<const Recipe*> chosen;
	for (const std::string& name : arguments.names) {
		chosen.push_back(&find_recipe(name));
		if (arguments.faces > 0 && !chosen.back()->has_sizes())
			throw InvalidParameter(name + " has one size only; leave out --size");
	}
	if (arguments.names.empty()) {
		for (const Recipe& recipe : recipes()) {
			if (arguments.faces == 0 || recipe.has_sizes())
				chosen.push_back(&recipe);
		}
	}
	return chosen;
}

void run(const Arguments& arguments)
{
	std::filesystem::create_directories(arguments.folder);
	for (const Recipe* recipe : chosen_recipes(arguments)) {
		const TriangleMesh mesh =
			arguments.faces > 0 ? recipe->make(arguments.faces) : recipe->make_default();
		save_mesh(
			(std::filesystem::path(arguments.folder) / (recipe->name + ".ply")).string(), mesh);
	}
}

} // namespace

int main(int argc, char** argv)
{
	try {
		run(read_arguments(argc, argv));
	}
	catch (const std::exception& error) {
		std::cerr << "generate_meshes: " << error.what() << "\n";
		return 1;
	}
	return 0;
}
