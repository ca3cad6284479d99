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

/// The slow crush zone across the cells of shells, a pack of shells at a time.
///
/// In lengths of bins, and with the larger grain at t from its bin's centre, t in [-1/2, 1/2], the zone's half-width is
/// omega(t) = sqrt(steepness (t - tip)), tip the place of its onset and steepness k / h, k of Eq. 15.
class ShellZones {
  public:
    using Distances = std::array<Index, lanes>;
    /// Bounds on the distances |i - j| at which the zone's edge crosses cells, for each shell of a pack.
    struct Extents {
        Distances whole;  ///< cells at smaller distances surely lie in the zone as a whole
        Distances last;   ///< cells at larger distances surely lie outside; -1 where all of them do
    };

    ShellZones(const LogGrid& grid, const Material& material, double log_stress_ratio);

    /// Bounds for the pack of shells from m on, none beyond a shell's own index.
    Extents extents(Index m) const;
    /// Shares of the areas of cells that lie inside, with no error but rounding.
    /// @param share  (rows, lanes) out: shell m + lane at the distance first[lane] + row
    void shares(Index m, const Distances& first, Index rows, double* share) const;

  private:
    double tip_;        // place of the onset, in bins from the centre of bin 0
    double steepness_;  // k / h
};

}  // namespace comminute::detail
