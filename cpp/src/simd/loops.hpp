// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/lanes.hpp"

namespace comminute::detail {

/// to[k] += factor * from[k], k < count; the two do not overlap.
void add_scaled(double factor, const double* from, double* to, Index count);

double sum(const double* values, Index count);
bool all_finite(const double* values, Index count);

/// Running sums of lines side by side, as of the first shell of a block of shells.
struct Falling {
    Index terms;             ///< K
    const double* entering;  ///< (K) weight of what enters
    const double* falling;   ///< (K) what the sums have decayed by since they were last brought up to date
    double* sums;            ///< (count / lanes, K, lanes), from the first line's pack on
};
/// Takes into the sums what enters, and says what arrives. `count`, a multiple of `lanes`, may be 0.
void advance(const Falling& f, const double* enters, double* arriving, Index count);

/// sums[k] *= factor[a], and 0 where that would be negligible; (count / lanes, K, lanes).
void decay(const double* factor, Index terms, double* sums, Index count);

/// What the two arms of a shell have in common; the arrays by line, from the same pack on.
struct Shell {
    Index terms;             ///< K
    const double* entering;  ///< (K) as of `Falling`
    const double* falling;   ///< (K)
    const double* power;     ///< by which a line that crosses an arm has decayed at the arm's lines
    Index power_stride;      ///< a term more
    double
        diagonal;  ///< mass that a line which crosses an arm has got from the diagonal cell, beyond its sums
    const double* of_diagonal;    ///< share of it that lands at the arm's lines
    const double* settled_share;  ///< that moves of what is there
    const double* arrived_share;  ///< that moves of what has landed
    double below;                 ///< share of what moves that falls below the grid
};
/// One arm: cells whose mass moves along lines of their own, and one line that crosses all of these.
struct Arm {
    const double* there;
    const double* besides;   ///< what lands beyond what the sums give; null: nothing
    const double* enters;    ///< the sums of the arm's lines
    double* sums;            ///< of these
    const double* crossing;  ///< (K) sums of the crossing line
    double* landed;          ///< all that lands; null: nobody asks
    double* onto_line;       ///< what moves; may be `enters`
    double* fines;           ///< what falls below the grid is added
};
struct Moved {
    double first = 0.0;
    double second = 0.0;
};
/// Takes into the sums what enters, and moves the active part of what is there and of what lands. Returns the sums of
/// what moves. `count` is a multiple of `lanes`; where both shares are 0 nothing moves, whatever is there.
Moved crush_arms(const Shell& shell, const Arm& first, const Arm& second, Index count);

/// What stays of an arm.
struct Staying {
    const double* there;
    const double* landed;
    const double* settled_share;
    const double* arrived_share;
};
/// `rest` may be where `there` is.
void leave(Staying s, double* rest, Index count);

/// What lands in a row of cells and what crushes in them.
struct Landing {
    const double* crushing;
    const double* arriving;
    double stays;  ///< share of what crushes that stays in its bin
    double below;  ///< and that falls below the grid
};
/// row[k] += arriving[k] + stays crushing[k], fines[k] += below crushing[k].
void settle_row(Landing landing, double* row, double* fines, Index count);

constexpr Index rows_at_once = 4;

/// Lines by term, in packs.
struct Terms {
    const double* lines;
    Index pack_stride;
    Index term_stride;
};
/// Adds the sum over a of factors[a, r] lines[a] to row r of four; `count` is a multiple of `lanes`.
/// @param factors  (terms, 4)
void add_to_rows(const Terms& of, const double* factors, Index terms, double* rows, Index row_stride,
                 Index count);

/// A square of as many numbers as there are lanes each way, its rows to columns.
void transpose(const double* from, Index from_stride, double* to, Index to_stride);

/// Asks for a piece of memory that will be wanted soon, where the way there is none that a machine foresees.
inline void fetch(const double* from, Index count) {
    for (Index k = 0; k < count + lanes; k += lanes) __builtin_prefetch(from + k);
}

}  // namespace comminute::detail
