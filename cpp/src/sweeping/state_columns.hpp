// SPDX-License-Identifier: BSD-3-Clause
// Columns of the state, a few at a time, each in one piece (docs/theory/one_sweep.md, section 8).
#pragma once

#include "sweeping/shell_walk.hpp"

namespace comminute::detail {

/// A block of columns of the state. The state lies row by row, so a column is read by squares of a pack each way, and the
/// arms of many shells wait in the cache for their turn.
class StateColumns {
  public:
    /// Shells in a block: enough to use whole cache lines of the state's rows.
    static constexpr Index shells = 32;

    /// @param walk  must outlive it
    explicit StateColumns(const ShellWalk& walk);

    /// Reads columns [begin, end), at most `shells`, within the band and above the diagonal.
    void take(MatrixView<const double> state, Index begin, Index end);
    /// Writes the same columns to `out`, as far as the band goes.
    void give(MatrixView<double> out) const;
    /// (N) column m of those taken, down to row m - 1; entries outside the band have no meaning.
    double* column(Index m) { return block_.data() + (m - begin_) * stride_; }

  private:
    const ShellWalk& walk_;
    Index stride_;
    Index begin_ = 0;
    Index end_ = 0;
    LaneArray block_;  // (shells, stride)
};

}  // namespace comminute::detail
