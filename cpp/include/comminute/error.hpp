// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <stdexcept>
#include <string>

#include "comminute/export.hpp"

namespace comminute {

/// A parameter outside its range. The message gives its name, its value and the rule.
class COMMINUTE_API ParameterError : public std::invalid_argument {
  public:
    using std::invalid_argument::invalid_argument;
};

/// An array whose shape, layout or overlap does not fit. The message gives both shapes.
class COMMINUTE_API ShapeError : public std::invalid_argument {
  public:
    using std::invalid_argument::invalid_argument;
};

/// A part of the library that this build leaves out. The message says how to get it.
class COMMINUTE_API UnavailableError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

/// Shortest decimal text that reads back as the same number.
COMMINUTE_API std::string text(double value);
/// Six significant digits: for numbers that were computed, and would show their rounding.
COMMINUTE_API std::string rounded(double value);

/// Throws ParameterError "<parameter> is <value>; it must be <rule>" unless `ok`.
///
/// @code{.cpp}
/// comminute::require(3.0 > 0.0, "weibull_modulus", 3.0, "greater than 0");
/// CHECK_THROWS_WITH_AS(comminute::require(false, "bins", 4, "at least 8"),
///                      "bins is 4; it must be at least 8", comminute::ParameterError);
/// @endcode
COMMINUTE_API void require(bool ok, const char* parameter, double value, const char* rule);

}  // namespace comminute
