// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <charconv>
#include <string>
#include <string_view>

namespace orthopoly {

/// Reads a number that fills the whole token, the same in every locale. False where it does not.
template<class Number>
bool read_number(std::string_view token, Number& number)
{
	// What from_chars leaves out of the C library's grammar, some programs write.
	if (token.size() > 1 && token.front() == '+')
		token.remove_prefix(1);
	const char* end = token.data() + token.size();
	const std::from_chars_result result = std::from_chars(token.data(), end, number);
	return result.ec == std::errc() && result.ptr == end;
}

/// Appends the shortest text that reads back as the same number, the same in every locale.
inline void append_number(double value, std::string& text)
{
	// At most 24 characters.
	std::array<char, 32> buffer {};
	const std::to_chars_result result =
		std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
	text.append(buffer.data(), result.ptr);
}

/// That text by itself.
inline std::string number_text(double value)
{
	std::string text;
	append_number(value, text);
	return text;
}

} // namespace orthopoly
