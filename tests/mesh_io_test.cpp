// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_io.h"

#include "comma_locale.h"
#include "defects.h"
#include "errors.h"
#include "mesh_ply.h"
#include "mesh_text.h"
#include "noise.h"
#include "recipes.h"
#include "shapes.h"
#include "test_support.h"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

using namespace orthopoly;
using Catch::Contains;

namespace {

// A folder that goes away with its contents.
class TemporaryFolder {
public:
	TemporaryFolder() :
			path_(
				std::filesystem::temp_directory_path() /
				("orthopoly_test_" + std::to_string(std::random_device()())))
	{
		std::filesystem::create_directory(path_);
	}
	~TemporaryFolder()
	{
		std::error_code ignored;
		std::filesystem::remove_all(path_, ignored);
	}
	TemporaryFolder(const TemporaryFolder&) = delete;
	TemporaryFolder& operator=(const TemporaryFolder&) = delete;

	std::string file(const std::string& name) const { return (path_ / name).string(); }

	std::string write(const std::string& name, const std::string& content) const
	{
		std::ofstream(file(name), std::ios::binary) << content;
		return file(name);
	}

	std::size_t count() const
	{
		return static_cast<std::size_t>(std::distance(
			std::filesystem::directory_iterator(path_), std::filesystem::directory_iterator()));
	}

private:
	std::filesystem::path path_;
};

std::string content_of(const std::string& path)
{
	std::ifstream stream(path, std::ios::binary);
	return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

// A PLY file as another program might write it.
template<class Real>
std::string binary_ply(const TriangleMesh& mesh, bool big_endian)
{
	std::ostringstream out;
	out << "ply\nformat " << (big_endian ? "binary_big_endian" : "binary_little_endian")
		<< " 1.0\ncomment made by hand\nelement vertex " << mesh.vertex_count();
	for (const char* axis : {"x", "y", "z"})
		out << "\nproperty " << (sizeof(Real) == 4 ? "float " : "double ") << axis;
	out << "\nproperty uchar red\nelement face " << mesh.face_count()
		<< "\nproperty list uchar int vertex_indices\nend_header\n";
	const auto put = [&](auto value) {
		std::string bytes(reinterpret_cast<const char*>(&value), sizeof(value));
		if (big_endian)
			std::reverse(bytes.begin(), bytes.end());
		out << bytes;
	};
	for (const Point& point : mesh.positions) {
		for (int axis = 0; axis < 3; ++axis)
			put(static_cast<Real>(point[axis]));
		put(std::uint8_t(200));
	}
	for (const Face& face : mesh.faces) {
		put(std::uint8_t(3));
		for (const Index vertex : face)
			put(vertex);
	}
	return out.str();
}

const std::string ASCII_HEADER =
	"ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
	"property double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";

TriangleMesh uneven(double scale)
{
	TriangleMesh mesh = placed(make_part(1000), scale, scale * Point(0.1, 1.0 / 3, -7));
	NoiseOptions options;
	mesh.positions = add_noise(mesh, options);
	return mesh;
}

} // namespace

TEST_CASE("every coordinate survives PLY, OBJ and OFF bit for bit, in the same order", "[mesh_io]")
{
	const TemporaryFolder folder;
	const std::string ending = GENERATE("ply", "obj", "off");
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	const TriangleMesh mesh = uneven(scale);
	const std::string path = folder.file("mesh." + ending);
	save_mesh(path, mesh);
	const TriangleMesh loaded = load_mesh(path);
	CHECK(same_bits(loaded.positions, mesh.positions));
	CHECK(loaded.faces == mesh.faces);
	// Nothing else is left in the folder.
	CHECK(folder.count() == 1);
}

TEST_CASE("STL keeps the shape in single precision", "[mesh_io]")
{
	const TemporaryFolder folder;
	const double scale = GENERATE(1e-6, 1.0, 1e6);
	const TriangleMesh mesh = uneven(scale);
	save_mesh(folder.file("mesh.stl"), mesh);
	const TriangleMesh loaded = load_mesh(folder.file("mesh.stl"));
	REQUIRE(loaded.face_count() == mesh.face_count());
	// Every vertex of the part is used, so each comes back once.
	CHECK(loaded.vertex_count() == mesh.vertex_count());
	for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
		for (std::size_t k = 0; k < 3; ++k) {
			const Point& before = mesh.positions[static_cast<std::size_t>(mesh.faces[i][k])];
			const Point& after = loaded.positions[static_cast<std::size_t>(loaded.faces[i][k])];
			REQUIRE((before - after).norm() < 1e-6 * before.norm());
		}
	}
	// Vertices are numbered by their first mention.
	CHECK(loaded.faces[0] == Face {0, 1, 2});
}

