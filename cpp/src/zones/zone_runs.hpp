// SPDX-License-Identifier: BSD-3-Clause
// Active cells of a row as runs of one zone, for the engines that step (docs/theory/one_sweep.md, section 13).
#pragma once

#include <vector>

#include "base/arrays.hpp"
#include "comminute/criterion.hpp"

namespace comminute::detail {

/// Cells of a row, side by side, that lie in one zone and crush alike. The diagonal cell, where either grain may crush,
/// is a run of its own.
struct ZoneRun {
    Index begin;
    Index end;
    Zone zone;
};

/// The active cells of a row of the state, as runs. One object per thread; finding them allocates nothing.
class ZoneRuns {
  public:
    /// @param zones  must outlive it
    explicit ZoneRuns(const CrushZones& zones);
    ZoneRuns(const ZoneRuns&) = delete;
    ZoneRuns& operator=(const ZoneRuns&) = delete;

    /// Reads the zones again; must be called after they have moved to another load.
    void set_load();
    /// The runs of row i, fine to coarse; valid until the next call.
    const std::vector<ZoneRun>& of_row(Index i);

  private:
    void add(Index begin, Index end, Zone zone);

    const CrushZones& zones_;
    Index widest_ = -1;  // largest active distance |i - j|
    Array<ZoneRun> runs_;
};

}  // namespace comminute::detail
