// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/lanes.hpp"

namespace comminute::detail {

// Geometry of the slow crush zone in the cells of `lanes` shells side by side, in lengths of bins.
//
// The larger grain of a pair lies at t from its bin's centre, t in [-1/2, 1/2]. Around the diagonal, the zone's half-width
// is omega(t) = sqrt(steepness (t - tip)), with tip the place of its onset and steepness k / h, k of Eq. 15, h the width
// of a bin. The smaller grain's bin lies d bins below; the zone covers the length clamp(1/2 - d - t + omega(t), 0, 1) of
// it, and at d = 0 twice min(omega(t), t + 1/2).

/// Tip and steepness of the zone as seen from shell 0, both finite; from the next shell the tip lies one bin lower.
struct SlowZone {
    double tip;
    double steepness;
};

/// Distances, not whole numbers in general, that bound the zone in each shell from `shell` on.
/// @param inner  (lanes) out: cells with d up to this lie inside as a whole; -1 where none surely does
/// @param outer  (lanes) out: cells with d beyond this lie outside; -1 where all of them do
void zone_widths(SlowZone zone, Index shell, double* inner, double* outer);

/// Shares of the areas of cells that lie in the zone, with no error but rounding, in the shells from `shell` on.
/// @param first  (lanes) distance d of each shell's first cell
/// @param share  (rows, lanes) out: share of the cells at the distances first[lane] + row
void zone_shares(SlowZone zone, Index shell, const double* first, Index rows, double* share);

}  // namespace comminute::detail
