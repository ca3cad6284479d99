// SPDX-License-Identifier: BSD-3-Clause
// Active cells of a row as runs of one zone, for the engines that step (docs/theory/one_sweep.md, section 13).
#pragma once

#include "base/arrays.hpp"
#include "comminute/criterion.hpp"

namespace comminute::detail {

/// Cells of a row, side by side, that lie in one zone and crush alike. The diagonal cell, where either grain may crush,
/// is a run of its own.
struct ZoneRun {
    Index begin = 0;
    Index end = 0;
    Zone zone = Zone::rest;
};

/// The crush zones under one load, and the active cells of each row of the state as runs. One object per thread; finding
/// them allocates nothing.
class ZoneRuns {
  public:
    /// No load: every cell is at rest.
    ZoneRuns(const LogGrid& grid, const Material& material);

    const CrushZones& zones() const { return zones_; }
    /// @throws ParameterError for a bad load
    void set_load(double stress_ratio);
    /// Runs of row i, fine to coarse; valid until the next call.
    VectorView<const ZoneRun> of_row(Index i);

  private:
    void add(Index begin, Index end, Zone zone);

    CrushZones zones_;
    Index widest_ = -1;    // largest distance |i - j| that is active
    Array<ZoneRun> runs_;  // (N) room for the runs of a row, each of which has a cell or more
    Index count_ = 0;      // runs of the row at hand
};

}  // namespace comminute::detail
