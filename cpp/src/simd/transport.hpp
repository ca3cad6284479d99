// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/lanes.hpp"

namespace comminute::detail {

// Loops over rows of the law of three cells while grains change places between rows of a column.

/// Running sums over the sizes that a grain of one size may replace: of the mass, and of the mass times the first and the
/// second power of the distance in size. All terms are positive, so that nothing cancels. (count) each
struct SizeSums {
    double* mass;
    double* first;
    double* second;
};
/// What comes to one size in place of the others.
struct ArrivalRow {
    const double* from;   ///< (count) mass of that size before
    const double* total;  ///< (count) mass of all sizes
    double step;          ///< distance in size from the size before it in the sums
    double any;           ///< share of the mass of any other size that it takes
    double linear;        ///< and of that in the sums, for each unit of distance
    double square;        ///< less this, for each unit of its square
};
/// to[k] = any (total - from) + linear first - square second, the sums being moved on by `step` before, and the mass of
/// this size joining them after.
void arrive(const ArrivalRow& row, const SizeSums& sums, double* to, Index count);

/// Parts of the law for one centre beside one neighbour a, over the other neighbour c, after an exchange.
struct ExchangedRow {
    const double* stays;            ///< (count) share of each c that stays
    double centre_stays;            ///< share of the centre that does
    double left_stays;              ///< share of a that does
    const double* active;           ///< (count) active share
    const double* centre;           ///< (count) mass with a new centre
    const double* left;             ///< with a new a
    const double* both;             ///< with a new centre and a
    const double* both_turned;      ///< with a new centre and c
    const double* sides;            ///< with a new a and c
    const double* all;              ///< with three new cells
    double* settled[3];             ///< (count) old pairs, which are changed, and out: a new centre, a new a
    double* pending[3];
};
void exchange_row(const ExchangedRow& row, Index count);

}  // namespace comminute::detail
