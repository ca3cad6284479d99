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

/// The slow crush zone under one load across the cells of the shells, `lanes` shells at a time. simd/zone_shares.hpp has
/// its geometry; the limits of a zone that reaches everything, or has no width, are here.
class ShellZones {
  public:
    using Distances = std::array<Index, lanes>;
    /// Distances |i - j| that bound the zone in each shell.
    struct Extents {
        Distances whole;  ///< cells nearer than this surely lie in the zone as a whole
        Distances last;   ///< cells further out than this surely lie outside; -1 where all of them do
    };

    ShellZones(const LogGrid& grid, const Material& material, double log_stress_ratio);

    /// Tells whether all of the pack of shells from m on surely lie outside.
    bool none(Index m) const { return tip_ >= static_cast<double>(m + lanes) - 0.5; }
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