TEST_CASE("all defects survive a file, those that no method accepts included", "[mesh_io]")
{
	const TemporaryFolder folder;
	const std::string ending = GENERATE("ply", "obj", "off");
	for (const Recipe& recipe : recipes()) {
		CAPTURE(recipe.name, ending);
		const TriangleMesh mesh = recipe.make(500);
		const std::string path = folder.file(recipe.name + "." + ending);
		save_mesh(path, mesh);
		const TriangleMesh loaded = load_mesh(path);
		CHECK(loaded.faces == mesh.faces);
		REQUIRE(loaded.positions.size() == mesh.positions.size());
		for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
			for (int axis = 0; axis < 3; ++axis) {
				const double before = mesh.positions[i][axis];
				const double after = loaded.positions[i][axis];
				CHECK((after == before || (std::isnan(before) && std::isnan(after))));
			}
		}
	}
}

TEST_CASE("PLY of both precisions and byte orders", "[mesh_io]")
{
	const TemporaryFolder folder;
	const TriangleMesh mesh = make_part(1000);
	const bool big_endian = GENERATE(false, true);
	const TriangleMesh exact =
		load_mesh(folder.write("double.ply", binary_ply<double>(mesh, big_endian)));
	CHECK(same_bits(exact.positions, mesh.positions));
	CHECK(exact.faces == mesh.faces);
	const TriangleMesh single =
		load_mesh(folder.write("float.ply", binary_ply<float>(mesh, big_endian)));
	for (std::size_t i = 0; i < mesh.positions.size(); ++i)
		REQUIRE((single.positions[i] == mesh.positions[i].cast<float>().cast<double>()));
	CHECK(single.faces == mesh.faces);
}

TEST_CASE("PLY coordinates of whole numbers keep their sign", "[mesh_io]")
{
	std::string content =
		"ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty short y\n"
		"property uchar z\nend_header\n";
	content += std::string("\xfe\x00\x80\xff", 4);
	const TriangleMesh mesh = parse_ply(content);
	REQUIRE(mesh.vertex_count() == 1);
	CHECK((mesh.positions[0] == Point(-2, -32768, 255)));
}

TEST_CASE("PLY as text, with comments, other properties and other elements", "[mesh_io]")
{
	const TemporaryFolder folder;
	const std::string header =
		"ply\r\nformat ascii 1.0\r\ncomment a comment\r\nobj_info and more\r\n"
		"element vertex 4\r\nproperty double x\r\nproperty double y\r\nproperty double z\r\n"
		"property uchar red\r\nelement material 1\r\nproperty float shine\r\n"
		"element face 2\r\nproperty list uchar int vertex_index\r\nproperty uchar flags2\r\n"
		"end_header\r\n";
	const TriangleMesh mesh = load_mesh(folder.write(
		"text.ply",
		header +
			"0 0 0 1\r\n1e0 0 0 2\r\n+1 1 -0.0 3\r\n0 1 .5 4\r\n0.25\r\n3 0 1 2 9\r\n3 0 2 3 9\r\n"));
	REQUIRE(mesh.vertex_count() == 4);
	CHECK((mesh.positions[3] == Point(0, 1, 0.5)));
	CHECK(mesh.faces == std::vector<Face> {{0, 1, 2}, {0, 2, 3}});
}

TEST_CASE("points without faces load from every format that has them", "[mesh_io]")
{
	const TemporaryFolder folder;
	const TriangleMesh ply = load_mesh(folder.write(
		"points.ply",
		"ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
		"property float z\nend_header\n1 2 3\n4 5 6\n"));
	CHECK(ply.vertex_count() == 2);
	CHECK(ply.faces.empty());
	CHECK(load_mesh(folder.write("points.obj", "v 1 2 3\nv 4 5 6\n")).vertex_count() == 2);
	CHECK(load_mesh(folder.write("points.off", "OFF\n2 0 0\n1 2 3\n4 5 6\n")).vertex_count() == 2);
}

