// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string_view>

namespace orthopoly {

/// What a PLY file holds, by its header.
struct PlyCounts {
	std::size_t vertices = 0;
	std::size_t faces = 0;
};

/// Goes through the whole of a PLY file (text or binary, either byte order) and throws FileError,
/// saying where and what, for everything that vcglib's reader takes on trust: counts that the file
/// has no room for, words that are not numbers, faces that are not triangles, vertex indices that
/// are out of range, an end before the last element.
PlyCounts check_ply(std::string_view content);

} // namespace orthopoly
