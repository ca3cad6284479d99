// SPDX-License-Identifier: BSD-3-Clause
// Shares of the cells of a narrow band that move (docs/theory/one_sweep.md, sections 4 and 15).
#pragma once

#include <algorithm>
#include <utility>

#include "base/arrays.hpp"
#include "simd/narrow_band.hpp"
#include "sweeping/mass_check.hpp"
#include "zones/active_band.hpp"

namespace comminute::detail {

/// The zones before and after a load, and the shares of every cell that moves when the one grows to the other.
class ZonePair {
  public:
    ZonePair(const LogGrid& grid, const Material& material, Scheme scheme);

    /// Begins anew for another material, in the memory at hand.
    void set_material(const LogGrid& grid, const Material& material, Scheme scheme);
    /// Moves to other loads; costs nothing where they are the same.
    /// @param settled_at  load under which the state is at rest; 0: none
    /// @param largest     size that no grain exceeds; 0 where it is not known
    void set(double settled_at, double stress_ratio, double largest);
    bool is(double settled_at, double stress_ratio, double largest) const {
        return settled_at == settled_at_ && stress_ratio == stress_ratio_ && largest == largest_;
    }

    const ActiveBand& before() const { return before_; }
    const ActiveBand& after() const { return after_; }
    /// Columns of each row between which the zone after lies.
    const ZoneExtent& extent() {
        if (!std::exchange(extent_known_, true)) extent_.set(after_);
        return extent_;
    }
    /// Largest distance at which mass of shell m moves; -1 where none does. Zones are nested but for rounding.
    Index last(Index m) const { return std::min(std::max(before_.last(m), after_.last(m)), m); }
    /// The largest in any shell.
    Index width() const { return width_; }
    bool narrow() const { return width_ <= widest_narrow_band; }

    /// (N, max(width, 0) + 1) shares that move of the mass in each cell, by shell and distance. Of a narrow band alone.
    const double* settled() const { return settled_.data(); }
    /// (N, max(width, 0) + 1) shares that move on of the mass that lands in each cell.
    const double* arrived() const { return arrived_.data(); }

  private:
    void set_shares();

    Index bins_;
    ActiveBand before_;
    ActiveBand after_;
    ZoneExtent extent_;
    bool extent_known_ = false;
    double settled_at_ = 0.0;
    double stress_ratio_ = 0.0;
    double largest_ = 0.0;
    Index width_ = -1;
    Array<double> settled_;
    Array<double> arrived_;
};

}  // namespace comminute::detail
