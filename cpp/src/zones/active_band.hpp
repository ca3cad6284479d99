// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "comminute/criterion.hpp"
#include "comminute/material.hpp"
#include "comminute/scheme.hpp"
#include "zones/shell_zone.hpp"

namespace comminute::detail {

/// Share of each cell that the slow rule moves under one load, shell by shell: 1 up to a distance |i - j|, partial
/// shares in a few cells further out, 0 beyond. The one table behind every quasi-static path, of either scheme.
class ActiveBand {
  public:
    ActiveBand(const LogGrid& grid, const Material& material, Scheme scheme);

    /// Goes back to no load, under which nothing is active.
    void clear();
    void set_load(double stress_ratio);

    /// Number of distances, from 0 on, at which cells of shell m move as a whole.
    Index full(Index m) const { return full_[static_cast<std::size_t>(m)]; }
    /// Largest distance at which some of the cell moves; -1 where nothing does.
    Index last(Index m) const { return last_[static_cast<std::size_t>(m)]; }
    double share(Index m, Index distance) const {
        if (distance < full(m)) return 1.0;
        if (distance > last(m)) return 0.0;
        return partial_[static_cast<std::size_t>(first_partial_[static_cast<std::size_t>(m)] + distance -
                                                 full(m))];
    }

  private:
    void set_shells(const ShellZones& zones, Index begin);

    LogGrid grid_;
    Material material_;
    Scheme scheme_;
    CrushZones zones_;
    std::vector<Index> full_;
    std::vector<Index> last_;
    std::vector<Index> first_partial_;
    std::vector<double> partial_;
    std::vector<double> shares_;  // (rows, lanes) of the shells that set_shells() is at; kept for its memory
};

}  // namespace comminute::detail