TEST_CASE("OFF in the shapes it comes in", "[mesh_io]")
{
	const std::string text = GENERATE(
		"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n",
		"OFF 3 1\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2",
		"# made by hand\n\nOFF\n# counts\n3 1 3\n\n0 0 0\n1 0 0 # second\n0 1 0\n3 0 1 2 255 0 0\n",
		"COFF\r\n3 1 0\r\n0 0 0 255 0 0 255\r\n1 0 0 1 2 3 4\r\n0 1 0 1 2 3 4\r\n3  0 1\t2\r\n",
		"STCNOFF\n3 1 0\n0 0 0 9 9 9\n1 0 0 9 9 9\n0 1 0 9 9 9\n3 0 1 2\n");
	const TriangleMesh mesh = parse_off(text);
	CHECK(mesh.positions == std::vector<Point> {Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0)});
	CHECK(mesh.faces == std::vector<Face> {{0, 1, 2}});
}

TEST_CASE("OBJ in the shapes it comes in", "[mesh_io]")
{
	const std::string corners =
		GENERATE("1 2 3", "1/5 2/6 3/7", "1//1 2//2 3//3", "1/1/1 2/2/2 3/3/3", "-3 -2 -1");
	const std::string text = "# comment\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 0.5 0.5 0.5\n"
							 "v 0 1 0 # third\nvt 0 0\nvn 0 0 1\ng group\nusemtl m\ns off\nf " +
							 corners + "\n";
	const TriangleMesh mesh = parse_obj(text);
	CHECK(mesh.positions == std::vector<Point> {Point(0, 0, 0), Point(1, 0, 0), Point(0, 1, 0)});
	CHECK(mesh.faces == std::vector<Face> {{0, 1, 2}});
}

TEST_CASE("STL text, in double precision and with shared corners", "[mesh_io]")
{
	const std::string text =
		"solid one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.00000000001 0 0\n"
		"   vertex 0 1 0\n  endloop\n endfacet\nendsolid one\nsolid two\n facet normal 0 0 1\n"
		"  outer loop\n   vertex 1.00000000001 0 -0\n   vertex 1 1 0\n   vertex 0 1 0\n  endloop\n"
		" endfacet\nendsolid two\n";
	const TriangleMesh mesh = parse_stl(text);
	REQUIRE(mesh.vertex_count() == 4);
	CHECK(mesh.positions[1].x() == 1.00000000001);
	CHECK(mesh.faces == std::vector<Face> {{0, 1, 2}, {1, 3, 2}});
	CHECK(parse_stl("solid empty\nendsolid\n").faces.empty());
}

TEST_CASE("a binary STL file may begin with the word solid", "[mesh_io]")
{
	const TemporaryFolder folder;
	save_mesh(folder.file("a.stl"), tetrahedron());
	std::string content = content_of(folder.file("a.stl"));
	content.replace(0, 6, "solid ");
	const TriangleMesh mesh = parse_stl(content);
	CHECK(mesh.vertex_count() == 4);
	CHECK(mesh.face_count() == 4);
}

TEST_CASE("polygons are refused with the face and the cure", "[mesh_io]")
{
	const TemporaryFolder folder;
	const std::string name = GENERATE("quad.ply", "quad.obj", "quad.off", "quad.stl");
	std::string text;
	if (name == "quad.ply") {
		text = ASCII_HEADER;
		text.replace(text.find("vertex 3"), 8, "vertex 4");
		text += "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
	}
	else if (name == "quad.obj") {
		text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n";
	}
	else if (name == "quad.off") {
		text = "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n";
	}
	else {
		text = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\n"
			   "vertex 0 1 0\nendloop\nendfacet\nendsolid\n";
	}
	const std::string path = folder.write(name, text);
	CHECK_THROWS_AS(load_mesh(path), FileError);
	CHECK_THROWS_WITH(
		load_mesh(path), Contains(name) && Contains(" 0 has 4 ") && Contains("triangulate"));
}

