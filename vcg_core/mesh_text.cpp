// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_text.h"

#include "errors.h"
#include "text_scanner.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <unordered_map>
#include <vector>

namespace orthopoly {

namespace {

const char* const POLYGON_CURE = "; only triangles can be read: triangulate the mesh first";

Point read_point(const TextScanner& line, std::size_t first)
{
	const double x = line.number(first);
	const double y = line.number(first + 1);
	const double z = line.number(first + 2);
	return {x, y, z};
}

// Index of a vertex that is there.
Index checked_index(const TextScanner& line, long long vertex, std::size_t vertex_count)
{
	if (vertex < 0 || vertex >= static_cast<long long>(vertex_count))
		line.fail(
			"the face has vertex index " + std::to_string(vertex) + ", there are " +
			std::to_string(vertex_count) + " vertices");
	return static_cast<Index>(vertex);
}

// A count that a damaged file cannot turn into more memory than the file itself takes.
std::size_t checked_count(const TextScanner& line, std::size_t word, std::string_view text)
{
	const long long count = line.whole_number(word);
	if (count < 0 || count > static_cast<long long>(text.size()))
		line.fail(
			"announces " + std::to_string(count) + " elements in a file of " +
			std::to_string(text.size()) + " bytes");
	return static_cast<std::size_t>(count);
}

void next_line_of(TextScanner& line, const char* element, std::size_t index, std::size_t count)
{
	if (!line.next_line())
		throw FileError(
			"ends at " + std::string(element) + " " + std::to_string(index) + " of " +
			std::to_string(count) + "; the file is cut short");
}

// The vertex an OBJ corner such as 17/3/5 or -1 stands for.
Index obj_vertex(const TextScanner& line, std::size_t word, std::size_t vertex_count)
{
	const std::string_view corner = line.words()[word];
	long long vertex = 0;
	if (!read_number(corner.substr(0, corner.find('/')), vertex) || vertex == 0)
		line.fail(
			"corner " + std::to_string(word) +
			" of the face does not begin with the number of a vertex (1 is the first)");
	const auto count = static_cast<long long>(vertex_count);
	const long long index = vertex > 0 ? vertex - 1 : count + vertex;
	if (index < 0 || index >= count)
		line.fail(
			"the face has vertex index " + std::to_string(vertex) + ", there are " +
			std::to_string(count) + " vertices so far (1 is the first, -1 the last of them)");
	return static_cast<Index>(index);
}

// Collects the loose triangles of an STL file; the same coordinates give the same vertex.
class VertexMerger {
public:
	explicit VertexMerger(TriangleMesh& mesh) : mesh_(mesh) {}

	Index add(const Point& point)
	{
		// Adding zero turns -0 into 0, which is the same place.
		const Key key = {point.x() + 0.0, point.y() + 0.0, point.z() + 0.0};
		const auto [found, is_new] = vertices_.emplace(key, mesh_.vertex_count());
		if (is_new)
			mesh_.positions.push_back(point);
		return found->second;
	}

private:
	using Key = std::array<double, 3>;
	// Bits are compared rather than values, so that one which is not a number equals itself.
	struct SameBits {
		bool operator()(const Key& a, const Key& b) const
		{
			// NOLINTNEXTLINE(bugprone-suspicious-memory-comparison)
			return std::memcmp(a.data(), b.data(), sizeof(Key)) == 0;
		}
	};
	struct Hash {
		std::size_t operator()(const Key& key) const
		{
			return std::hash<std::string_view>()(
				{reinterpret_cast<const char*>(key.data()), sizeof(Key)});
		}
	};

