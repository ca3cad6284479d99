// SPDX-License-Identifier: BSD-3-Clause
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

    /// Extents in the shells from m on; no distance goes beyond a shell's own index.
    Extents extents(Index m) const;
    /// Shares of the areas of cells that lie inside, with no error but rounding: (rows, lanes), those of shell m + lane at
    /// the distances first[lane] + row.
    void shares(Index m, const Distances& first, Index rows, double* share) const;

  private:
    double tip_;  // place of the onset in shell 0, in bins from its centre
    double steepness_;
};

}  // namespace comminute::detail
