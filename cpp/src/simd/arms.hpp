// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/lanes.hpp"

namespace comminute::detail {

/// Data that the two arms of a shell have in common. Arrays by line begin with the pack of the first line.
struct Shell {
    Index terms;             ///< K
    const double* entering;  ///< (K) weight of mass that enters the running sums, as in `Falling`
    const double* falling;   ///< (K) factor by which the sums have decayed, as in `Falling`
    const double* power;  ///< (K, count) decay of each term along a crossing line, from its own arm to line k
    Index power_stride;   ///< distance of the powers of one term and the next
    double diagonal;      ///< mass on a crossing line that comes from the diagonal cell, beyond its sums
    const double* of_diagonal;    ///< (count) share of that mass that lands in the arms' cells
    const double* settled_share;  ///< (count) share of a cell's own mass that moves
    const double* arrived_share;  ///< (count) share of the mass landing in a cell that moves on
    double below;                 ///< share of what moves that falls below the grid
};
/// One arm of a shell: cells whose mass moves along lines of their own, and one line that crosses all of these.
struct Arm {
    const double* there;     ///< (count) mass in the cells
    const double* besides;   ///< (count) mass landing that no sums cover; null: none
    const double* enters;    ///< (count) mass that enters the sums of the arm's lines
    double* sums;            ///< (count / lanes, K, lanes) running sums of the arm's lines
    const double* crossing;  ///< (K) running sums of the crossing line
    double* landed;          ///< (count) out: total mass landing in each cell; null to skip
    double* onto_line;       ///< (count) out: mass that moves onto each line; may be `enters`
    double* fines;  ///< (count) mass below the grid on each line, to which that of this shell is added
};
/// Mass that has moved in either arm.
struct Moved {
    double first = 0.0;
    double second = 0.0;
};
/// Adds the mass that enters to the sums, and moves the active part of the mass in the cells and of the mass landing
/// there. `count` is a multiple of `lanes`; where both shares of a cell are 0 nothing moves, whatever its mass, even
/// infinite or NaN.
Moved crush_arms(const Shell& shell, const Arm& first, const Arm& second, Index count);

/// Cells of an arm after it has crushed: their mass, the mass that landed in them, and the shares of either that moved.
struct Staying {
    const double* there;
    const double* landed;
    const double* settled_share;
    const double* arrived_share;
};
/// rest[k] = there (1 - settled_share) + landed (1 - arrived_share), k < count. `rest` may be `there`.
void leave(Staying s, double* rest, Index count);

}  // namespace comminute::detail
