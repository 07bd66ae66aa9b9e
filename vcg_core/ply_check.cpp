// SPDX-License-Identifier: GPL-3.0-or-later
#include "ply_check.h"

#include "errors.h"
#include "text_scanner.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace orthopoly {

namespace {

// vcglib reads the header in lines of at most this many characters.
constexpr std::size_t LONGEST_HEADER_LINE = 500;

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
	const std::string_view text = content.substr(0, header.size);
	for (std::size_t begin = 0; begin < text.size();) {
		const std::size_t after = text.find('\n', begin);
		if (after - begin > LONGEST_HEADER_LINE)
			throw FileError("has a header line of more than 500 characters");
		begin = after + 1;
	}

	bool has_format = false;
	TextScanner line(text);
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

/// Reads the values of the body one after the other.
class Body {
public:
	Body(std::string_view content, const Header& header) :
			rest_(content.substr(header.size)), encoding_(header.encoding)
	{
	}

	// Passes over a value that is none of ours. False at the end of the file.
	bool skip(const Type& type)
	{
		long long whole = 0;
		return read(type, whole);
	}

	// A whole number's value goes to `whole`. False at the end of the file.
	bool read(const Type& type, long long& whole)
	{
		return encoding_ == Encoding::Text ? read_word(type, whole) : read_bytes(type, whole);
	}

private:
	bool read_word(const Type& type, long long& whole)
	{
		constexpr std::string_view BLANKS = " \t\r\n\v\f";
		const std::size_t begin = rest_.find_first_not_of(BLANKS);
		if (begin == std::string_view::npos)
			return false;
		const std::size_t end = std::min(rest_.find_first_of(BLANKS, begin), rest_.size());
		const std::string_view word = rest_.substr(begin, end - begin);
		rest_.remove_prefix(end);
		double real = 0;
		if (type.is_whole ? !read_number(word, whole) : !read_number(word, real))
			throw FileError(
				"has a word in its body that is not a number of the type " +
				std::string(type.name));
		return true;
	}

	bool read_bytes(const Type& type, long long& whole)
	{
		if (rest_.size() < type.size)
			return false;
		std::uint64_t bits = 0;
		for (std::size_t i = 0; i < type.size; ++i) {
			const std::size_t at = encoding_ == Encoding::BigEndian ? i : type.size - 1 - i;
			bits = (bits << 8U) | static_cast<unsigned char>(rest_[at]);
		}
		rest_.remove_prefix(type.size);
		const std::uint64_t sign = std::uint64_t(1) << (8 * type.size - 1);
		whole = static_cast<long long>(bits);
		if (type.is_signed && type.size < 8 && (bits & sign) != 0)
			whole -= static_cast<long long>(sign) * 2;
		return true;
	}

	std::string_view rest_;
	Encoding encoding_;
};

bool is_corner_list(const Element& element, const Property& property)
{
	return element.name == "face" && property.length_type != nullptr &&
		   (property.name == "vertex_indices" || property.name == "vertex_index");
}

[[noreturn]] void cut_short(const Element& element, std::size_t index)
{
	throw FileError(
		"ends at " + std::string(element.name) + " " + std::to_string(index) + " of " +
		std::to_string(element.count) + "; the file is cut short");
}

/// Checks one list; false at the end of the file.
bool check_list(Body& body, const Property& property)
{
	long long length = 0;
	if (!body.read(*property.length_type, length))
		return false;
	if (length < 0)
		throw FileError("has a list of " + std::to_string(length) + " values");
	for (long long i = 0; i < length; ++i) {
		if (!body.skip(*property.type))
			return false;
	}
	return true;
}

bool check_corners(Body& body, const Property& property, std::size_t face, std::size_t vertices)
{
	long long length = 0;
	if (!body.read(*property.length_type, length))
		return false;
	if (length != 3)
		throw FileError(
			"face " + std::to_string(face) + " has " + std::to_string(length) +
			" corners; only triangles can be read: triangulate the mesh first");
	for (int k = 0; k < 3; ++k) {
		long long vertex = 0;
		if (!body.read(*property.type, vertex))
			return false;
		if (vertex < 0 || vertex >= static_cast<long long>(vertices))
			throw FileError(
				"face " + std::to_string(face) + " has vertex index " + std::to_string(vertex) +
				", the mesh has " + std::to_string(vertices) +
				" vertices; repair the face list first");
	}
	return true;
}

void check_element(Body& body, const Element& element, std::size_t vertices)
{
	for (std::size_t i = 0; i < element.count; ++i) {
		for (const Property& property : element.properties) {
			bool complete = false;
			if (is_corner_list(element, property))
				complete = check_corners(body, property, i, vertices);
			else if (property.length_type != nullptr)
				complete = check_list(body, property);
			else
				complete = body.skip(*property.type);
			if (!complete)
				cut_short(element, i);
		}
	}
}

} // namespace

PlyCounts check_ply(std::string_view content)
{
	const Header header = read_header(content);
	const PlyCounts counts = {header.count("vertex"), header.count("face")};
	if (header.count("tristrips") > 0 || header.count("range_grid") > 0)
		throw FileError("holds strips or a range grid; save it with a list of triangles instead");
	Body body(content, header);
	for (const Element& element : header.elements)
		check_element(body, element, counts.vertices);
	return counts;
}

} // namespace orthopoly
