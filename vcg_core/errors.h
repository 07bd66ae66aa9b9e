// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <stdexcept>

namespace orthopoly {

/// Anything this library refuses. The message names the problem, the index or count, and the cure.
class Error : public std::runtime_error {
public:
	using std::runtime_error::runtime_error;
};

/// The mesh cannot be worked on (an index out of range, a coordinate that is not finite, no face).
class InvalidMesh : public Error {
public:
	using Error::Error;
};

/// A parameter is unknown, not finite, out of its range, or at odds with another one.
class InvalidParameter : public Error {
public:
	using Error::Error;
};

/// A file cannot be read or written.
class FileError : public Error {
public:
	using Error::Error;
};

} // namespace orthopoly
