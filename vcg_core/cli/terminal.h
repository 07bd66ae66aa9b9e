// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "progress.h"

namespace orthopoly {

/// Turns Ctrl-C into a request to stop, which a progress made by `terminal_progress` passes on.
void catch_interrupt();

/// True once Ctrl-C was pressed.
bool interrupted();

/// Draws a bar on the standard error stream where that is a terminal, and stops on Ctrl-C.
Progress terminal_progress();

/// Takes the bar away again.
void clear_progress();

} // namespace orthopoly
