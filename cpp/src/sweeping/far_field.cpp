// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "simd/loops.hpp"
#include "simd/sums.hpp"
#include "sweeping/band_sweep.hpp"

// The cells outside the band: nothing crushes there, so the sums of a line, once its own shell has had its turn, give
// all that lands on it. The state is walked in tiles of a few rows by one block of columns, with references inside
// the block, since ratio^-N overflows; and four rows at a time, so that a number of the tables is loaded once for all. Terms that decay fast are nothing beyond a few blocks and are left out there.

namespace comminute::detail {
namespace {

constexpr Index block = 96;
constexpr Index rows_a_tile = 16;

}  // namespace

// Columns from 1 up to this one lie to the left of row i's band and beyond the head of its line.
Index BandSweep::left_end(const CrushTable& table, Index i) const {
    return std::max(std::min(i - table.head, first(i)), Index{1});
}

// Columns from this one on lie to the right of row i's band and beyond the heads of their lines.
Index BandSweep::right_begin(const CrushTable& table, Index i) const {
    if (i == 0 || table.terms == 0) return bins_;
    return std::min(std::max(right_[static_cast<std::size_t>(i)], i + table.head + 1), bins_);
}

// What lands to the left of the band of row i nearer than the head, and in the fines bin.
void BandSweep::near_left(const CrushTable& table, Index i, double* row) const {
    const Index end = first(i);
    if (end == 0) return;
    row[0] += rows_.fines[static_cast<std::size_t>(i)];
    const Index begin = left_end(table, i);
    if (begin >= end) return;
    for (Index shell = i; shell <= std::min(i + table.head, bins_ - 1) && first(shell) <= i; ++shell) {
        const double mass = *pushed(rows_, shell, i);
        if (mass != 0.0) add_scaled(mass, table.mass_towards(shell, begin), row + begin, end - begin);
    }
    if (table.terms == 0) return;
    add_terms(rows_.near.data() + i * table.terms, {table.powers_towards(0, i, begin), table.stride},
              table.terms, row + begin, end - begin);
}

// What lands to its right nearer than the heads of the columns; in row 0, what falls below the grid.
void BandSweep::near_right(const CrushTable& table, Index i, double* row) const {
    const Index begin = right_[static_cast<std::size_t>(i)];
    if (i == 0) {
        for (Index j = begin; j < bins_; ++j) row[j] += columns_.fines[static_cast<std::size_t>(j)];
        return;
    }
    const Index end = right_begin(table, i);
    if (begin >= end || table.head == 0) return;
    for (Index shell = begin; shell < bins_; ++shell) {
        const Index from = std::max({begin, first(shell), shell - table.head});
        const Index to = std::min(shell + 1, end);
        if (from >= end) break;
        if (from >= to) continue;
        add_scaled(table.mass[static_cast<std::size_t>(shell - i)], pushed(columns_, shell, from), row + from,
                   to - from);
    }
    for (Index j = begin; j < end; ++j) {
        for (Index a = 0; a < table.terms; ++a) {
            row[j] += columns_.near[static_cast<std::size_t>(j * table.terms + a)] * table.powers(a)[j - i];
        }
    }
}

// By term instead of by column, as they are and as seen from the first column of each block.
void BandSweep::turn_far_sums(const CrushTable& table) {
    by_term_.resize(columns_.far.size());
    scaled_.resize(columns_.far.size());
    for (Index a = 0; a < table.terms; ++a) {
        const double* power = table.powers(a);
        double* turned = by_term_.data() + a * bins_;
        double* scaled = scaled_.data() + a * bins_;
        for (Index j = 0; j < bins_; ++j) {
            turned[j] = columns_.far[static_cast<std::size_t>(j * table.terms + a)];
            scaled[j] = turned[j] * power[j % block];
        }
    }
}

// A block of columns, as far as it lies left of the rows begin_row and on.
void BandSweep::far_left(const CrushTable& table, Index begin_row, Index end_row, Index begin, Index end,
                         MatrixView<double> out) {
    begin = std::max(begin, Index{1});
    const auto factor = [&](Index row, Index a, Index last) {
        return rows_.far[static_cast<std::size_t>(row * table.terms + a)] *
               table.powers(a)[row - table.head - last];
    };
    const auto terms_at = [&](Index row, Index last) {
        return table.terms_from[static_cast<std::size_t>(row - table.head - last)];
    };
    Index common = begin;  // up to where all of the rows take the block
    if (end_row - begin_row == rows_at_once) {
        const Index last = std::min(end, left_end(table, begin_row));
        common = begin + std::max(last - begin, Index{0}) / lanes * lanes;
    }
    if (common > begin) {
        const Index terms = terms_at(begin_row, common - 1);
        for (Index a = 0; a < terms; ++a) {
            for (Index r = 0; r < rows_at_once; ++r) {
                factors_[static_cast<std::size_t>(a * rows_at_once + r)] =
                    factor(begin_row + r, a, common - 1);
            }
        }
        add_to_rows({table.powers_towards(0, common - 1, begin), lanes, table.stride}, factors_.data(), terms,
                    out.row(begin_row) + begin, out.stride(), common - begin);
    }
    for (Index row = begin_row; row < end_row; ++row) {
        const Index to = std::min(end, left_end(table, row));
        if (common >= to) continue;
        const Index terms = terms_at(row, to - 1);
        for (Index a = 0; a < terms; ++a) factors_[static_cast<std::size_t>(a)] = factor(row, a, to - 1);
        add_terms(factors_.data(), {table.powers_towards(0, to - 1, common), table.stride}, terms,
                  out.row(row) + common, to - common);
    }
}

// The same on the right.
void BandSweep::far_right(const CrushTable& table, Index begin_row, Index end_row, Index begin, Index end,
                          MatrixView<double> out) {
    Index common = begin;
    const Index last_row = end_row - 1;
    const bool all =
        begin_row > 0 && end_row - begin_row == rows_at_once && begin >= right_begin(table, last_row);
    if (all && end - begin >= lanes) {
        common = begin + (end - begin) / lanes * lanes;
        const Index terms = table.terms_from[static_cast<std::size_t>(begin - last_row - table.head)];
        for (Index a = 0; a < terms; ++a) {
            const double* power = table.powers(a) + begin - table.head;
            for (Index r = 0; r < rows_at_once; ++r) {
                factors_[static_cast<std::size_t>(a * rows_at_once + r)] = power[-begin_row - r];
            }
        }
        add_to_rows({scaled_.data() + begin, lanes, bins_}, factors_.data(), terms,
                    out.row(begin_row) + begin, out.stride(), common - begin);
    }
    for (Index row = begin_row; row < end_row; ++row) {
        const Index from = std::max(common, right_begin(table, row));
        if (from >= end) continue;
        const Index terms = table.terms_from[static_cast<std::size_t>(from - row - table.head)];
        add_products({by_term_.data() + from, bins_},
                     {table.powers(0) + from - row - table.head, table.stride}, terms, out.row(row) + from,
                     end - from);
    }
}

void BandSweep::far_field(const CrushTable& table, MatrixView<const double> state,
                          const std::vector<OuterProduct>& arrivals, MatrixView<double> out) {
    right_.resize(static_cast<std::size_t>(bins_));
    factors_.resize(static_cast<std::size_t>(table.terms * rows_at_once));
    if (table.terms > 0) turn_far_sums(table);
    Index right = 0;
    for (Index tile = 0; tile < bins_; tile += rows_a_tile) {
        const Index tile_end = std::min(tile + rows_a_tile, bins_);
        for (Index i = tile; i < tile_end; ++i) {
            while (right < bins_ && first(right) <= i) ++right;
            right_[static_cast<std::size_t>(i)] = right;
            const Index left = first(i);
            double* row = out.row(i);
            if (row != state.row(i)) {
                std::copy(state.row(i), state.row(i) + left, row);
                std::copy(state.row(i) + right, state.row(i) + bins_, row + right);
            }
            for (const OuterProduct& from : arrivals) {
                const double factor = from.psi[static_cast<std::size_t>(i)];
                if (factor == 0.0) continue;
                add_scaled(factor, from.psibar.data(), row, left);
                add_scaled(factor, from.psibar.data() + right, row + right, bins_ - right);
            }
            near_left(table, i, row);
            near_right(table, i, row);
        }
        for (Index begin = 0; begin < bins_ && table.terms > 0; begin += block) {
            const Index end = std::min(begin + block, bins_);
            for (Index i = tile; i < tile_end; i += rows_at_once) {
                const Index rows_end = std::min(i + rows_at_once, tile_end);
                far_left(table, i, rows_end, begin, end, out);
                far_right(table, i, rows_end, begin, end, out);
            }
        }
    }
}

}  // namespace comminute::detail
