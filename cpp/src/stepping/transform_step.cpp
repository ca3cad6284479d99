// SPDX-License-Identifier: BSD-3-Clause
// Masked fields along rows, then along columns, through pairs of lines (docs/theory/one_sweep.md, section 13).
#include "stepping/transform_step.hpp"

#include <algorithm>

#include "simd/loops.hpp"
#include "simd/pairs.hpp"

namespace comminute::detail {
namespace {

// A run without what is empty at its ends.
ZoneRun trimmed(ZoneRun run, const double* mass) {
    while (run.end > run.begin && mass[run.end - 1] == 0.0) --run.end;
    while (run.begin < run.end && mass[run.begin] == 0.0) ++run.begin;
    return run;
}

}  // namespace

TransformStep::TransformStep(const Kernel& kernel, PlanEffort effort)
    : spreader_(kernel.fragments().mass, lanes / 2, effort),
      some_stays_(kernel.fragments().mass[0] > 0.0),
      stride_(row_stride(kernel.grid().bins())),
      psi_crushing_(kernel.grid().bins() * stride_),
      reach_(kernel.grid().bins()) {}

// Puts a share of a run's mass on a line of the pair, which it opens if need be.
void TransformStep::push(PairedLine*& line, double* to, double share, const double* mass,
                         const ZoneRun& run) {
    if (share == 0.0) return;
    if (line == nullptr) {
        line = &lines_[line_count_++];
        *line = {0.0, run.begin, -1, to};
    }
    double* numbers = spreader_.pair(0) + (line - lines_.data());
    for (Index j = run.begin; j < run.end; ++j) numbers[2 * j] = share * mass[j];
    line->pushed += share * sum(mass + run.begin, run.end - run.begin);
    line->coarsest = run.end - 1;
}

// Divides row i of the state, which lies in `rest`, into what rests and what crushes in psi (to psi_crushing_),
// psibar or both.
void TransformStep::split_row(const Kernel& kernel, Index i, VectorView<const ZoneRun> runs, double* rest) {
    double* grain = psi_crushing_.data() + i * stride_;
    std::fill_n(grain, runs.size() == 0 ? 0 : lanes_up(runs[runs.size() - 1].end), 0.0);
    reach_[i] = 0;
    PairedLine* neighbour = nullptr;
    PairedLine* both = nullptr;
    for (const ZoneRun& whole : runs) {
        const ZoneRun run = trimmed(whole, rest);
        if (run.begin == run.end) continue;
        const CrushShares share = kernel.shares(run.zone, i, run.begin);
        const Index count = run.end - run.begin;
        const double mass = sum(rest + run.begin, count);
        report_.active += mass;
        report_.crushed += (share.grain + share.both) * mass;
        report_.crushed_neighbour += (share.neighbour + share.both) * mass;
        add_scaled(share.grain, rest + run.begin, grain + run.begin, count);
        push(neighbour, rest, share.neighbour, rest, run);
        push(both, grain, share.both, rest, run);
        if (share.grain + share.both > 0.0) reach_[i] = run.end;
        std::fill_n(rest + run.begin, count, 0.0);
    }
}

// Spreads pair q, whose lines_ are those at hand.
void TransformStep::spread_pair(Index q) {
    double* pair = spreader_.pair(q);
    const auto unlevel = level(pair, lines_);
    spreader_.spread(q, finest(lines_), coarsest(lines_));
    clean(pair, lines_, unlevel, some_stays_);
}

// Spreads what crushes in psibar, and adds it where it belongs.
void TransformStep::spread_lines() {
    if (line_count_ == 0) return;
    if (line_count_ == 1) lines_[1] = {0.0, lines_[0].finest, -1, nullptr};
    spread_pair(0);
    for (std::size_t b = 0; b < line_count_; ++b) {
        add_line(spreader_.pair(0) + b, lines_[b].to, lines_[b].coarsest + 1);
    }
    spreader_.clear(0);
    line_count_ = 0;
}

// Takes eight columns of what crushes in psi into pairs.
TransformStep::Gathered TransformStep::gather(Index begin) {
    Gathered columns;
    const Index bins = reach_.size();
    for (Index i = 0; i < bins;) {
        Index end = i;
        while (end < bins && reach_[end] > begin) ++end;
        if (end > i) {
            gather_columns(psi_crushing_.data() + i * stride_ + begin, stride_, end - i,
                           spreader_.pair(0) + 2 * i, spreader_.distance(), columns.pushed.data());
            if (columns.end == 0) columns.begin = i;
            columns.end = end;
        }
        i = end + 1;
    }
    return columns;
}

// Spreads what crushes in psi, eight columns at a time.
void TransformStep::spread_columns(Index begin, MatrixView<double> out) {
    const Gathered columns = gather(begin);
    if (columns.end == 0) return;
    for (Index q = 0; q < lanes / 2; ++q) {
        double* pair = spreader_.pair(q);
        for (std::size_t b = 0; b < 2; ++b) {
            Index top = columns.end - 1;
            while (top >= columns.begin && pair[2 * top + static_cast<Index>(b)] == 0.0) --top;
            lines_[b] = {columns.pushed[static_cast<std::size_t>(2 * q) + b], columns.begin,
                         top < columns.begin ? -1 : top, nullptr};
        }
        if (coarsest(lines_) < 0) continue;
        spread_pair(q);
        std::fill(pair + 2 * (coarsest(lines_) + 1), pair + 2 * columns.end, 0.0);
    }
    add_columns(spreader_.pair(0), spreader_.distance(), columns.end, out, begin);
    for (Index q = 0; q < lanes / 2; ++q) spreader_.clear(q);
}

StepReport TransformStep::run(MatrixView<const double> p, const Kernel& kernel, ZoneRuns& runs,
                              MatrixView<double> out) {
    const Index bins = kernel.grid().bins();
    const KernelKind kind = kernel.options().kind;
    const bool two_lines = kind == KernelKind::exact || kind == KernelKind::blend;
    report_ = {};
    report_.steps = 1;
    for (Index i = 0; i < bins; ++i) {
        if (out.data() != p.data()) std::copy_n(p.row(i), bins, out.row(i));
        split_row(kernel, i, runs.of_row(i), out.row(i));
        if (two_lines || line_count_ == lines_.size()) spread_lines();
    }
    spread_lines();
    for (Index j = 0; j < bins; j += lanes) spread_columns(j, out);
    return report_;
}

}  // namespace comminute::detail
