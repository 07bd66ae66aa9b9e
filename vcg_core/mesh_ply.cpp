// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_ply.h"

#include "errors.h"
#include "text_scanner.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace orthopoly {

namespace {

struct Type {
	std::string_view name;
	std::string_view new_name;
	std::size_t size;
	bool is_whole;
	bool is_signed;
};

constexpr std::array<Type, 8> TYPES = {{
	{"char", "int8", 1, true, true},
	{"uchar", "uint8", 1, true, false},
	{"short", "int16", 2, true, true},
	{"ushort", "uint16", 2, true, false},
	{"int", "int32", 4, true, true},
	{"uint", "uint32", 4, true, false},
	{"float", "float32", 4, false, true},
	{"double", "float64", 8, false, true},
}};

struct Property {
	std::string_view name;
	const Type* type = nullptr;
	// Type of the length of a list; none for a single value.
	const Type* length_type = nullptr;
};

struct Element {
	std::string_view name;
	std::size_t count = 0;
	std::vector<Property> properties;
};

enum class Encoding { Text, LittleEndian, BigEndian };

struct Header {
	Encoding encoding = Encoding::Text;
	std::vector<Element> elements;
	// Where the header ends in the file.
	std::size_t size = 0;

	std::size_t count(std::string_view name) const
	{
		for (const Element& element : elements) {
			if (element.name == name)
				return element.count;
		}
		return 0;
	}
};

const Type& find_type(const TextScanner& line, std::string_view name)
{
	for (const Type& type : TYPES) {
		if (type.name == name || type.new_name == name)
			return type;
	}
	line.fail("has a type that PLY does not know");
}

void need_words(const TextScanner& line, std::size_t count)
{
	if (line.words().size() < count)
		line.fail("the header line is incomplete");
}

Encoding read_encoding(const TextScanner& line)
{
	need_words(line, 3);
	const std::string_view name = line.words()[1];
	if (name == "ascii")
		return Encoding::Text;
	if (name == "binary_little_endian")
		return Encoding::LittleEndian;
	if (name == "binary_big_endian")
		return Encoding::BigEndian;
	line.fail("the format is none of ascii, binary_little_endian, binary_big_endian");
}

Element read_element(const TextScanner& line, std::size_t file_size)
{
	need_words(line, 3);
	const long long count = line.whole_number(2);
	// Every element takes at least one byte.
	if (count < 0 || count > static_cast<long long>(file_size) ||
		count > std::numeric_limits<std::int32_t>::max())
		line.fail(
			"announces " + std::to_string(count) + " elements in a file of " +
			std::to_string(file_size) + " bytes");
	return {line.words()[1], static_cast<std::size_t>(count), {}};
}

Property read_property(const TextScanner& line)
{
	need_words(line, 3);
	if (line.words()[1] != "list")
		return {line.words()[2], &find_type(line, line.words()[1]), nullptr};
	need_words(line, 5);
	const Property property = {
		line.words()[4], &find_type(line, line.words()[3]), &find_type(line, line.words()[2])};
	if (!property.length_type->is_whole)
		line.fail("the length of a list is not a whole number");
	return property;
}

Header read_header(std::string_view content)
{
	constexpr std::string_view END = "end_header";
	if (content.substr(0, 3) != "ply")
		throw FileError("does not begin with the word ply");
	// The body may hold anything, so only lines before the end of the header are looked at.
	const std::size_t end = content.find(END);
	const std::size_t line_end = end == std::string_view::npos ? end : content.find('\n', end);
	if (line_end == std::string_view::npos)
		throw FileError("ends within the header; the file is cut short");

	Header header;
	header.size = line_end + 1;

	bool has_format = false;
	TextScanner line(content.substr(0, header.size));
	line.next_line();
	while (line.next_line()) {
		const std::string_view keyword = line.words().front();
		if (keyword == "format") {
			header.encoding = read_encoding(line);
			has_format = true;
		}
		else if (keyword == "element") {
			header.elements.push_back(read_element(line, content.size()));
		}
		else if (keyword == "property") {
			if (header.elements.empty())
				line.fail("a property before the first element");
			header.elements.back().properties.push_back(read_property(line));
		}
		else if (keyword != "comment" && keyword != "obj_info" && keyword != END) {
			line.fail("is not a line of a PLY header");
		}
	}
	if (!has_format)
		throw FileError("has no format line in its header");
	return header;
}

struct Number {
	double real = 0;
	// The same, where its type is one of whole numbers.
	long long whole = 0;
};

/// Reads the numbers of the body one after the other.
class Body {
public:
	Body(std::string_view content, const Header& header) :
			rest_(content.substr(header.size)), encoding_(header.encoding)
	{
	}

	// False at the end of the file.
	bool read(const Type& type, Number& number)
	{
		return encoding_ == Encoding::Text ? read_word(type, number) : read_bytes(type, number);
	}

private:
	bool read_word(const Type& type, Number& number)
	{
		constexpr std::string_view BLANKS = " \t\r\n\v\f";
		const std::size_t begin = rest_.find_first_not_of(BLANKS);
		if (begin == std::string_view::npos)
			return false;
		const std::size_t end = std::min(rest_.find_first_of(BLANKS, begin), rest_.size());
		const std::string_view word = rest_.substr(begin, end - begin);
		rest_.remove_prefix(end);
		if (type.is_whole ? !read_number(word, number.whole) : !read_number(word, number.real))
			throw FileError(
				"has a word in its body that is not a number of the type " +
				std::string(type.name));
		if (type.is_whole)
			number.real = static_cast<double>(number.whole);
		return true;
	}

