// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>

#include "simd/lanes.hpp"

namespace comminute::detail {

// Loops over pairs of lines, interleaved as a complex transform takes them: bin i of the two at [2 i] and [2 i + 1].

/// z[q] *= by[q], q < count, complex numbers.
void multiply(double* z, const double* by, Index count);

/// Multiplies bins 1 .. coarsest of both lines by their factors, sets to 0 what is negative, and returns the sum of what
/// is left in either line. NaN stays NaN.
std::array<double, 2> keep_positive(double* pair, Index coarsest, std::array<double, 2> factor);

/// to[i] += line[2 i], i < bins.
void add_line(const double* line, double* to, Index bins);

/// Copies `rows` rows of `lanes` columns into lanes / 2 pairs that lie `distance` apart, and adds each column's mass to
/// `pushed` (lanes).
void gather_columns(const double* columns, Index stride, Index rows, double* pairs, Index distance,
                    double* pushed);

/// Adds lanes / 2 pairs, `distance` apart, to the columns of `out` from `begin` on, as many as `out` has there.
void add_columns(const double* pairs, Index distance, Index rows, MatrixView<double> out, Index begin);

}  // namespace comminute::detail
