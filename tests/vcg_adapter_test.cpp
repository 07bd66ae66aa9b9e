// SPDX-License-Identifier: GPL-3.0-or-later
#include "vcg_adapter.h"

#include "float_mesh.h"
#include "noise.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cstring>
#include <limits>
#include <string>
#include <vcg/complex/algorithms/create/platonic.h>
#include <vector>

using namespace orthopoly;

namespace {

// As FloatMesh, in the other precision.
class DoubleVertex;
class DoubleFace;
struct DoubleTypes :
		vcg::UsedTypes<vcg::Use<DoubleVertex>::AsVertexType, vcg::Use<DoubleFace>::AsFaceType> {};
class DoubleVertex :
		public vcg::Vertex<DoubleTypes, vcg::vertex::Coord3d, vcg::vertex::BitFlags> {};
class DoubleFace : public vcg::Face<DoubleTypes, vcg::face::VertexRef, vcg::face::BitFlags> {};
using DoubleMesh = vcg::tri::TriMesh<std::vector<DoubleVertex>, std::vector<DoubleFace>>;

template<class VcgMesh>
std::vector<typename VcgMesh::CoordType> coordinates(const VcgMesh& mesh)
{
	std::vector<typename VcgMesh::CoordType> all;
	for (const auto& vertex : mesh.vert)
		all.push_back(vertex.cP());
	return all;
}

template<class VcgMesh>
void make_noisy_grid(VcgMesh& mesh)
{
	vcg::tri::Grid(mesh, 13, 11, 1, 1);
	const VcgArrays arrays = read_vcg_mesh(mesh);
	NoiseOptions options;
	options.sigma = 0.2;
	write_positions(mesh, arrays, add_noise(arrays.mesh, options));
}

template<class VcgMesh>
std::size_t count_equal(const VcgMesh& mesh, const std::vector<typename VcgMesh::CoordType>& before)
{
	std::size_t equal = 0;
	for (std::size_t i = 0; i < before.size(); ++i)
		equal += mesh.vert[i].cP() == before[i] ? 1 : 0;
	return equal;
}

DenoiseOptions paper()
{
	DenoiseOptions options;
	options.method = Method::Paper;
	options.iterations = 2;
	return options;
}

std::vector<int> percents;

bool record(const int percent, const char*)
{
	percents.push_back(percent);
	return true;
}

bool refuse(const int, const char*)
{
	return false;
}

} // namespace

TEMPLATE_TEST_CASE("a VCG mesh is read in its own order", "[vcg_adapter]", FloatMesh, DoubleMesh)
{
	TestType mesh;
	vcg::tri::Icosahedron(mesh);
	const VcgArrays arrays = read_vcg_mesh(mesh);
	REQUIRE(arrays.mesh.vertex_count() == 12);
	REQUIRE(arrays.mesh.face_count() == 20);
	REQUIRE(arrays.mesh.fixed.empty());
	REQUIRE(arrays.free_vertices == 12);
	for (std::size_t i = 0; i < 12; ++i) {
		CHECK(arrays.vertices[i] == i);
		for (int k = 0; k < 3; ++k)
			CHECK(arrays.mesh.positions[i][k] == double(mesh.vert[i].cP()[k]));
	}
	for (std::size_t i = 0; i < 20; ++i) {
		for (int k = 0; k < 3; ++k)
			CHECK(
				std::size_t(arrays.mesh.faces[i][std::size_t(k)]) ==
				vcg::tri::Index(mesh, mesh.face[i].V(k)));
	}
}

