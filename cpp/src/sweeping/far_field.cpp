// SPDX-License-Identifier: BSD-3-Clause
// Powers with references inside a block of columns, for tiles of rows (docs/theory/one_sweep.md, section 9).
#include "sweeping/far_field.hpp"

#include <algorithm>

#include "simd/loops.hpp"
#include "simd/sums.hpp"

namespace comminute::detail {
namespace {

constexpr Index block = 96;
constexpr Index rows_a_tile = 16;

}  // namespace

FarField::FarField(const ShellWalk& walk, const LinesInFlight& columns, const LinesInFlight& rows)
    : walk_(walk), columns_(columns), rows_(rows) {}

// Columns 1 up to this one lie left of row i's band and beyond the head of its line.
Index FarField::left_end(Index i) const {
    return std::max(std::min(i - walk_.table().head, walk_.first(i)), Index{1});
}

// Columns from this one on lie right of row i's band and beyond the heads of their lines.
Index FarField::right_begin(Index i) const {
    if (i == 0 || walk_.table().terms == 0) return walk_.bins();
    return std::min(std::max(right_[i], i + walk_.table().head + 1), walk_.bins());
}

// Mass landing left of the band of row i within the head of its line, and in the fines bin.
void FarField::near_left(Index i, double* row) const {
    const CrushTable& table = walk_.table();
    const Index end = walk_.first(i);
    if (end == 0) return;
    row[0] += rows_.fines(i);
    const Index begin = left_end(i);
    if (begin >= end) return;
    const Index last = std::min(i + table.head, walk_.bins() - 1);
    for (Index shell = i; shell <= last && walk_.first(shell) <= i; ++shell) {
        const double mass = *rows_.pushed(shell, i);
        if (mass != 0.0) add_scaled(mass, table.mass_towards(shell, begin), row + begin, end - begin);
    }
    if (table.terms == 0) return;
    add_terms(rows_.near_sums(i), {table.powers_towards(0, i, begin), table.stride}, table.terms, row + begin,
              end - begin);
}

// Mass landing right of the band of row i within the heads of the columns; in row 0, all that falls below the grid.
void FarField::near_right(Index i, double* row) const {
    const CrushTable& table = walk_.table();
    const Index begin = right_[i];
    if (i == 0) {
        for (Index j = begin; j < walk_.bins(); ++j) row[j] += columns_.fines(j);
        return;
    }
    const Index end = right_begin(i);
    if (begin >= end || table.head == 0) return;
    for (Index shell = begin; shell < walk_.bins(); ++shell) {
        const Index from = std::max({begin, walk_.first(shell), shell - table.head});
        const Index to = std::min(shell + 1, end);
        if (from >= end) break;
        if (from >= to) continue;
        add_scaled(table.mass[shell - i], columns_.pushed(shell, from), row + from, to - from);
    }
    for (Index j = begin; j < end; ++j) {
        const double* const sums = columns_.near_sums(j);
        for (Index a = 0; a < table.terms; ++a) row[j] += sums[a] * table.powers(a)[j - i];
    }
}

// The columns' far sums by term instead of by column, as they are and decayed to the first column of each block.
void FarField::turn_sums() {
    const CrushTable& table = walk_.table();
    const Index bins = walk_.bins();
    by_term_.resize(table.terms * bins);
    scaled_.resize(table.terms * bins);
    for (Index a = 0; a < table.terms; ++a) {
        const double* power = table.powers(a);
        double* turned = by_term_.data() + a * bins;
        double* scaled = scaled_.data() + a * bins;
        for (Index j = 0; j < bins; ++j) {
            turned[j] = columns_.far_sums(j)[a];
            scaled[j] = turned[j] * power[j % block];
        }
    }
}

// Adds what the rows' lines land in a block of columns beyond their heads: four rows at once where all four reach, and
// the rest row by row. The reference is the last column that is served, from which the powers of a term fall.
void FarField::far_left(Range rows, Range columns, MatrixView<double> out) {
    const CrushTable& table = walk_.table();
    const Index begin = std::max(columns.begin, Index{1});
    const Index end = columns.end;
    const auto factor = [&](Index row, Index a, Index last) {
        return rows_.far_sums(row)[a] * table.powers(a)[row - table.head - last];
    };
    const auto terms_at = [&](Index row, Index last) { return table.terms_from[row - table.head - last]; };
    Index common = begin;  // all four rows reach the columns up to here
    if (rows.end - rows.begin == rows_at_once) {
        const Index last = std::min(end, left_end(rows.begin));
        common = begin + lanes_down(std::max(last - begin, Index{0}));
    }
    if (common > begin) {
        const Index terms = terms_at(rows.begin, common - 1);
        for (Index a = 0; a < terms; ++a) {
            for (Index r = 0; r < rows_at_once; ++r) {
                factors_[a * rows_at_once + r] = factor(rows.begin + r, a, common - 1);
            }
        }
        add_to_rows({table.powers_towards(0, common - 1, begin), lanes, table.stride}, factors_.data(), terms,
                    out.row(rows.begin) + begin, out.stride(), common - begin);
    }
    for (Index row = rows.begin; row < rows.end; ++row) {
        const Index to = std::min(end, left_end(row));
        if (common >= to) continue;
        const Index terms = terms_at(row, to - 1);
        for (Index a = 0; a < terms; ++a) factors_[a] = factor(row, a, to - 1);
        add_terms(factors_.data(), {table.powers_towards(0, to - 1, common), table.stride}, terms,
                  out.row(row) + common, to - common);
    }
}

// Adds what the columns' lines land in a block of columns beyond their heads, in the same two parts. The reference is the
// first column of the block.
void FarField::far_right(Range rows, Range columns, MatrixView<double> out) {
    const CrushTable& table = walk_.table();
    const Index bins = walk_.bins();
    const Index begin = columns.begin;
    const Index end = columns.end;
    Index common = begin;
    const Index last_row = rows.end - 1;
    const bool all =
        rows.begin > 0 && rows.end - rows.begin == rows_at_once && begin >= right_begin(last_row);
    if (all && end - begin >= lanes) {
        common = begin + lanes_down(end - begin);
        const Index terms = table.terms_from[begin - last_row - table.head];
        for (Index a = 0; a < terms; ++a) {
            const double* power = table.powers(a) + begin - table.head;
            for (Index r = 0; r < rows_at_once; ++r) {
                factors_[a * rows_at_once + r] = power[-rows.begin - r];
            }
        }
        add_to_rows({scaled_.data() + begin, lanes, bins}, factors_.data(), terms,
                    out.row(rows.begin) + begin, out.stride(), common - begin);
    }
    for (Index row = rows.begin; row < rows.end; ++row) {
        const Index from = std::max(common, right_begin(row));
        if (from >= end) continue;
        const Index distance = from - row - table.head;
        add_products({by_term_.data() + from, bins}, {table.powers(0) + distance, table.stride},
                     table.terms_from[distance], out.row(row) + from, end - from);
    }
}

void FarField::begin() {
    const CrushTable& table = walk_.table();
    right_.resize(walk_.bins());
    Index right = 0;
    for (Index i = 0; i < walk_.bins(); ++i) {
        while (right < walk_.bins() && walk_.first(right) <= i) ++right;
        right_[i] = right;
    }
    factors_.resize(table.terms * rows_at_once);
    if (table.terms > 0) turn_sums();
}

// Row i outside the band: its mass before, the mass that arrives from point masses, and the lines' mass within the head.
void FarField::keep_and_land(Index i, MatrixView<const double> state, const Arrivals& arrivals,
                             double* row) const {
    const Index left = walk_.first(i);
    const Index right = right_[i];
    const Index bins = walk_.bins();
    if (row != state.row(i)) {
        std::copy(state.row(i), state.row(i) + left, row);
        std::copy(state.row(i) + right, state.row(i) + bins, row + right);
    }
    for (const OuterProduct& from : arrivals) {
        const double factor = from.psi[i];
        if (factor == 0.0) continue;
        add_scaled(factor, from.psibar.data(), row, left);
        add_scaled(factor, from.psibar.data() + right, row + right, bins - right);
    }
    near_left(i, row);
    near_right(i, row);
}

// Tiles of rows by blocks of columns: a tile stays in the cache while the blocks pass.
void FarField::write(MatrixView<const double> state, const Arrivals& arrivals, MatrixView<double> out) {
    begin();
    const Index bins = walk_.bins();
    for (Index tile = 0; tile < bins; tile += rows_a_tile) {
        const Index tile_end = std::min(tile + rows_a_tile, bins);
        for (Index i = tile; i < tile_end; ++i) keep_and_land(i, state, arrivals, out.row(i));
        if (walk_.table().terms == 0) continue;
        for (Index column = 0; column < bins; column += block) {
            const Range columns{column, std::min(column + block, bins)};
            for (Index i = tile; i < tile_end; i += rows_at_once) {
                const Range rows{i, std::min(i + rows_at_once, tile_end)};
                far_left(rows, columns, out);
                far_right(rows, columns, out);
            }
        }
    }
}

}  // namespace comminute::detail
