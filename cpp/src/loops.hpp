// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "lanes.hpp"

namespace comminute {

/// to[k] += factor * from[k], k < count; the two do not overlap.
void add_scaled(double factor, const double* from, double* to, Index count);

double sum(const double* values, Index count);
bool all_finite(const double* values, Index count);

/// The sums of the lines of one arm of a shell, and of the line that crosses them all.
struct Falling {
    Index terms;             ///< K
    const double* entering;  ///< (K) weight of what enters
    const double* falling;   ///< (K) what the sums have decayed by since they were last brought up to date
    const double* crossing;  ///< (K) sums of the crossing line; null: there is none
    const double*
        power;  ///< by which the crossing line has decayed at the first line; a term more: power_stride
    Index power_stride;
    double* sums;  ///< (count / lanes, K, lanes), from the first line's pack on
};
/// Takes into the sums what enters, and says what arrives. `count`, a multiple of `lanes`, may be 0.
void advance(Falling f, const double* enters, double* arriving, Index count);

/// sums[k] *= factor[a], and 0 where that would be negligible; (count / lanes, K, lanes).
void decay(const double* factor, Index terms, double* sums, Index count);

/// What happens to the cells of one arm of a shell.
struct Crushing {
    const double* there;
    const double* landed;
    const double* settled_share;  ///< of what is there
    const double* arrived_share;  ///< of what has landed
    double below;                 ///< share of what moves that falls below the grid
};
/// What moves of the cells, onto their lines and these lines' fines. Returns its sum. `count` is a multiple of `lanes`;
/// where both shares are 0 nothing moves, whatever is there.
double push(Crushing c, double* onto_line, double* fines, Index count);
/// What stays of them. `rest` may be where `there` is.
void leave(Crushing c, double* rest, Index count);

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
void add_to_rows(Terms of, const double* factors, Index terms, double* rows, Index row_stride, Index count);

/// Asks for a piece of memory that will be wanted soon, where the way there is none that a machine foresees.
inline void fetch(const double* from, Index count) {
    for (Index k = 0; k < count + lanes; k += lanes) __builtin_prefetch(from + k);
}

}  // namespace comminute
