// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "band_sweep.hpp"
#include "multiversion.hpp"

// The cells outside the band: nothing crushes there, so the sums of a line, once its own shell has had its turn, give
// all that lands on it. Row after row; a row is cut into blocks whose references are local, since ratio^-N overflows.

namespace comminute {
namespace {

constexpr Index block = 64;
constexpr double rounding = 1e-17;

struct FourLines {
    std::array<double, 4> factor;
    std::array<const double*, 4> line;
};

COMMINUTE_MULTIVERSION void add_four(const FourLines& from, double* __restrict to, Index count) {
    const double* __restrict l0 = from.line[0];
    const double* __restrict l1 = from.line[1];
    const double* __restrict l2 = from.line[2];
    const double* __restrict l3 = from.line[3];
    const auto [f0, f1, f2, f3] = from.factor;
    for (Index k = 0; k < count; ++k) to[k] += (f0 * l0[k] + f1 * l1[k]) + (f2 * l2[k] + f3 * l3[k]);
}

void add_scaled(double factor, const double* from, double* to, Index count) {
    for (Index k = 0; k < count; ++k) to[k] += factor * from[k];
}

}  // namespace

// Row i below its band, from line i of the rows.
void BandSweep::land_left(const CrushTable& table, Index i, double* row) const {
    const Index end = first(i);
    if (end == 0) return;
    row[0] += rows_.fines[static_cast<std::size_t>(i)];
    if (end == 1) return;

    const Index in_head =
        std::clamp(i - table.head, Index{1}, end);  // nearer than that the head counts apart
    if (in_head < end) {
        for (Index shell = i; shell <= std::min(i + table.head, bins_ - 1) && first(shell) <= i; ++shell) {
            const double mass = *pushed(rows_, shell, i);
            if (mass != 0.0)
                add_scaled(mass, table.mass_towards(shell, in_head), row + in_head, end - in_head);
        }
        for (Index a = 0; a < table.terms; ++a) {
            const double sum = rows_.near[static_cast<std::size_t>(a * bins_ + i)];
            if (sum != 0.0)
                add_scaled(sum, table.powers_towards(a, i, in_head), row + in_head, end - in_head);
        }
    }
    // Terms of fast decay are nothing beyond a few blocks; those left are ever fewer.
    Index terms = table.terms;
    for (Index to = in_head; to > 1 && terms > 0;) {
        const Index from = std::max(to - block, Index{1});
        const Index distance = i - table.head - (to - 1);  // of the block's upper end
        const auto weight = [&](Index a) {
            return rows_.far[static_cast<std::size_t>(a * bins_ + i)] * table.powers(a)[distance];
        };
        while (terms > 0 && std::abs(weight(terms - 1)) <= rounding * std::abs(weight(0))) --terms;
        for (Index a = 0; a < terms; a += 4) {
            FourLines four{};
            for (std::size_t t = 0; t < 4; ++t) {
                const Index term = a + static_cast<Index>(t);
                four.factor[t] = weight(term);
                four.line[t] = table.powers_towards(term, to - 1, from);
            }
            add_four(four, row + from, to - from);
        }
        to = from;
    }
}

void BandSweep::scale_far_sums(const CrushTable& table) {
    scaled_.resize(columns_.far.size());
    largest_.assign(static_cast<std::size_t>(table.terms), 0.0);
    for (Index a = table.terms - 1; a >= 0; --a) {
        double& largest = largest_[static_cast<std::size_t>(a)];
        if (a + 1 < table.terms) largest = largest_[static_cast<std::size_t>(a) + 1];
        for (Index j = 0; j < bins_; ++j) {
            const double slowest = columns_.far[static_cast<std::size_t>(j)];
            const double term = columns_.far[static_cast<std::size_t>(a * bins_ + j)];
            if (slowest > 0.0) largest = std::max(largest, std::abs(term / slowest));
        }
    }
    for (Index a = 0; a < table.terms; ++a) {
        const double* power = table.powers(a);
        for (Index j = 0; j < bins_; ++j) {
            scaled_[static_cast<std::size_t>(a * bins_ + j)] =
                columns_.far[static_cast<std::size_t>(a * bins_ + j)] * power[j % block];
        }
    }
}

// Row i above its band, from the columns `begin` and on.
void BandSweep::land_right(const CrushTable& table, Index i, Index begin, double* row) const {
    if (begin >= bins_) return;
    if (i == 0) {
        for (Index j = begin; j < bins_; ++j) row[j] += columns_.fines[static_cast<std::size_t>(j)];
        return;
    }
    const Index beyond = std::clamp(i + table.head + 1, begin, bins_);
    if (begin < beyond) {
        for (Index shell = begin; shell < bins_; ++shell) {
            const Index from = std::max({begin, first(shell), shell - table.head});
            const Index to = std::min(shell + 1, beyond);
            if (from >= beyond) break;
            if (from >= to) continue;
            add_scaled(table.mass[static_cast<std::size_t>(shell - i)], pushed(columns_, shell, from),
                       row + from, to - from);
        }
        for (Index a = 0; a < table.terms; ++a) {
            const double* power = table.powers(a);
            const double* near = columns_.near.data() + a * bins_;
            for (Index j = begin; j < beyond; ++j) row[j] += near[j] * power[j - i];
        }
    }
    if (table.terms == 0) return;
    // Up to the first whole block column by column, then by blocks.
    const Index whole = std::min((beyond + block - 1) / block * block, bins_);
    for (Index a = 0; a < table.terms; ++a) {
        const double* power = table.powers(a);
        const double* far = columns_.far.data() + a * bins_;
        for (Index j = beyond; j < whole; ++j) row[j] += far[j] * power[j - i - table.head];
    }
    for (Index from = whole; from < bins_; from += block) {
        const Index to = std::min(from + block, bins_);
        const Index distance = from - i - table.head;
        const double slowest = table.powers(0)[distance];
        for (Index a = 0; a < table.terms; a += 4) {
            if (largest_[static_cast<std::size_t>(a)] * table.powers(a)[distance] <= rounding * slowest)
                break;
            FourLines four{};
            for (std::size_t t = 0; t < 4; ++t) {
                const Index term = a + static_cast<Index>(t);
                four.factor[t] = table.powers(term)[distance];
                four.line[t] = scaled_.data() + term * bins_ + from;
            }
            add_four(four, row + from, to - from);
        }
    }
}

void BandSweep::far_field(const CrushTable& table, MatrixView<const double> state,
                          const std::vector<OuterProduct>& arrivals, MatrixView<double> out) {
    if (table.terms > 0) scale_far_sums(table);
    Index right = 0;  // the first column whose band lies above the row
    for (Index i = 0; i < bins_; ++i) {
        while (right < bins_ && first(right) <= i) ++right;
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
        land_left(table, i, row);
        land_right(table, i, right, row);
    }
}

}  // namespace comminute
