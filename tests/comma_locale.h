// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <catch2/catch.hpp>
#include <clocale>
#include <locale>
#include <string>

namespace orthopoly {

/// While it lives, numbers have a decimal comma and points between the thousands wherever the
/// locale is asked: in the streams of C++ everywhere, in the functions of C where the system has
/// such a locale, and a test says so where it has none.
class CommaLocale {
public:
	CommaLocale() :
			c_before_(std::setlocale(LC_ALL, nullptr)),
			before_(std::locale::global(std::locale(std::locale::classic(), new Comma)))
	{
		for (const char* name : {"de_DE.UTF-8", "fr_FR.UTF-8", "de_DE"}) {
			if (std::setlocale(LC_ALL, name) != nullptr)
				return;
		}
		WARN("no locale with a decimal comma is installed, so only the streams of C++ have one");
	}
	~CommaLocale()
	{
		std::locale::global(before_);
		std::setlocale(LC_ALL, c_before_.c_str());
	}
	CommaLocale(const CommaLocale&) = delete;
	CommaLocale& operator=(const CommaLocale&) = delete;

private:
	struct Comma : std::numpunct<char> {
		char do_decimal_point() const override { return ','; }
		char do_thousands_sep() const override { return '.'; }
		std::string do_grouping() const override { return "\3"; }
	};

	std::string c_before_;
	std::locale before_;
};

} // namespace orthopoly
