// SPDX-License-Identifier: BSD-3-Clause
// The two arms of a shell as they crush (docs/theory/one_sweep.md, section 8).
#pragma once

#include "simd/arms.hpp"
#include "sweeping/lines_in_flight.hpp"
#include "sweeping/outer_product.hpp"
#include "sweeping/shell_shares.hpp"

namespace comminute::detail {

/// Both arms of the current shell m: (m, j < m), whose mass falls down the columns and which the line of row m crosses,
/// and (i < m, m), whose mass falls along the rows and which the line of column m crosses. Each ends in a fines cell
/// where the band reaches bin 0.
class ShellArms {
  public:
    /// All of these must outlive it.
    ShellArms(const ShellWalk& walk, const ShellShares& shares, LinesInFlight& columns, LinesInFlight& rows);

    /// @param arrivals  mass from atoms and ridges; must outlive the sweep
    void begin(const Arrivals& arrivals) { arrivals_ = &arrivals; }

    /// Moves the active part of both arms of shell m onto their lines.
    /// @param row     (N) row m of the state
    /// @param column  (N) column m of the state down to its diagonal; what stays is written to it where `rest` is given
    /// @param rest    (N) row m of the state after; null where the state after is not wanted
    /// @return        mass that crushed in psi and in psibar
    Moved crush(Index m, const double* row, double* column, double* rest);

  private:
    /// One arm: its own lines, the lines of the direction that crosses it, and its cells by line.
    struct Side {
        LinesInFlight& lines;
        const LinesInFlight& crossing;
        Array<double> OuterProduct::*along;   // factor of the arrivals that varies along the arm
        Array<double> OuterProduct::*across;  // and the one that is the same in all of the arm
        LaneArray landed;                     // all mass landing
        LaneArray besides;                    // mass landing that the running sums do not cover
    };

    Arm arm_of(Side& side, Index m, const double* there, bool keep_landed);
    const double* land_besides(Side& side, Index m);
    void land_from_head(Side& side, Index m);
    double landed_in_fines(const Side& side, Index m) const;
    double crush_fines(Side& side, Index m, double there, double* rest);
    void leave_arm(const Side& side, Index m, const double* there, double* rest) const;

    const ShellWalk& walk_;
    const ShellShares& shares_;
    const Arrivals* arrivals_ = nullptr;
    Side down_columns_;
    Side along_rows_;
    LaneArray part_;  // part of a long sum over the head
};

}  // namespace comminute::detail