TEMPLATE_TEST_CASE(
	"deleted elements are left out and stay as they are", "[vcg_adapter]", FloatMesh, DoubleMesh)
{
	TestType mesh;
	vcg::tri::Icosahedron(mesh);
	// Vertex 3 goes, with the five faces around it.
	const auto gone = mesh.vert[3].cP();
	for (auto& face : mesh.face) {
		if (face.V(0) == &mesh.vert[3] || face.V(1) == &mesh.vert[3] || face.V(2) == &mesh.vert[3])
			vcg::tri::Allocator<TestType>::DeleteFace(mesh, face);
	}
	vcg::tri::Allocator<TestType>::DeleteVertex(mesh, mesh.vert[3]);

	const VcgArrays arrays = read_vcg_mesh(mesh);
	REQUIRE(arrays.mesh.vertex_count() == 11);
	REQUIRE(arrays.mesh.face_count() == 15);
	REQUIRE_NOTHROW(validate(arrays.mesh));
	CHECK(arrays.vertices[2] == 2);
	CHECK(arrays.vertices[3] == 4);
	for (std::size_t i = 0; i < arrays.faces.size(); ++i) {
		for (int k = 0; k < 3; ++k) {
			const orthopoly::Index corner = arrays.mesh.faces[i][std::size_t(k)];
			CHECK(
				arrays.vertices[std::size_t(corner)] ==
				vcg::tri::Index(mesh, mesh.face[arrays.faces[i]].V(k)));
		}
	}

	std::vector<Point> moved = arrays.mesh.positions;
	for (Point& position : moved)
		position += Point(1, 2, 3);
	write_positions(mesh, arrays, moved);
	CHECK(mesh.vert[3].cP() == gone);
	CHECK(double(mesh.vert[4].cP()[2]) == Approx(moved[3][2]));
	CHECK(double(mesh.vert[11].cP()[0]) == Approx(moved[10][0]));
}

TEMPLATE_TEST_CASE(
	"a face with a corner that is not there is refused", "[vcg_adapter]", FloatMesh, DoubleMesh)
{
	TestType mesh;
	vcg::tri::Tetrahedron(mesh);
	SECTION("deleted")
	{
		vcg::tri::Allocator<TestType>::DeleteVertex(mesh, mesh.vert[1]);
	}
	SECTION("null")
	{
		mesh.face[1].V(0) = nullptr;
	}
	SECTION("of another mesh")
	{
		TestType other;
		vcg::tri::Tetrahedron(other);
		mesh.face[2].V(0) = &other.vert[0];
		CHECK_THROWS_WITH(read_vcg_mesh(mesh), Catch::Contains("face 2"));
	}
	CHECK_THROWS_AS(read_vcg_mesh(mesh), InvalidMesh);
}

TEST_CASE("only vertices with nothing but selected faces are free", "[vcg_adapter]")
{
	FloatMesh mesh;
	vcg::tri::Grid(mesh, 4, 4, 1, 1);
	SECTION("nothing selected")
	{
		const VcgArrays arrays = read_vcg_mesh(mesh, VcgRegion::SelectedFaces);
		CHECK(arrays.selected_faces == 0);
		CHECK(arrays.free_vertices == 0);
	}
	SECTION("everything selected, one vertex without faces")
	{
		for (FloatFace& face : mesh.face)
			face.SetS();
		vcg::tri::Allocator<FloatMesh>::AddVertex(mesh, vcg::Point3f(5, 5, 5));
		const VcgArrays arrays = read_vcg_mesh(mesh, VcgRegion::SelectedFaces);
		CHECK(arrays.selected_faces == 18);
		CHECK(arrays.free_vertices == 16);
		CHECK(arrays.mesh.is_fixed(16));
	}
	SECTION("one face left out")
	{
		for (std::size_t i = 1; i < mesh.face.size(); ++i)
			mesh.face[i].SetS();
		const VcgArrays arrays = read_vcg_mesh(mesh, VcgRegion::SelectedFaces);
		CHECK(arrays.selected_faces == 17);
		CHECK(arrays.free_vertices == 13);
		for (const orthopoly::Index vertex : arrays.mesh.faces[0])
			CHECK(arrays.mesh.is_fixed(vertex));
	}
}

