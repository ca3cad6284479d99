// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <hwy/cache_control.h>

#include "simd/lanes.hpp"

namespace comminute::detail {

// Loops over arrays of any length and alignment. Arrays that are written overlap no other unless a comment says so.

/// to[k] += factor * from[k], k < count.
void add_scaled(double factor, const double* from, double* to, Index count);

/// Sum of the values. Partial sums are taken by position in a pack, so that the result is the same, bit for bit, whatever
/// registers the machine has.
double sum(const double* values, Index count);

/// Tells whether no value is infinite or NaN.
bool all_finite(const double* values, Index count);

/// Mass that crushes in a row of cells and mass that arrives there.
struct Landing {
    const double* crushing;
    const double* arriving;
    double stays;  ///< share of what crushes that stays in its bin
    double below;  ///< share of what crushes that falls below the grid
};
/// row[k] += arriving[k] + stays crushing[k], fines[k] += below crushing[k], k < count.
void settle_row(Landing landing, double* row, double* fines, Index count);

/// to[c, r] = from[r, c] for r, c < `size`, a multiple of `lanes`: a square of packs each way, its rows to columns.
void transpose(const double* from, Index from_stride, double* to, Index to_stride, Index size = lanes);

/// Asks for a piece of memory that will be wanted soon, at an address that no machine foresees.
inline void fetch(const double* from, Index count) {
    for (Index k = 0; k < count + lanes; k += lanes) hwy::Prefetch(from + k);
}

}  // namespace comminute::detail
