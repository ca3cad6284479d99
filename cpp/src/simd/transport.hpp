// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/lanes.hpp"

namespace comminute::detail {

// Loops over the law of three cells for one centre, a table whose rows, by left neighbour, are `stride` apart, a multiple
// of `lanes`, with zeros beyond their end. Each takes the whole table, since a call for every row would cost as much as
// the row itself.

/// Running sums over the sizes that a grain of one size may replace: of the mass, and of the mass times the first and the
/// second power of the distance in size. All terms are positive, so that nothing cancels. (count) each
struct SizeSums {
    double* mass;
    double* first;
    double* second;
};
/// Mass that comes to one size in place of the others.
struct ArrivalRow {
    double step;    ///< distance in size from the size before it in the sums
    double any;     ///< share of the mass of any other size that it takes
    double linear;  ///< and of that in the sums, for each unit of distance
    double square;  ///< less this, for each unit of its square
    bool by_size;   ///< whether any size takes a share by distance, so that the sums are wanted
};
/// to[k] = any (total - from) + linear first - square second, the sums being moved on by `step` before, and the mass of
/// this size joining them after. (count)
void arrive(const ArrivalRow& row, const double* from, const double* total, const SizeSums& sums, double* to,
            Index count);
/// The same for every row of a table in turn, whose sums begin at 0.
/// @param order  (rows) rows as they come
/// @param sums   (4, stride) working memory
void arrive_rows(const ArrivalRow* rows, const Index* order, const double* from, double* sums, double* to,
                 Index nodes, Index stride);

/// Parts of the law for one centre after an exchange.
struct ExchangedCentre {
    const double* stays;        ///< (N) share of each size that stays
    double centre_stays;        ///< share of the centre that does
    const double* active;       ///< (N, stride) active share
    const double* centre;       ///< (N, stride) mass with a new centre
    const double* left;         ///< with a new left neighbour
    const double* both;         ///< with a new centre and left neighbour
    const double* both_turned;  ///< with a new centre and right neighbour
    const double* sides;        ///< with two new neighbours
    const double* all;          ///< with three new cells
    double* settled
        [3];  ///< (N, stride) old pairs, which are changed, and out: a new centre, a new left neighbour
    double* pending[3];
};
void exchange_centre(const ExchangedCentre& centre, Index nodes, Index stride);

/// sums[r] += sum of row r.
void sum_rows(const double* table, double* sums, Index nodes, Index stride);
/// sums[c] += sum of column c.
void sum_columns(const double* table, double* sums, Index nodes, Index stride);

/// A centre some of whose neighbours have crushed.
struct ReplacedSides {
    const double* left;      ///< (N) share of each left neighbour that crushes
    const double* right;     ///< (N) the same of the right one
    const double* active;    ///< (N, stride) active share
    const double* arriving;  ///< (N, stride) mass beside a fragment now
};
/// settled[a, c] = settled[a, c] (1 - (left[a] + right[c])) + (1 - active[a, c]) arriving[a, c].
void replace_sides(const ReplacedSides& sides, double* settled, Index nodes, Index stride);

}  // namespace comminute::detail
