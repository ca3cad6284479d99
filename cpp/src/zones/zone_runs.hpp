// SPDX-License-Identifier: BSD-3-Clause
// Active cells of a row as runs of one zone, for the engines that step (docs/theory/one_sweep.md, section 13).
#pragma once

#include <vector>

#include "comminute/criterion.hpp"

namespace comminute::detail {

/// Cells of a row side by side that lie in one zone and do the same; none of them is the diagonal cell with others.
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

    /// To be called once the zones have another load.
    void set_load();
    /// The runs of row i, fine to coarse; valid until the next call.
    const std::vector<ZoneRun>& of_row(Index i);

  private:
    void add(Index begin, Index end, Zone zone);

    const CrushZones& zones_;
    Index widest_ = -1;  // distance |i - j| that is active
    std::vector<ZoneRun> runs_;
};

}  // namespace comminute::detail
