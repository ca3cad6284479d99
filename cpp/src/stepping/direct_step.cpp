// SPDX-License-Identifier: BSD-3-Clause
// Pushes along rows, then rows pushed down the columns (docs/theory/one_sweep.md, section 13).
#include "stepping/direct_step.hpp"

#include <algorithm>
#include <utility>

#include "simd/loops.hpp"

namespace comminute::detail {

DirectStep::DirectStep(const Kernel& kernel)
    : bins_(kernel.grid().bins()),
      stride_(row_stride(bins_)),
      mass_(kernel.fragments().mass),
      upwards_(kernel.fragments().mass),
      below_(kernel.fragments().below),
      grain_(bins_ * stride_),
      any_(bins_, 0) {
    std::reverse(upwards_.begin(), upwards_.end());
}

// Fragments of one crush in bin `from`; among the fines they stay.
void DirectStep::spread(double mass, Index from, double* line) const {
    if (from == 0) {
        line[0] += mass;
        return;
    }
    add_scaled(mass, upwards_.data() + bins_ - from, line + 1, from);
    line[0] += mass * below_[from];
}

// Divides row i of the state into what rests or lands by crushes in psibar, which is left in it, and what crushes in psi.
void DirectStep::divide_row(Index i, const Kernel& kernel, ZoneRuns& runs, double* row) {
    std::fill_n(grain(i), bins_, 0.0);
    any_[i] = 0;
    for (const ZoneRun& run : runs.of_row(i)) {
        const CrushShares share = kernel.shares(run.zone, i, run.begin);
        for (Index j = run.begin; j < run.end; ++j) {
            const double mass = std::exchange(row[j], 0.0);  // lands in bins that have had their turn
            report_.active += mass;
            report_.crushed += (share.grain + share.both) * mass;
            report_.crushed_neighbour += (share.neighbour + share.both) * mass;
            grain(i)[j] += share.grain * mass;
            if (share.neighbour > 0.0) spread(share.neighbour * mass, j, row);
            if (share.both > 0.0) spread(share.both * mass, j, grain(i));
        }
        if (share.grain + share.both > 0.0) any_[i] = 1;
    }
}

StepReport DirectStep::run(MatrixView<const double> p, const Kernel& kernel, ZoneRuns& runs,
                           MatrixView<double> out) {
    report_ = {};
    report_.steps = 1;
    for (Index i = 0; i < bins_; ++i) {
        if (p.data() != out.data()) std::copy_n(p.row(i), bins_, out.row(i));
        divide_row(i, kernel, runs, out.row(i));
    }
    for (Index i = 0; i < bins_; ++i) {
        if (any_[i] == 0) continue;
        for (Index k = 1; k <= i; ++k) add_scaled(mass_[i - k], grain(i), out.row(k), bins_);
        add_scaled(i > 0 ? below_[i] : 1.0, grain(i), out.row(0), bins_);
    }
    return report_;
}

}  // namespace comminute::detail
