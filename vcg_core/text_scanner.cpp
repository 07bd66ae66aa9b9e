// SPDX-License-Identifier: GPL-3.0-or-later
#include "text_scanner.h"

#include "errors.h"

#include <algorithm>

namespace orthopoly {

namespace {

constexpr std::string_view BLANKS = " \t\r\v\f";

// A damaged file may have anything in it; a message shows no more of it than this.
constexpr std::size_t LONGEST_QUOTE = 40;

std::string quoted(std::string_view word)
{
	std::string text = "'";
	for (const char c : word.substr(0, LONGEST_QUOTE))
		text += c >= ' ' && c <= '~' ? c : '?';
	return text + "'";
}

} // namespace

bool TextScanner::next_line()
{
	words_.clear();
	while (words_.empty() && position_ < text_.size()) {
		const std::size_t end = std::min(text_.find('\n', position_), text_.size());
		std::string_view line = text_.substr(position_, end - position_);
		position_ = end + 1;
		++line_;
		line = line.substr(0, line.find('#'));
		for (std::size_t begin = line.find_first_not_of(BLANKS); begin != std::string_view::npos;
			 begin = line.find_first_not_of(BLANKS, begin)) {
			const std::size_t after = std::min(line.find_first_of(BLANKS, begin), line.size());
			words_.push_back(line.substr(begin, after - begin));
			begin = after;
		}
	}
	return !words_.empty();
}

void TextScanner::fail(const std::string& what) const
{
	throw FileError("line " + std::to_string(line_) + ": " + what);
}

void TextScanner::require(std::size_t k) const
{
	if (k >= words_.size())
		fail(
			"has " + std::to_string(words_.size()) + " words, at least " + std::to_string(k + 1) +
			" are needed");
}

double TextScanner::number(std::size_t k) const
{
	require(k);
	double value = 0;
	if (!read_number(words_[k], value))
		fail(quoted(words_[k]) + " is not a number");
	return value;
}

long long TextScanner::whole_number(std::size_t k) const
{
	require(k);
	long long value = 0;
	if (!read_number(words_[k], value))
		fail(quoted(words_[k]) + " is not a whole number");
	return value;
}

} // namespace orthopoly
