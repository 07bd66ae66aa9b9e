// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_io.h"

#include "errors.h"
#include "mesh_ply.h"
#include "mesh_text.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <clocale>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <system_error>

#include <vcg/complex/complex.h>

#include <wrap/io_trimesh/export_ply.h>
#include <wrap/io_trimesh/export_stl.h>

namespace orthopoly {

namespace {

class FileVertex;
class FileFace;
struct FileTypes :
		vcg::UsedTypes<vcg::Use<FileVertex>::AsVertexType, vcg::Use<FileFace>::AsFaceType> {};
class FileVertex : public vcg::Vertex<FileTypes, vcg::vertex::Coord3d, vcg::vertex::BitFlags> {};
class FileFace : public vcg::Face<FileTypes, vcg::face::VertexRef, vcg::face::BitFlags> {};
class FileMesh : public vcg::tri::TriMesh<std::vector<FileVertex>, std::vector<FileFace>> {};

using Mask = vcg::tri::io::Mask;

// How files with a certain ending are read and written.
struct Format {
	const char* ending;
	TriangleMesh (*load)(std::string_view content);
	void (*save)(const std::string& path, const TriangleMesh& mesh);
};

void fill(FileMesh& file, const TriangleMesh& mesh)
{
	using Allocator = vcg::tri::Allocator<FileMesh>;
	Allocator::AddVertices(file, mesh.positions.size());
	Allocator::AddFaces(file, mesh.faces.size());
	for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
		const Point& point = mesh.positions[i];
		file.vert[i].P() = FileMesh::CoordType(point.x(), point.y(), point.z());
	}
	for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
		for (int k = 0; k < 3; ++k)
			file.face[i].V(k) =
				&file.vert[static_cast<std::size_t>(mesh.faces[i][static_cast<std::size_t>(k)])];
	}
}

// vcglib does not look whether the last of the file reached the disk.
void check_written(const std::string& path, std::size_t smallest_size)
{
	std::error_code error;
	const std::uintmax_t size = std::filesystem::file_size(path, error);
	if (error || size < smallest_size)
		throw FileError("not everything could be written; is the disk full?");
}

void save_ply(const std::string& path, const TriangleMesh& mesh)
{
	using Exporter = vcg::tri::io::ExporterPLY<FileMesh>;
	constexpr int MASK = Mask::IOM_VERTCOORD | Mask::IOM_FACEINDEX;
	constexpr std::size_t VERTEX_SIZE = 3 * sizeof(double);
	constexpr std::size_t FACE_SIZE = 1 + 3 * sizeof(std::int32_t);
	FileMesh file;
	fill(file, mesh);
	const int error = Exporter::Save(file, path.c_str(), MASK, true);
	if (error != 0)
		throw FileError(Exporter::ErrorMsg(error));
	check_written(path, mesh.positions.size() * VERTEX_SIZE + mesh.faces.size() * FACE_SIZE);
}

void save_stl(const std::string& path, const TriangleMesh& mesh)
{
	using Exporter = vcg::tri::io::ExporterSTL<FileMesh>;
	FileMesh file;
	fill(file, mesh);
	const int error = Exporter::Save(file, path.c_str(), true);
	if (error != 0)
		throw FileError(Exporter::ErrorMsg(error));
	check_written(path, 84 + 50 * mesh.faces.size());
}

void write_text(const std::string& path, const std::string& text)
{
	std::ofstream stream(path, std::ios::binary);
	stream << text;
	stream.close();
	if (!stream)
		throw FileError(std::strerror(errno));
}

void save_off(const std::string& path, const TriangleMesh& mesh)
{
	write_text(path, format_off(mesh));
}

void save_obj(const std::string& path, const TriangleMesh& mesh)
{
	write_text(path, format_obj(mesh));
}

constexpr std::array<Format, 4> FORMATS = {{
	{".ply", parse_ply, save_ply},
	{".obj", parse_obj, save_obj},
	{".off", parse_off, save_off},
	{".stl", parse_stl, save_stl},
}};

const Format& format_of(const std::filesystem::path& path)
{
	std::string ending = path.extension().string();
	std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) {
		return static_cast<char>(std::tolower(c));
	});
	for (const Format& format : FORMATS) {
		if (ending == format.ending)
			return format;
	}
	throw FileError("the name must end in .ply, .obj, .off or .stl");
}

std::string read_file(const std::string& path)
{
	errno = 0;
	std::ifstream stream(path, std::ios::binary);
	if (!stream)
		throw FileError(errno != 0 ? std::strerror(errno) : "cannot be opened");
	std::string content {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
	if (stream.bad() || std::filesystem::is_directory(path))
		throw FileError("cannot be read");
	return content;
}

// vcglib prints numbers by the locale of the program around it.
class PlainNumbers {
public:
	PlainNumbers() : before_(std::setlocale(LC_NUMERIC, nullptr))
	{
		if (before_ != "C")
			std::setlocale(LC_NUMERIC, "C");
	}
	~PlainNumbers()
	{
		if (before_ != "C")
			std::setlocale(LC_NUMERIC, before_.c_str());
	}
	PlainNumbers(const PlainNumbers&) = delete;
	PlainNumbers& operator=(const PlainNumbers&) = delete;

private:
	std::string before_;
};

// A name beside the final one that nobody else uses, so that the rename stays on one disk.
std::filesystem::path temporary_name(const std::filesystem::path& path)
{
	std::random_device random;
	std::filesystem::path name = path;
	name.replace_filename(
		"." + path.filename().string() + "." + std::to_string(random()) + ".part");
	return name;
}

void check_indices(const TriangleMesh& mesh)
{
	for (std::size_t i = 0; i < mesh.faces.size(); ++i) {
		for (const Index vertex : mesh.faces[i]) {
			if (vertex < 0 || vertex >= mesh.vertex_count())
				throw FileError(
					"face " + std::to_string(i) + " has vertex index " + std::to_string(vertex) +
					", the mesh has " + std::to_string(mesh.vertex_count()) + " vertices");
		}
	}
}

// Runs what reads or writes a file and puts the file's name before whatever goes wrong.
template<class Work>
auto naming_the_file(const std::string& path, Work work)
{
	try {
		const PlainNumbers plain_numbers;
		return work();
	}
	catch (const std::bad_alloc&) {
		throw FileError(path + ": there is not enough memory for it");
	}
	catch (const std::exception& error) {
		throw FileError(path + ": " + error.what());
	}
}

} // namespace

TriangleMesh load_mesh(const std::string& path)
{
	return naming_the_file(path, [&]() {
		const Format& format = format_of(path);
		return format.load(read_file(path));
	});
}

void save_mesh(const std::string& path, const TriangleMesh& mesh)
{
	naming_the_file(path, [&]() {
		const Format& format = format_of(path);
		check_indices(mesh);
		// A link stays a link: the file it points at is the one to replace.
		const std::filesystem::path target = std::filesystem::weakly_canonical(path);
		const std::filesystem::path temporary = temporary_name(target);
		try {
			format.save(temporary.string(), mesh);
			std::filesystem::rename(temporary, target);
		}
		catch (...) {
			std::error_code ignored;
			std::filesystem::remove(temporary, ignored);
			throw;
		}
	});
}

void check_savable(const std::string& path)
{
	naming_the_file(path, [&]() {
		format_of(path);
		const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
		if (!std::filesystem::is_directory(folder))
			throw FileError("there is no folder " + folder.string());
	});
}

} // namespace orthopoly
