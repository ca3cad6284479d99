// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/grid.hpp"
#include "comminute/material.hpp"

namespace comminute {

/// Log size of the smallest grain that crushes among equals under a load, the tip of the zone.
double zone_onset(const Material& material, double log_stress_ratio);

/// The slow crush zone across the cells of one shell, in lengths of bins. With the larger grain at t from its bin's
/// centre, t in [-1/2, 1/2], the zone's half-width is sqrt(steepness (t - tip)), tip the place of its onset.
struct ShellZone {
    double tip;
    double steepness;  ///< k / h; inf where the fabric is off

    /// @param onset  log size at which the zone begins, see zone_onset
    /// @param k      of Eq. 15
    ShellZone(const LogGrid& grid, double onset, double k, Index m)
        : tip((onset - grid.centre(m)) / grid.spacing()), steepness(k / grid.spacing()) {}

    /// Share of the area of the cell at |i - j| = distance that lies inside, with no error but rounding.
    double share(Index distance) const;
    /// Number of distances from 0 on at which certainly the whole cell lies inside.
    Index surely_whole(Index at_most) const;
    /// A distance beyond which all lies outside; -1 where all does.
    Index surely_last(Index at_most) const;
};

}  // namespace comminute