TEST_CASE("a vertex that did not move keeps its bits", "[vcg_adapter]")
{
	FloatMesh mesh;
	vcg::tri::Tetrahedron(mesh);
	// A zero has a sign, which is lost in most detours.
	mesh.vert[0].P() = vcg::Point3f(-0.0f, 0.1f, std::numeric_limits<float>::denorm_min());
	const vcg::Point3f before = mesh.vert[0].cP();
	const VcgArrays arrays = read_vcg_mesh(mesh);
	std::vector<Point> positions = arrays.mesh.positions;
	positions[0][0] = 0.0;
	positions[1] += Point(1, 0, 0);
	write_positions(mesh, arrays, positions);
	const vcg::Point3f after = mesh.vert[0].cP();
	CHECK(std::memcmp(&before, &after, sizeof before) == 0);
	CHECK(mesh.vert[1].cP()[0] == static_cast<float>(positions[1][0]));
}

TEMPLATE_TEST_CASE("any VCG mesh is denoised in place", "[vcg_adapter]", FloatMesh, DoubleMesh)
{
	TestType mesh;
	make_noisy_grid(mesh);
	const auto before = coordinates(mesh);
	Progress quiet;
	const DenoiseResult expected = denoise(read_vcg_mesh(mesh).mesh, paper(), quiet);

	percents.clear();
	const DenoiseResult result = denoise(mesh, paper(), &record);
	CHECK(result.status == DenoiseResult::Status::Done);
	CHECK(result.moved_vertices > 100);
	CHECK(count_equal(mesh, before) < before.size() / 4);
	using Scalar = typename TestType::ScalarType;
	for (std::size_t i = 0; i < mesh.vert.size(); ++i) {
		for (int k = 0; k < 3; ++k)
			CHECK(mesh.vert[i].cP()[k] == static_cast<Scalar>(expected.positions[i][k]));
	}
	REQUIRE(percents.size() >= 3);
	CHECK(std::is_sorted(percents.begin(), percents.end()));
	CHECK(percents.back() == 100);
}

TEST_CASE("a callback that answers false leaves the mesh alone", "[vcg_adapter]")
{
	DoubleMesh mesh;
	make_noisy_grid(mesh);
	const auto before = coordinates(mesh);
	CHECK(denoise(mesh, paper(), &refuse).status == DenoiseResult::Status::Cancelled);
	CHECK(count_equal(mesh, before) == before.size());
}

TEST_CASE("an error leaves the mesh alone", "[vcg_adapter]")
{
	FloatMesh mesh;
	make_noisy_grid(mesh);
	const auto before = coordinates(mesh);
	DenoiseOptions options = paper();
	options.iterations = 0;
	CHECK_THROWS_AS(denoise(mesh, options), InvalidParameter);
	CHECK(count_equal(mesh, before) == before.size());

	mesh.vert[7].P()[1] = std::numeric_limits<float>::quiet_NaN();
	CHECK_THROWS_WITH(denoise(mesh, paper()), Catch::Contains("vertex 7"));
	CHECK(count_equal(mesh, before) == before.size() - 1);

	FloatMesh points;
	vcg::tri::Allocator<FloatMesh>::AddVertices(points, 5);
	CHECK_THROWS_WITH(denoise(points, paper()), Catch::Contains("5 vertices and no faces"));
}

TEMPLATE_TEST_CASE("only the selected region moves", "[vcg_adapter]", FloatMesh, DoubleMesh)
{
	TestType mesh;
	make_noisy_grid(mesh);
	for (std::size_t i = 0; i < mesh.face.size() / 2; ++i)
		mesh.face[i].SetS();
	const auto before = coordinates(mesh);
	const VcgArrays arrays = read_vcg_mesh(mesh, VcgRegion::SelectedFaces);
	REQUIRE(arrays.free_vertices > 50);
	const DenoiseResult result = denoise(mesh, paper(), nullptr, VcgRegion::SelectedFaces);
	CHECK(result.moved_vertices > 0);
	CHECK(result.moved_vertices <= arrays.free_vertices);
	const auto after = coordinates(mesh);
	for (std::size_t i = 0; i < before.size(); ++i) {
		if (arrays.mesh.fixed[i] != 0)
			CHECK(std::memcmp(&before[i], &after[i], sizeof before[i]) == 0);
	}
}