TEST_CASE("damaged files are refused with what is wrong and where", "[mesh_io]")
{
	struct Case {
		const char* name;
		std::string content;
		const char* message;
	};
	const Case damaged = GENERATE_COPY(values<Case>({
		{"empty.ply", "", "ply"},
		{"other.ply", "solid\n", "ply"},
		{"header.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", "cut short"},
		{"format.ply", "ply\nelement vertex 0\nend_header\n", "format"},
		{"kind.ply", "ply\nformat ebcdic 1.0\nend_header\n", "line 2"},
		{"count.ply", "ply\nformat ascii 1.0\nelement vertex many\nend_header\n", "'many'"},
		{"negative.ply", "ply\nformat ascii 1.0\nelement vertex -5\nend_header\n", "-5"},
		{"huge.ply",
		 "ply\nformat ascii 1.0\nelement vertex 2000000000\nend_header\n",
		 "2000000000"},
		{"nocount.ply", "ply\nformat ascii 1.0\nelement vertex\nend_header\n", "incomplete"},
		{"type.ply",
		 "ply\nformat ascii 1.0\nelement vertex 0\nproperty real x\nend_header\n",
		 "line 4"},
		{"orphan.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n", "before the first"},
		{"noxyz.ply",
		 "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
		 "x, y and z"},
		{"nolist.ply",
		 "ply\nformat ascii 1.0\nelement face 1\nproperty float quality\nend_header\n1\n",
		 "vertex_indices"},
		{"strips.ply",
		 "ply\nformat ascii 1.0\nelement tristrips 1\nproperty list int int "
		 "vertex_indices\nend_header\n0\n",
		 "strips"},
		{"body.ply", ASCII_HEADER + "0 0 0\n1 0 0\n", "vertex 2 of 3"},
		{"word.ply", ASCII_HEADER + "0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n", "not a number"},
		{"index.ply", ASCII_HEADER + "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "face 0 has vertex index 3"},
		{"below.ply", ASCII_HEADER + "0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n", "index -1"},
		{"face.ply", ASCII_HEADER + "0 0 0\n1 0 0\n0 1 0\n3 0 1", "face 0 of 1"},
		{"empty.off", "", "empty"},
		{"other.off", "ply\n", "OFF"},
		{"4.off", "4OFF\n0 0 0\n", "three coordinates"},
		{"binary.off", "OFF BINARY\n", "binary"},
		{"nocount.off", "OFF\n", "cut short"},
		{"huge.off", "OFF\n2000000000 1 0\n", "2000000000"},
		{"negative.off", "OFF\n-1 1 0\n", "-1"},
		{"vertex.off", "OFF\n2 0 0\n0 0 0\n", "vertex 1 of 2"},
		{"short.off", "OFF\n2 0 0\n0 0 0\n0 0\n", "line 4"},
		{"word.off", "OFF\n1 0 0\n0 x 0\n", "'x'"},
		{"index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 5\n", "index 5"},
		{"face.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", "face 1 of 2"},
		{"other.obj", "this is not a mesh\n", "begins with v"},
		{"word.obj", "v 0 0 zero\n", "'zero'"},
		{"index.obj",
		 "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
		 "line 4: the face has vertex index 4"},
		{"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", "line 4"},
		{"below.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 1 2\n", "vertex index -4, there are 3"},
		{"text.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf a b c\n", "line 4"},
		{"empty.stl", "", "too short"},
		{"other.stl", std::string(200, 'x'), "not an STL file"},
		{"word.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 q\n", "'q'"},
		{"cut.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n", "cut short"},
		{"loop.stl", "solid\nvertex 0 0 0\n", "outside of a loop"},
		{"line.stl", "solid\nnonsense\n", "line 2"},
	}));
	CAPTURE(damaged.name);
	const TemporaryFolder folder;
	const std::string path = folder.write(damaged.name, damaged.content);
	CHECK_THROWS_AS(load_mesh(path), FileError);
	CHECK_THROWS_WITH(load_mesh(path), Contains(damaged.name) && Contains(damaged.message));
}

TEST_CASE("a file cut short anywhere is refused or loads, and never crashes", "[mesh_io]")
{
	const TemporaryFolder folder;
	const std::string ending = GENERATE("ply", "off", "obj", "stl");
	const std::string path = folder.file("whole." + ending);
	save_mesh(path, make_cube(48));
	const std::string content = content_of(path);
	std::size_t refused = 0;
	for (std::size_t size = 0; size < content.size(); size += 3) {
		const std::string cut = folder.write("cut." + ending, content.substr(0, size));
		try {
			const TriangleMesh mesh = load_mesh(cut);
			CHECK(mesh.face_count() <= 48);
		}
		catch (const FileError&) {
			++refused;
		}
	}
	// Every cut of a counted format shows; OBJ has no count to hold the file to.
	if (ending == "ply" || ending == "stl")
		CHECK(refused == (content.size() + 2) / 3);
}

TEST_CASE("a file with bytes changed is refused or loads, and never crashes", "[mesh_io]")
{
	const TemporaryFolder folder;
	const std::string ending = GENERATE("ply", "off", "obj", "stl");
	const std::string path = folder.file("whole." + ending);
	save_mesh(path, make_cube(48));
	const std::string content = content_of(path);
	std::mt19937 random(1);
	int loaded = 0;
	for (int round = 0; round < 400; ++round) {
		std::string changed = content;
		for (int i = 0; i < 3; ++i)
			changed[random() % changed.size()] = static_cast<char>(random() % 256);
		// Headers are where a reader goes astray, so they get more than their share.
		changed[random() % std::min<std::size_t>(changed.size(), 150)] =
			static_cast<char>(random() % 256);
		try {
			const TriangleMesh mesh = load_mesh(folder.write("changed." + ending, changed));
			++loaded;
			for (const Face& face : mesh.faces) {
				for (const Index vertex : face)
					REQUIRE((vertex >= 0 && vertex < mesh.vertex_count()));
			}
		}
		catch (const FileError&) {
		}
	}
	CHECK(loaded < 400);
}

TEST_CASE("the list of a PLY face cannot overrun the reader", "[mesh_io]")
{
	// Lengths of four bytes reach far beyond what the reader sets aside.
	std::string text = ASCII_HEADER;
	text.replace(text.find("uchar int"), 9, "int int");
	const TemporaryFolder folder;
	CHECK_THROWS_WITH(
		load_mesh(folder.write("long.ply", text + "0 0 0\n1 0 0\n0 1 0\n100000 0 1 2\n")),
		Contains("100000 corners"));
	CHECK_THROWS_AS(
		load_mesh(folder.write("negative.ply", text + "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n")),
		FileError);
}

TEST_CASE("missing files, folders and endings are named", "[mesh_io]")
{
	const TemporaryFolder folder;
	CHECK_THROWS_WITH(
		load_mesh(folder.file("none.ply")), Contains("none.ply") && Contains("No such"));
	CHECK_THROWS_WITH(load_mesh(folder.file("mesh.vrml")), Contains(".ply, .obj, .off or .stl"));
	CHECK_THROWS_AS(load_mesh(""), FileError);
	std::filesystem::create_directory(folder.file("folder.ply"));
	CHECK_THROWS_AS(load_mesh(folder.file("folder.ply")), FileError);
	CHECK_THROWS_AS(save_mesh(folder.file("none/mesh.ply"), tetrahedron()), FileError);
	CHECK_THROWS_WITH(save_mesh(folder.file("mesh.xyz"), tetrahedron()), Contains("mesh.xyz"));
	CHECK_THROWS_WITH(check_savable(folder.file("none/mesh.ply")), Contains("no folder"));
	CHECK_THROWS_AS(check_savable(folder.file("mesh.xyz")), FileError);
	CHECK_NOTHROW(check_savable(folder.file("mesh.PLY")));
	CHECK(folder.count() == 1);
}

TEST_CASE("a save that fails leaves the file that was there", "[mesh_io]")
{
	const TemporaryFolder folder;
	const std::string path = folder.file("mesh.ply");
	save_mesh(path, tetrahedron());
	const std::string before = content_of(path);
	TriangleMesh broken = unit_square();
	broken.faces[1][2] = 9;
	CHECK_THROWS_WITH(save_mesh(path, broken), Contains("face 1") && Contains("index 9"));
	CHECK(content_of(path) == before);
	// Where a folder is in the way, the rename fails after all has been written.
	std::filesystem::create_directories(folder.file("taken.off/inside"));
	CHECK_THROWS_AS(save_mesh(folder.file("taken.off"), tetrahedron()), FileError);
	CHECK(folder.count() == 2);
}

TEST_CASE("an existing file is replaced, a link stays a link", "[mesh_io]")
{
	const TemporaryFolder folder;
	save_mesh(folder.file("a.off"), unit_square());
	std::filesystem::create_symlink("a.off", folder.file("link.off"));
	save_mesh(folder.file("link.off"), tetrahedron());
	CHECK(std::filesystem::is_symlink(folder.file("link.off")));
	CHECK(load_mesh(folder.file("a.off")).face_count() == 4);
}

TEST_CASE("files do not depend on the locale", "[mesh_io]")
{
	const CommaLocale comma;
	const std::string locale = std::setlocale(LC_ALL, nullptr);
	const TemporaryFolder folder;
	const TriangleMesh mesh = uneven(1);
	for (const char* name : {"a.ply", "a.obj", "a.off"}) {
		CAPTURE(name);
		save_mesh(folder.file(name), mesh);
		CHECK(same_bits(load_mesh(folder.file(name)).positions, mesh.positions));
	}
	const TriangleMesh text =
		load_mesh(folder.write("text.ply", ASCII_HEADER + "0.5 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"));
	CHECK(text.positions[0].x() == 0.5);
	// More than 999 elements: a locale may put something between the digits of their numbers.
	CHECK(mesh.vertex_count() + mesh.face_count() > 999);
	CHECK(std::setlocale(LC_ALL, nullptr) == locale);
}
