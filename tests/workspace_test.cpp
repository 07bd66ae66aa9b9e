// SPDX-License-Identifier: GPL-3.0-or-later
#include "workspace.h"

#include "noise.h"
#include "shapes.h"
#include "test_support.h"

using namespace orthopoly;

TEST_CASE("a workspace has the connectivity of its mesh", "[workspace]")
{
	const TriangleMesh mesh = make_torus(1000);
	Progress progress;
	Execution execution(1, progress);
	const Workspace workspace(mesh, execution);
	CHECK(&workspace.mesh == &mesh);
	CHECK(workspace.vertex_faces.offsets.size() == mesh.positions.size() + 1);
	CHECK(workspace.edges.boundary == std::vector<std::uint8_t>(mesh.positions.size(), 0));
	CHECK(workspace.mean_edge_length == mean_edge_length(mesh.positions, mesh.faces));
}

TEST_CASE("folded faces are those turned against their surroundings", "[workspace]")
{
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	const TriangleMesh mesh = placed(make_torus(2000), scale);
	Progress progress;
	Execution execution(1, progress);
	const Workspace workspace(mesh, execution);
	CHECK(count_folded_faces(mesh.positions, workspace) == 0);

	// A vertex pulled across the opposite edge of one of its faces turns that face over.
	std::vector<Point> positions = mesh.positions;
	const Face& face = mesh.faces[300];
	const auto at = [&](std::size_t k) -> Point& {
		return positions[static_cast<std::size_t>(face[k])];
	};
	const Point middle = 0.5 * (at(1) + at(2));
	at(0) = middle + 0.5 * (middle - at(0));
	CHECK(count_folded_faces(positions, workspace) >= 1);
	CHECK(count_folded_faces(positions, workspace) <= 6);
}

TEST_CASE("sharp edges are not folds", "[workspace]")
{
	const TriangleMesh cube = make_cube(1200);
	Progress progress;
	Execution execution(1, progress);
	CHECK(count_folded_faces(cube.positions, Workspace(cube, execution)) == 0);
}
