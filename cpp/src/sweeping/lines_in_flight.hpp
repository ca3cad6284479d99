// SPDX-License-Identifier: BSD-3-Clause
// Mass in flight along the columns or the rows of the state (docs/theory/one_sweep.md, section 7).
#pragma once

#include "sweeping/shell_walk.hpp"

namespace comminute::detail {

/// Mass that has been pushed onto the lines of one direction, columns or rows, and has still to land further down.
///
/// A line keeps it in two parts: K running sums, one for each exponential of the fragments' law, brought up to date once
/// a block of shells, and the masses of the last H shells, H the head of the table, which are added one by one.
class LinesInFlight {
  public:
    /// @param walk  must outlive it
    explicit LinesInFlight(const ShellWalk& walk);

    /// Empties the lines. `keep_for_far_field`: each line's sums are kept when its own shell has had its turn.
    void begin(bool keep_for_far_field);
    /// Lets the sums of the lines that the band still crosses decay to shell m, the first of a new block.
    void begin_block(Index m);

    /// Mass landing in the diagonal cell of shell m along line m. Also brings own_sums() to that line and shell.
    double arrive_on_diagonal(Index m);
    /// `landed` and the mass landing at shell m along line 0, the line of the fines, from the sums and the head.
    double add_in_fines(Index m, double landed) const;
    /// Adds the head's mass landing at shell m along lines first(m) .. m - 1, pushed by shell `from` alone.
    void add_head(Index m, Index from, double* landed) const;
    /// Mass of shell m + H + 1, which leaves the head at shell m: by line from the pack of first(m) on, 0 elsewhere.
    const double* entering_sums(Index m);
    /// Keeps the sums of line m, whose shell has had its turn, for the far field.
    void keep_for_far_field(Index m);

    /// Mass that `shell` has pushed onto `line`; the next lines follow.
    double* pushed(Index shell, Index line) { return pushed_.data() + place_of(shell) + line; }
    const double* pushed(Index shell, Index line) const { return pushed_.data() + place_of(shell) + line; }
    /// (packs, K, lanes) running sums from the pack of `line` on, as of the first shell of the block.
    double* sums(Index line) { return sums_.data() + line * walk_.table().terms; }
    /// (K) sums of the line whose shell has its turn, as of that shell.
    const double* own_sums() const { return own_.data(); }
    /// Mass of each line that falls below the grid.
    double* fines() { return fines_.data(); }
    double fines(Index line) const { return fines_[line]; }

    /// (K) sums of line m at shell m, for places within the head below it.
    const double* near_sums(Index m) const { return near_.data() + m * walk_.table().terms; }
    /// (K) sums of line m beyond its head, as of H bins below shell m.
    const double* far_sums(Index m) const { return far_.data() + m * walk_.table().terms; }

  private:
    // The arms of a shell lie in one piece that ends with the pack of its diagonal cell.
    Index place_of(Index shell) const {
        return walk_.without_head() ? 0 : (shell % shells_kept_ + 1) * width_ - lanes_up(shell + 1);
    }

    const ShellWalk& walk_;
    Index width_ = 0;        // numbers kept of each shell
    Index shells_kept_ = 0;  // the last alone where there is no head, by line
    LaneArray sums_;         // (packs, K, lanes)
    Array<double> own_;      // (K)
    LaneArray pushed_;       // (shells kept, width)
    LaneArray entering_;     // (N) by line
    LaneArray fines_;        // (N)
    Array<double> near_;     // (N, K)
    Array<double> far_;      // (N, K)
};

}  // namespace comminute::detail
