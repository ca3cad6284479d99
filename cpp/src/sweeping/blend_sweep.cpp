// SPDX-License-Identifier: BSD-3-Clause
// Cells of the blend one by one, from coarse shells to fine ones (docs/theory/one_sweep.md, section 12).
#include "sweeping/blend_sweep.hpp"

#include <algorithm>

namespace comminute::detail {

BlendSweep::BlendSweep(const FragmentPmf& fragments, double rate)
    : bins_(static_cast<Index>(fragments.mass.size())),
      rate_(rate),
      stays_(fragments.mass.front()),
      upwards_(fragments.mass),
      below_(fragments.below) {
    std::reverse(upwards_.begin(), upwards_.end());
}

// Adds the fragments of one crush in bin `from` to a line; those that stay in the bin only `with_stay`.
void BlendSweep::spread(double mass, Index from, bool with_stay, double* line) const {
    const double* share = upwards_.data() + bins_ - 1 - from;
    for (Index k = 1; k < from; ++k) line[k] += mass * share[k];
    if (from > 0) line[0] += mass * below_[from];
    if (with_stay) line[from] += mass * (from > 0 ? stays_ : 1.0);
}

// Mass that a crush leaves in its cell is still in the zone and crushes again until it has left; `crushing` counts it
// once for each of these crushes. Fines stay fines, so in row or column 0 the other grain alone moves.
void BlendSweep::crush(Index i, Index j, double mass) {
    const bool fines = i == 0 || j == 0;
    const double leaves = below_[1] * (fines ? 1.0 : 1.0 + rate_ * stays_);
    const double crushing = mass / leaves;
    const double slow = (1.0 - rate_) * crushing;
    const double grain = i == j ? 0.5 : (i > j ? 1.0 : 0.0);
    crushed_ += slow * grain + rate_ * crushing;
    crushed_neighbour_ += slow * (1.0 - grain) + rate_ * crushing;
    if (fines) {
        i > j ? spread(crushing, i, false, column(j)) : spread(crushing, j, false, row(i));
        return;
    }
    if (grain > 0.0) spread(slow * grain, i, false, column(j));
    if (grain < 1.0) spread(slow * (1.0 - grain), j, false, row(i));
    spread(rate_ * crushing, i, false, pending(j));
    spread(rate_ * crushing * stays_, j, false, row(i));
}

void BlendSweep::visit(Index i, Index j, MovingShares share, MatrixView<const double> state,
                       MatrixView<double> out) {
    const double waiting = pending(j)[i];
    if (waiting != 0.0) spread(waiting, j, true, row(i));
    const double landed = row(i)[j] + column(j)[i];
    const double moving = share.divide(state(i, j), landed, &out(i, j));
    if (moving != 0.0) crush(i, j, moving);
}

void BlendSweep::begin(const Arrivals& arrivals) {
    for (Array<double>* lines : {&along_rows_, &along_columns_, &pending_}) lines->assign(bins_ * bins_, 0.0);
    crushed_ = crushed_neighbour_ = 0.0;
    for (const OuterProduct& from : arrivals) {
        for (Index i = 0; i < bins_; ++i) {
            const double factor = from.psi[i];
            for (Index j = 0; j < bins_ && factor != 0.0; ++j) row(i)[j] += factor * from.psibar[j];
        }
    }
}

// Shells from coarse to fine, the diagonal cell first, arms downwards: mass only ever moves to a later cell.
void BlendSweep::run(const ActiveBand& before, const ActiveBand& after, MatrixView<const double> state,
                     const Arrivals& arrivals, MatrixView<double> out) {
    begin(arrivals);
    for (Index m = bins_ - 1; m >= 0; --m) {
        for (Index k = m; k >= 0; --k) {
            const MovingShares share = moving_shares(before.share(m, m - k), after.share(m, m - k));
            visit(m, k, share, state, out);
            if (k < m) visit(k, m, share, state, out);
        }
    }
}

}  // namespace comminute::detail
