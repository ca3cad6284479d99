// SPDX-License-Identifier: BSD-3-Clause
// Part of a cell that lies inside the zone, exactly (docs/theory/one_sweep.md, section 3).
#pragma once

#include <array>

#include "comminute/grid.hpp"
#include "comminute/material.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {

/// Log size of the smallest grain that crushes among equals under a load, the tip of the zone.
double zone_onset(const Material& material, double log_stress_ratio);

/// The slow crush zone across the cells of the shells, as many shells at a time as there are lanes.
///
/// In lengths of bins, and with the larger grain at t from its bin's centre, t in [-1/2, 1/2], the zone's half-width is
/// omega(t) = sqrt(steepness (t - tip)), tip the place of its onset and steepness k / h, k of Eq. 15.
class ShellZones {
  public:
    using Distances = std::array<Index, lanes>;
    /// Distances |i - j| whose cells surely lie in the zone as a whole, 0 up to less than `whole`, and the largest beyond
    /// which they surely lie outside, -1 where all of them do.
    struct Extents {
        Distances whole;
        Distances last;
    };

    ShellZones(const LogGrid& grid, const Material& material, double log_stress_ratio);

    /// Of the shells from m on; no distance goes beyond a shell's own index.
    Extents extents(Index m) const;
    /// Shares of the areas of cells that lie inside, with no error but rounding: (rows, lanes), those of shell m + lane at
    /// the distances first[lane] + row.
    void shares(Index m, const Distances& first, Index rows, double* share) const;

  private:
    double tip_;  // of shell 0
    double steepness_;
};

}  // namespace comminute::detail
