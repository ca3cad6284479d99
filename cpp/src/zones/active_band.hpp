// SPDX-License-Identifier: BSD-3-Clause
// Active shares of all cells under one load (docs/theory/one_sweep.md, section 3).
#pragma once

#include "base/arrays.hpp"
#include "comminute/criterion.hpp"
#include "comminute/material.hpp"
#include "comminute/scheme.hpp"
#include "zones/shell_zone.hpp"

namespace comminute::detail {

/// Share of each cell that the slow rule moves under one load, shell by shell: 1 up to a distance |i - j|, partial
/// shares in a few cells further out, 0 beyond. Every quasi-static path, under either scheme, reads this one table.
class ActiveBand {
  public:
    ActiveBand(const LogGrid& grid, const Material& material, Scheme scheme);

    /// Removes the load: nothing is active.
    void clear();
    /// Computes the shares under another load; 0 is no load.
    /// @param largest  size that no grain exceeds: where it lies inside a bin, the cells of this bin end there, and their
    ///                 shares are of what they hold; 0 where it is not known
    void set_load(double stress_ratio, double largest = 0.0);

    /// Number of distances, from 0 on, at which the whole cell of shell m moves.
    Index full(Index m) const { return full_[m]; }
    /// Largest distance at which some of the cell moves; -1 where nothing does.
    Index last(Index m) const { return last_[m]; }
    /// Share of the cells of shell m at this distance that moves.
    double share(Index m, Index distance) const {
        if (distance < full(m)) return 1.0;
        if (distance > last(m)) return 0.0;
        return partial_[first_partial_[m] + distance - full(m)];
    }

  private:
    void set_shells(const ShellZones& zones, Index begin);
    void cut_shell(double largest, double log_stress_ratio);

    LogGrid grid_;
    Material material_;
    Scheme scheme_;
    CrushZones zones_;
    Array<Index> full_;           // (N)
    Array<Index> last_;           // (N)
    Array<Index> first_partial_;  // (N) place of the first partial share of each shell
    Array<double> partial_;       // partial shares of all shells, one shell after the other
    Array<double> shares_;        // (rows, lanes) of the shells at hand
};

}  // namespace comminute::detail
