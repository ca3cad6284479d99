// SPDX-License-Identifier: BSD-3-Clause
// The way of a sweep down the shells, which all of its parts follow (docs/theory/one_sweep.md, sections 5 and 7).
#pragma once

#include <algorithm>

#include "base/arrays.hpp"
#include "simd/lanes.hpp"
#include "spreading/crush_table.hpp"
#include "zones/active_band.hpp"

namespace comminute::detail {

/// The shells of one sweep from coarse to fine: the table of fragments, the edge of the band, and the place of the
/// current shell in its block. The parts of a sweep read it; BandSweep alone moves it on.
class ShellWalk {
  public:
    explicit ShellWalk(Index bins) : bins_(bins), first_(bins) {}

    /// Starts above the coarsest shell. `table` must outlive the sweep.
    void begin(const CrushTable& table, const ActiveBand& after);
    /// Goes one shell down. True where that shell begins a new block, whose first shell the sums must decay to.
    bool next() {
        if (++block_shell_ < table_->shells_a_block) return false;
        block_shell_ = 0;
        return true;
    }

    Index bins() const { return bins_; }
    const CrushTable& table() const { return *table_; }
    /// Lowest line onto which shell m, or a coarser one, pushes mass: the edge of the band at shell m.
    Index first(Index m) const { return first_[m]; }
    /// Largest distance m - first(m).
    Index longest() const { return longest_; }
    /// Tells whether the arms of shell m end in the fines bin.
    bool reaches_fines(Index m) const { return m > 0 && first_[m] == 0; }
    /// Tells whether the fragments have no head: a shell's masses then enter the sums at the next shell.
    bool without_head() const { return table_->head == 0; }
    /// Coarsest shell within the head of shell m that has pushed mass onto line m; m if there is none. Sums over the head
    /// run from there down, since the mass that has fallen farthest is the least and would be rounded away beside the rest.
    Index coarsest_in_head(Index m) const {
        Index shell = std::min(m + table_->head, bins_ - 1);
        while (shell > m && first_[shell] > m) --shell;
        return shell;
    }
    /// (K) weights of mass that enters the running sums at the current shell.
    const double* entering() const { return table_->entering_at(block_shell_); }
    /// (K) decay of the running sums from the first shell of the block to the current one.
    const double* falling() const { return table_->falling_at(block_shell_); }

  private:
    Index bins_;
    const CrushTable* table_ = nullptr;
    Array<Index> first_;  // (N)
    Index longest_ = 0;
    Index block_shell_ = 0;  // place of the current shell in its block
};

}  // namespace comminute::detail
