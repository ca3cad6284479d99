// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/lanes.hpp"

namespace comminute::detail {

// Loops over square tables whose rows are `stride` apart, a multiple of `lanes`, with zeros beyond their end.

/// Two tables whose product is wanted, the second of which ends, row by row, further and further right.
struct LowerProduct {
    const double* from;    ///< (rows, stride), of which the first `terms` columns are used
    const Index* column;   ///< (terms) last column of each row of `factor`, rising
    const double* factor;  ///< (terms, stride) 0 beyond that
    Index terms;
    Index stride;
};
/// to[z, j] = sum over t of from[z, t] factor[t, j], for z < rows and j < stride.
void multiply_lower(const LowerProduct& product, double* to, Index rows);

/// table[i, j] += table[j, i] for i, j < size, a multiple of `lanes`; the sum is the same in both places to the bit.
void add_transposed(double* table, Index stride, Index size);

/// row[k] = row[k] (1 - (left + leaves[k])) + arriving[k], k < count.
void replace_neighbours(double left, const double* leaves, const double* arriving, double* row, Index count);

}  // namespace comminute::detail
