// SPDX-License-Identifier: BSD-3-Clause
// Running sums along tiles of rows, then of columns (docs/theory/one_sweep.md, sections 7 and 13).
#include "stepping/sum_step.hpp"

#include <algorithm>

#include "simd/loops.hpp"
#include "simd/sums.hpp"

namespace comminute::detail {
namespace {

constexpr Index columns_a_reference =
    64;  // powers are taken from the last of so many bins, lest they become denormal
constexpr Index rows_ahead = 4;

// A law that needs a head of bins taken one by one is better left to transforms.
ExponentialSum sum_of(const Kernel& kernel) {
    ExponentialSum sum = exponential_sum(kernel.material().fragments, kernel.grid().spacing(),
                                         kernel.fragments(), kernel.options().scheme);
    return sum.head == 0 ? sum : ExponentialSum{};
}

}  // namespace

SumStep::SumStep(const Kernel& kernel)
    : bins_(kernel.grid().bins()),
      stride_(row_stride(bins_)),
      stays_(kernel.fragments().mass[0]),
      table_(CrushTable::make(kernel.fragments(), sum_of(kernel), 1.0)) {
    if (!available()) return;
    grain_.resize(bins_ * stride_);
    reach_.resize(bins_);
    entering_.resize(bins_ * 2 * rows_a_tile);
    sums_.resize(table_.terms * columns_a_tile);
    arriving_.resize(columns_a_tile);
    column_fines_.resize(columns_a_tile);
    factors_.resize(table_.terms * rows_at_once);
}

void SumStep::widen(Reach& reach, Index begin, Index end) {
    if (reach.end == 0) reach = {begin, end};
    reach = {std::min(reach.begin, begin), std::max(reach.end, end)};
}

// Divides row i of the state into what rests, which is left in it, and what crushes in psi, psibar or both.
void SumStep::divide_row(Index i, Index lane, const Kernel& kernel, ZoneRuns& runs, double* row) {
    Reach& old = reach(i);
    std::fill(grain(i) + old.begin, grain(i) + old.end, 0.0);
    old = {};
    for (const ZoneRun& run : runs.of_row(i)) {
        const CrushShares share = kernel.shares(run.zone, i, run.begin);
        const Index count = run.end - run.begin;
        const double mass = sum(row + run.begin, count);
        add_scaled(share.grain, row + run.begin, grain(i) + run.begin, count);
        report_.active += mass;
        report_.crushed += (share.grain + share.both) * mass;
        report_.crushed_neighbour += (share.neighbour + share.both) * mass;
        if (share.grain + share.both > 0.0) widen(reach(i), run.begin, run.end);
        if (share.neighbour + share.both > 0.0) {
            widen(tile_reach_, run.begin, run.end);
            both_ = both_ || share.both > 0.0;
            for (Index j = run.begin; j < run.end; ++j) {
                put(i, j, lane, share.neighbour * row[j], share.both * row[j], row);
            }
        } else {
            std::fill(row + run.begin, row + run.end, 0.0);
        }
    }
}

// Mass that crushes in psibar, or in both, takes the place of its cell's.
void SumStep::put(Index i, Index j, Index lane, double neighbour, double both, double* row) {
    const double stays = j == 0 ? 1.0 : stays_;
    const double below = j == 0 ? 0.0 : table_.below[j];
    row[j] = stays * neighbour;
    grain(i)[j] += stays * both;
    at(fines_, lane) += below * neighbour;
    at(fines_, rows_a_tile + lane) += below * both;
    entering(j)[lane] = neighbour;
    entering(j)[rows_a_tile + lane] = both;
}

// Adds the mass that has arrived in bin j of the rows at hand.
void SumStep::land(Index begin, Index end, Index j, MatrixView<double> out) {
    for (Index i = begin; i < end; ++i) out(i, j) += arriving_[i - begin];
    if (!both_) return;
    for (Index i = begin; i < end; ++i) {
        grain(i)[j] += arriving_[rows_a_tile + i - begin];
    }
}

void SumStep::spread_rows(Index begin, Index end, MatrixView<double> out) {
    const Index count = both_ ? 2 * rows_a_tile : rows_a_tile;
    const Index finest = std::max(tile_reach_.begin, Index{1});
    const Index bottom = 1 + lanes_down(finest - 1);  // from there on the sums only fall, whole packs of bins
    std::fill_n(sums_.begin(), table_.terms * count, 0.0);
    Index shell = -1;  // of a block; none has entered yet
    for (Index j = tile_reach_.end - 2; j >= bottom; --j) {
        if (++shell == table_.shells_a_block) {
            decay(table_.block_decay.data(), table_.terms, sums_.data(), count);
            shell = 0;
        }
        advance(table_.falling_sums(shell, sums_.data()), entering(j + 1), arriving_.data(), count);
        land(begin, end, j, out);
    }
    if (bottom > 1) {
        // The sums as they leave the last bin, by row.
        const double* falling = table_.falling_at(std::max(shell, Index{0}));
        for (Index lane = 0; lane < count; ++lane) {
            for (Index a = 0; a < table_.terms; ++a) {
                double& sum = sums_[(lane / lanes * table_.terms + a) * lanes + lane % lanes];
                sum = sum * falling[a] + table_.coefficient[a] * entering(bottom)[lane];
            }
        }
        fall_along_rows(begin, end, bottom, 0, out);
        if (both_) fall_along_rows(begin, end, bottom, rows_a_tile, {grain_.data(), bins_, bins_, stride_});
    }
    for (Index i = begin; i < end; ++i) {
        out(i, 0) += at(fines_, i - begin);
        grain(i)[0] += at(fines_, rows_a_tile + i - begin);
        if (both_) widen(reach(i), 0, 1);
    }
    std::fill(entering(tile_reach_.begin),
              entering(tile_reach_.begin) + (tile_reach_.end - tile_reach_.begin) * 2 * rows_a_tile, 0.0);
}

// Adds the mass that the rows' sums give to bins 1 to bottom - 1.
void SumStep::fall_along_rows(Index begin, Index end, Index bottom, Index first_lane, MatrixView<double> to) {
    const auto factor = [&](Index lane, Index a, Index last) {
        return sums_[(lane / lanes * table_.terms + a) * lanes + lane % lanes] *
               table_.powers(a)[bottom - last];
    };
    for (Index from = 1; from < bottom; from += columns_a_reference) {
        const Index count = std::min(columns_a_reference, bottom - from);
        const Index last = from + count - 1;
        const Index terms = table_.terms_from[bottom - last];
        const double* power = table_.powers_towards(0, last, from);
        Index i = begin;
        for (; i + rows_at_once <= end; i += rows_at_once) {
            for (Index a = 0; a < terms; ++a) {
                for (Index r = 0; r < rows_at_once; ++r) {
                    factors_[a * rows_at_once + r] = factor(first_lane + i - begin + r, a, last);
                }
            }
            add_to_rows({power, lanes, table_.stride}, factors_.data(), terms, to.row(i) + from, to.stride(),
                        count);
        }
        for (; i < end; ++i) {
            for (Index a = 0; a < terms; ++a) {
                factors_[a] = factor(first_lane + i - begin, a, last);
            }
            add_terms(factors_.data(), {power, table_.stride}, terms, to.row(i) + from, count);
        }
    }
}

// Columns [begin, end), at most a tile. Where they are no whole packs, they are walked down to the last row.
void SumStep::spread_columns(Index begin, Index end, MatrixView<double> out) {
    Index top = bins_ - 1;
    while (top >= 0 && !reach(top).meets(begin, end)) --top;
    if (top < 0) return;
    Index lowest = 0;
    while (!reach(lowest).meets(begin, end)) ++lowest;

    const Index count = end - begin;
    const Index padded = lanes_up(count);
    std::fill_n(sums_.begin(), table_.terms * padded, 0.0);
    std::fill_n(column_fines_.begin(), padded, 0.0);
    std::fill_n(arriving_.begin(), padded, 0.0);
    const auto falls = [&](Index row) {
        return row + 1 < lowest && count == padded && row % rows_at_once == 0;
    };
    Index shell = -1;
    Index row = top;
    for (; row > 0 && !falls(row); --row) {
        fetch(out.row(std::max(row - rows_ahead, Index{0})) + begin, count);
        if (row < top) {
            if (++shell == table_.shells_a_block) {
                decay(table_.block_decay.data(), table_.terms, sums_.data(), padded);
                shell = 0;
            }
            advance(table_.falling_sums(shell, sums_.data()), grain(row + 1) + begin, arriving_.data(),
                    padded);
        }
        settle_row({grain(row) + begin, arriving_.data(), stays_, table_.below[row]}, out.row(row) + begin,
                   column_fines_.data(), count);
    }
    if (row > 0) fall_along_columns(begin, end, row, shell, out);
    for (Index k = 0; k < count; ++k) out(0, begin + k) += column_fines_[k] + grain(0)[begin + k];
}

// Adds the mass that the columns' sums, as of `row` + 1, give to rows `row` to 1.
void SumStep::fall_along_columns(Index begin, Index end, Index row, Index shell, MatrixView<double> out) {
    const double* falling = table_.falling_at(shell);
    for (Index top = row; top > 0; top -= rows_at_once) {
        const Index first = top - rows_at_once + 1;
        for (Index r = 0; r < rows_at_once; ++r) {
            fetch(out.row(std::max(first - rows_at_once + r, Index{0})) + begin, end - begin);
        }
        const Index terms = table_.terms_from[row + 1 - top];
        for (Index a = 0; a < terms; ++a) {
            for (Index r = 0; r < rows_at_once; ++r) {
                factors_[a * rows_at_once + r] = falling[a] * table_.powers(a)[row + 1 - first - r];
            }
        }
        add_to_rows({sums_.data(), table_.terms * lanes, lanes}, factors_.data(), terms,
                    out.row(first) + begin, out.stride(), end - begin);
    }
}

StepReport SumStep::run(MatrixView<const double> p, const Kernel& kernel, ZoneRuns& runs,
                        MatrixView<double> out) {
    report_ = {};
    report_.steps = 1;
    report_.terms = table_.terms;
    for (Index begin = 0; begin < bins_; begin += rows_a_tile) {
        const Index end = std::min(begin + rows_a_tile, bins_);
        tile_reach_ = {};
        both_ = false;
        fines_.fill(0.0);
        for (Index i = begin; i < end; ++i) {
            if (p.data() != out.data()) std::copy_n(p.row(i), bins_, out.row(i));
            divide_row(i, i - begin, kernel, runs, out.row(i));
        }
        if (tile_reach_.end > 0) spread_rows(begin, end, out);
    }
    const Index whole = lanes_down(bins_);
    for (Index begin = 0; begin < whole; begin += columns_a_tile) {
        spread_columns(begin, std::min(begin + columns_a_tile, whole), out);
    }
    if (whole < bins_) spread_columns(whole, bins_, out);
    return report_;
}

}  // namespace comminute::detail
