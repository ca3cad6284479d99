// SPDX-License-Identifier: BSD-3-Clause
// Shares of each cell of one shell that move (docs/theory/one_sweep.md, sections 4 and 8).
#pragma once

#include "sweeping/shell_walk.hpp"
#include "zones/moving_shares.hpp"

namespace comminute::detail {

/// Shares of the cells of the current shell that move: one array for both arms, which mirror each other, and single
/// numbers for the diagonal cell and the fines cells, where mass arrives in other ways.
class ShellShares {
  public:
    /// @param walk  must outlive it
    explicit ShellShares(const ShellWalk& walk);

    /// Starts above the coarsest shell.
    void begin();
    /// @param before  zone in which the state settled
    /// @param after   zone of the new load
    void set(const ActiveBand& before, const ActiveBand& after, Index m);

    /// Shares of the mass that had settled, by line; 0 in the cells that share a pack with an arm's ends.
    const double* settled() const { return settled_; }
    /// Shares of the mass that lands, by line; 0 in the same places.
    const double* arrived() const { return arrived_share_.data(); }
    MovingShares diagonal() const { return diagonal_; }
    MovingShares fines() const { return fines_; }

  private:
    const ShellWalk& walk_;
    LaneArray settled_share_;  // used where part of the shell was active before; elsewhere the two are equal
    LaneArray arrived_share_;
    const double* settled_ = nullptr;  // the array in use
    Index ones_from_ = 0;  // the shell before left arrived shares of 1 from here up to its diagonal cell
    MovingShares diagonal_;
    MovingShares fines_;
};

}  // namespace comminute::detail