	bool read_bytes(const Type& type, Number& number)
	{
		if (rest_.size() < type.size)
			return false;
		std::uint64_t bits = 0;
		for (std::size_t i = 0; i < type.size; ++i) {
			const std::size_t at = encoding_ == Encoding::BigEndian ? i : type.size - 1 - i;
			bits = (bits << 8U) | static_cast<unsigned char>(rest_[at]);
		}
		rest_.remove_prefix(type.size);
		if (type.is_whole) {
			const auto range = static_cast<long long>(1) << (8 * type.size);
			number.whole = static_cast<long long>(bits);
			if (type.is_signed && number.whole >= range / 2)
				number.whole -= range;
			number.real = static_cast<double>(number.whole);
		}
		else if (type.size == sizeof(float)) {
			const auto short_bits = static_cast<std::uint32_t>(bits);
			float value = 0;
			std::memcpy(&value, &short_bits, sizeof(value));
			number.real = value;
		}
		else {
			std::memcpy(&number.real, &bits, sizeof(bits));
		}
		return true;
	}

	std::string_view rest_;
	Encoding encoding_;
};

/// Takes what the elements have to say about the mesh.
class Reader {
public:
	Reader(std::string_view content, const Header& header) :
			body_(content, header), vertex_count_(header.count("vertex"))
	{
		for (const Element& element : header.elements)
			read_element(element);
	}

	TriangleMesh take_mesh() { return std::move(mesh_); }

private:
	void read_element(const Element& element)
	{
		if (element.name == "vertex")
			check_vertex(element);
		if (element.name == "face")
			check_face(element);
		for (std::size_t i = 0; i < element.count; ++i) {
			for (const Property& property : element.properties) {
				const bool complete = property.length_type != nullptr ?
										  read_list(element, property) :
										  read_value(element, property);
				if (!complete)
					throw FileError(
						"ends at " + std::string(element.name) + " " + std::to_string(i) + " of " +
						std::to_string(element.count) + "; the file is cut short");
			}
			if (element.name == "vertex")
				mesh_.positions.push_back(point_);
		}
	}

	static bool is_coordinate(const Property& property)
	{
		return property.length_type == nullptr && axis(property) >= 0;
	}

	// 0 to 2 for a coordinate, else -1.
	static int axis(const Property& property)
	{
		constexpr std::string_view AXES = "xyz";
		return property.name.size() == 1 && AXES.find(property.name) != std::string_view::npos ?
				   static_cast<int>(AXES.find(property.name)) :
				   -1;
	}

	static bool is_corner_list(const Property& property)
	{
		return property.length_type != nullptr && property.type->is_whole &&
			   (property.name == "vertex_indices" || property.name == "vertex_index");
	}

	static void check_vertex(const Element& element)
	{
		const auto coordinates =
			std::count_if(element.properties.begin(), element.properties.end(), is_coordinate);
		if (coordinates != 3)
			throw FileError("has vertices without the properties x, y and z");
	}

	static void check_face(const Element& element)
	{
		const auto lists =
			std::count_if(element.properties.begin(), element.properties.end(), is_corner_list);
		if (element.count > 0 && lists != 1)
			throw FileError("has faces without a list of whole numbers named vertex_indices");
	}

	// These return false at the end of the file.
	bool read_value(const Element& element, const Property& property)
	{
		Number number;
		if (!body_.read(*property.type, number))
			return false;
		if (element.name == "vertex" && is_coordinate(property))
			point_[axis(property)] = number.real;
		return true;
	}

	bool read_list(const Element& element, const Property& property)
	{
		Number length;
		if (!body_.read(*property.length_type, length))
			return false;
		if (length.whole < 0)
			throw FileError("has a list of " + std::to_string(length.whole) + " values");
		if (element.name == "face" && is_corner_list(property))
			return read_corners(property, length.whole);
		Number passed_over;
		for (long long i = 0; i < length.whole; ++i) {
			if (!body_.read(*property.type, passed_over))
				return false;
		}
		return true;
	}

	bool read_corners(const Property& property, long long length)
	{
		const auto face_name = [this]() { return "face " + std::to_string(mesh_.faces.size()); };
		if (length != 3)
			throw FileError(
				face_name() + " has " + std::to_string(length) +
				" corners; only triangles can be read: triangulate the mesh first");
		Face corners {};
		for (Index& corner : corners) {
			Number vertex;
			if (!body_.read(*property.type, vertex))
				return false;
			if (vertex.whole < 0 || vertex.whole >= static_cast<long long>(vertex_count_))
				throw FileError(
					face_name() + " has vertex index " + std::to_string(vertex.whole) +
					", the mesh has " + std::to_string(vertex_count_) +
					" vertices; repair the face list first");
			corner = static_cast<Index>(vertex.whole);
		}
		mesh_.faces.push_back(corners);
		return true;
	}

	Body body_;
	std::size_t vertex_count_;
	Point point_ = Point::Zero();
	TriangleMesh mesh_;
};

} // namespace

TriangleMesh parse_ply(std::string_view content)
{
	const Header header = read_header(content);
	if (header.count("tristrips") > 0 || header.count("range_grid") > 0)
		throw FileError("holds strips or a range grid; save it with a list of triangles instead");
	return Reader(content, header).take_mesh();
}

} // namespace orthopoly