	TriangleMesh& mesh_;
	std::unordered_map<Key, Index, Hash, SameBits> vertices_;
};

TriangleMesh parse_ascii_stl(std::string_view text)
{
	TriangleMesh mesh;
	VertexMerger merger(mesh);
	TextScanner line(text);
	std::vector<Index> loop;
	bool in_loop = false;
	while (line.next_line()) {
		const std::string_view keyword = line.words().front();
		if (keyword == "outer") {
			in_loop = true;
			loop.clear();
		}
		else if (keyword == "vertex") {
			if (!in_loop)
				line.fail("a vertex outside of a loop");
			loop.push_back(merger.add(read_point(line, 1)));
		}
		else if (keyword == "endloop") {
			if (!in_loop || loop.size() != 3)
				line.fail(
					"facet " + std::to_string(mesh.faces.size()) + " has " +
					std::to_string(loop.size()) + " vertices" + POLYGON_CURE);
			mesh.faces.push_back({loop[0], loop[1], loop[2]});
			in_loop = false;
		}
		else if (
			keyword != "facet" && keyword != "endfacet" && keyword != "solid" &&
			keyword != "endsolid") {
			line.fail("is not a line of an STL file");
		}
	}
	if (in_loop)
		throw FileError(
			"ends within facet " + std::to_string(mesh.faces.size()) + "; the file is cut short");
	return mesh;
}

constexpr std::size_t STL_HEADER = 84;
constexpr std::size_t STL_FACET = 50;

// Whole numbers and single precision of a binary STL file are little endian, as every machine this
// runs on.
template<class Number>
Number stl_value(std::string_view content, std::size_t offset)
{
	Number number;
	std::memcpy(&number, content.data() + offset, sizeof(Number));
	return number;
}

TriangleMesh parse_binary_stl(std::string_view content)
{
	TriangleMesh mesh;
	VertexMerger merger(mesh);
	for (std::size_t offset = STL_HEADER; offset < content.size(); offset += STL_FACET) {
		Face face {};
		for (std::size_t k = 0; k < 3; ++k) {
			// The normal comes first.
			const std::size_t corner = offset + 12 * (k + 1);
			face[k] = merger.add(
				{stl_value<float>(content, corner),
				 stl_value<float>(content, corner + 4),
				 stl_value<float>(content, corner + 8)});
		}
		mesh.faces.push_back(face);
	}
	return mesh;
}

void append_point(const Point& point, std::string& text)
{
	append_number(point.x(), text);
	text += ' ';
	append_number(point.y(), text);
	text += ' ';
	append_number(point.z(), text);
	text += '\n';
}

} // namespace

TriangleMesh parse_off(std::string_view text)
{
	TextScanner line(text);
	if (!line.next_line())
		throw FileError("is empty");
	const std::string_view header = line.words().front();
	constexpr std::string_view KEYWORD = "OFF";
	if (header.size() < KEYWORD.size() || header.substr(header.size() - KEYWORD.size()) != KEYWORD)
		line.fail("does not begin with the word OFF");
	const std::string_view prefix = header.substr(0, header.size() - KEYWORD.size());
	if (prefix.find_first_not_of("STCN") != std::string_view::npos)
		line.fail("vertices that do not have three coordinates cannot be read");

	// The counts follow on the next line or on the same one.
	std::size_t first = 1;
	if (line.words().size() == 1) {
		if (!line.next_line())
			throw FileError("ends before the number of vertices; the file is cut short");
		first = 0;
	}
	else if (line.words()[1] == "BINARY") {
		line.fail("binary OFF cannot be read; save it as text");
	}
	const std::size_t vertex_count = checked_count(line, first, text);
	const std::size_t face_count = checked_count(line, first + 1, text);

	TriangleMesh mesh;
	mesh.positions.reserve(vertex_count);
	mesh.faces.reserve(face_count);
	for (std::size_t i = 0; i < vertex_count; ++i) {
		next_line_of(line, "vertex", i, vertex_count);
		mesh.positions.push_back(read_point(line, 0));
	}
	for (std::size_t i = 0; i < face_count; ++i) {
		next_line_of(line, "face", i, face_count);
		const long long corners = line.whole_number(0);
		if (corners != 3)
			line.fail(
				"face " + std::to_string(i) + " has " + std::to_string(corners) + " corners" +
				POLYGON_CURE);
		Face face {};
		for (std::size_t k = 0; k < 3; ++k)
			face[k] = checked_index(line, line.whole_number(k + 1), vertex_count);
		mesh.faces.push_back(face);
	}
	return mesh;
}

TriangleMesh parse_obj(std::string_view text)
{
	TriangleMesh mesh;
	TextScanner line(text);
	bool has_other_lines = false;
	while (line.next_line()) {
		const std::string_view keyword = line.words().front();
		if (keyword == "v") {
			mesh.positions.push_back(read_point(line, 1));
		}
		else if (keyword == "f") {
			const std::size_t corners = line.words().size() - 1;
			if (line.words().back() == "\\" || corners != 3)
				line.fail(
					"face " + std::to_string(mesh.faces.size()) + " has " +
					std::to_string(corners) + " corners" + POLYGON_CURE);
			Face face {};
			for (std::size_t k = 0; k < 3; ++k)
				face[k] = obj_vertex(line, k + 1, mesh.positions.size());
			mesh.faces.push_back(face);
		}
		else {
			has_other_lines = true;
		}
	}
	if (has_other_lines && mesh.positions.empty())
		throw FileError(
			"has no line that begins with v, so it is not an OBJ file with a mesh in it");
	return mesh;
}

TriangleMesh parse_stl(std::string_view content)
{
	// Files of both kinds may begin with the word solid; only a binary one has the size it
	// announces.
	if (content.size() >= STL_HEADER) {
		const std::size_t facets = stl_value<std::uint32_t>(content, STL_HEADER - 4);
		if (content.size() == STL_HEADER + STL_FACET * facets)
			return parse_binary_stl(content);
	}
	constexpr std::string_view KEYWORD = "solid";
	const std::size_t begin = std::min(content.find_first_not_of(" \t\r\n"), content.size());
	if (content.substr(begin, KEYWORD.size()) == KEYWORD)
		return parse_ascii_stl(content);
	if (content.size() < STL_HEADER)
		throw FileError("is too short for an STL file");
	throw FileError(
		"is not an STL file: it does not begin with the word solid, and a binary file of " +
		std::to_string(stl_value<std::uint32_t>(content, STL_HEADER - 4)) +
		" facets would not have " + std::to_string(content.size()) + " bytes; it may be cut short");
}

std::string format_off(const TriangleMesh& mesh)
{
	std::string text = "OFF\n" + std::to_string(mesh.vertex_count()) + " " +
					   std::to_string(mesh.face_count()) + " 0\n";
	for (const Point& point : mesh.positions)
		append_point(point, text);
	for (const Face& face : mesh.faces) {
		text += '3';
		for (const Index vertex : face)
			text += " " + std::to_string(vertex);
		text += '\n';
	}
	return text;
}

std::string format_obj(const TriangleMesh& mesh)
{
	std::string text;
	for (const Point& point : mesh.positions) {
		text += "v ";
		append_point(point, text);
	}
	for (const Face& face : mesh.faces) {
		text += 'f';
		for (const Index vertex : face)
			text += " " + std::to_string(vertex + 1);
		text += '\n';
	}
	return text;
}

} // namespace orthopoly
