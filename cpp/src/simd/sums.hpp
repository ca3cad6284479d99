// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/lanes.hpp"

namespace comminute::detail {

// Running sums of lines side by side, one for each term of the fragments' exponential sum. They lie in packs of lines:
// (count / lanes, K, lanes) for K terms and `count` lines, a multiple of `lanes`, which may be 0.

/// Running sums as they were at the first shell of a block of shells, and what brings them up to date.
struct Falling {
    Index terms;             ///< K
    const double* entering;  ///< (K) weight of mass that enters
    const double* falling;   ///< (K) factor by which the sums have decayed since the block's first shell
    double* sums;            ///< (count / lanes, K, lanes), from the first line's pack on
};
/// Adds the mass that enters each line to its sums, and writes the mass that arrives from them.
/// @param enters    (count) mass
/// @param arriving  (count) out: sum over the terms of `falling` times the line's sum
void advance(const Falling& f, const double* enters, double* arriving, Index count);

/// sums[k] *= factor[a], and 0 where that would be negligible.
/// @param factor  (K)
/// @param sums    (count / lanes, K, lanes)
void decay(const double* factor, Index terms, double* sums, Index count);

/// Numbers by term, in rows `stride` apart.
struct TermRows {
    const double* first;
    Index stride;
};
/// to[k] += sum over the terms a of factors[a] rows[a, k], k < count, any number.
void add_terms(const double* factors, TermRows rows, Index terms, double* to, Index count);
/// to[k] += sum over the terms a of one[a, k] other[a, k], k < count, any number.
void add_products(TermRows one, TermRows other, Index terms, double* to, Index count);

/// Rows that add_to_rows() serves at once, so that a number of the terms is loaded once for all of them.
constexpr Index rows_at_once = 4;

/// Lines of numbers by term, in packs: number l of pack p in the line of term a is
/// lines[p * pack_stride + a * term_stride + l].
struct Terms {
    const double* lines;
    Index pack_stride;
    Index term_stride;
};
/// Adds to each of `rows_at_once` rows the sum over the terms a of factors[a, r] times the line of a.
/// @param factors  (terms, rows_at_once)
/// @param count    numbers in a row, a multiple of `lanes`
void add_to_rows(const Terms& of, const double* factors, Index terms, double* rows, Index row_stride,
                 Index count);

}  // namespace comminute::detail
