// SPDX-License-Identifier: GPL-3.0-or-later
#include "terminal.h"

#include <csignal>
#include <cstdio>
#include <iostream>
#ifdef _WIN32
#include <io.h>
#else
#include <unistd.h>
#endif

namespace orthopoly {

namespace {

constexpr int BAR_WIDTH = 30;

volatile std::sig_atomic_t interrupt_flag = 0;

void on_interrupt(int signal)
{
	interrupt_flag = 1;
	// A second Ctrl-C ends the program the usual way.
	std::signal(signal, SIG_DFL);
}

bool is_terminal()
{
#ifdef _WIN32
	return _isatty(_fileno(stderr)) != 0;
#else
	return isatty(STDERR_FILENO) != 0;
#endif
}

void draw_bar(int percent, const std::string& words)
{
	const int filled = percent * BAR_WIDTH / 100;
	std::cerr << "\r[" << std::string(static_cast<std::size_t>(filled), '#')
			  << std::string(static_cast<std::size_t>(BAR_WIDTH - filled), '.') << "] " << percent
			  << " % " << words << "\x1b[K" << std::flush;
}

} // namespace

void catch_interrupt()
{
	std::signal(SIGINT, on_interrupt);
}

bool interrupted()
{
	return interrupt_flag != 0;
}

Progress terminal_progress()
{
	const bool draw = is_terminal();
	return Progress([draw](int percent, const std::string& words) {
		if (draw)
			draw_bar(percent, words);
		return !interrupted();
	});
}

void clear_progress()
{
	if (is_terminal())
		std::cerr << "\r\x1b[K" << std::flush;
}

} // namespace orthopoly
