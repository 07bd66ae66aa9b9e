// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "number_text.h"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace orthopoly {

/// Goes through a text line by line and cuts each line into words. Blank lines and what follows a
/// '#' are left out.
class TextScanner {
public:
	explicit TextScanner(std::string_view text) : text_(text) {}

	/// Moves on to the next line that has words; false at the end.
	bool next_line();
	const std::vector<std::string_view>& words() const { return words_; }

	/// "line 17: ..."; throws FileError.
	[[noreturn]] void fail(const std::string& what) const;

	/// The number in word k of the line; throws FileError where there is none.
	double number(std::size_t k) const;
	long long whole_number(std::size_t k) const;

private:
	void require(std::size_t k) const;

	std::string_view text_;
	std::size_t position_ = 0;
	std::size_t line_ = 0;
	std::vector<std::string_view> words_;
};

} // namespace orthopoly
