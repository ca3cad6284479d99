// SPDX-License-Identifier: BSD-3-Clause
#include "sweeping/blend_sweep.hpp"

#include <algorithm>

namespace comminute::detail {

BlendSweep::BlendSweep(const FragmentPmf& fragments, double rate)
    : fragments_(fragments),
      upwards_(fragments.mass.rbegin(), fragments.mass.rend()),
      rate_(rate),
      bins_(static_cast<Index>(fragments.mass.size())) {}

// Adds the fragments of one crush in bin `from` to a line, those that stay in the bin only where asked for.
void BlendSweep::spread(double mass, Index from, bool with_stay, double* line) const {
    const double* share = upwards_.data() + bins_ - 1 - from;
    for (Index k = 1; k < from; ++k) line[k] += mass * share[k];
    if (from > 0) line[0] += mass * fragments_.below[static_cast<std::size_t>(from)];
    if (with_stay) line[from] += mass * (from > 0 ? fragments_.mass[0] : 1.0);
}

// What a crush leaves in its cell is in the zone still and crushes again, until it has left: `mass` counts once for
// every one of these crushes. Fines stay fines, so in row or column 0 only the other grain moves.
void BlendSweep::crush(Index i, Index j, double mass) {
    const double stays = fragments_.mass[0];
    const bool fines = i == 0 || j == 0;
    const double leaves = fragments_.below[1] * (fines ? 1.0 : 1.0 + rate_ * stays);
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
    spread(rate_ * crushing * stays, j, false, row(i));
}

void BlendSweep::visit(Index i, Index j, double settled_share, double arrived_share,
                       MatrixView<const double> state, MatrixView<double> out) {
    const double waiting = pending(j)[i];
    if (waiting != 0.0) spread(waiting, j, true, row(i));
    const double landed = row(i)[j] + column(j)[i];
    const double there = state(i, j);
    const double moving = (settled_share != 0.0 ? there * settled_share : 0.0) + landed * arrived_share;
    out(i, j) = there * (1.0 - settled_share) + landed * (1.0 - arrived_share);
    if (moving != 0.0) crush(i, j, moving);
}

void BlendSweep::run(const ActiveBand& before, const ActiveBand& after, MatrixView<const double> state,
                     const std::vector<OuterProduct>& arrivals, MatrixView<double> out) {
    const auto cells = static_cast<std::size_t>(bins_ * bins_);
    along_rows_.assign(cells, 0.0);
    along_columns_.assign(cells, 0.0);
    pending_.assign(cells, 0.0);
    crushed_ = crushed_neighbour_ = 0.0;
    for (const OuterProduct& from : arrivals) {
        for (Index i = 0; i < bins_; ++i) {
            const double factor = from.psi[static_cast<std::size_t>(i)];
            for (Index j = 0; j < bins_ && factor != 0.0; ++j) {
                row(i)[j] += factor * from.psibar[static_cast<std::size_t>(j)];
            }
        }
    }
    // Shells from coarse to fine, the diagonal cell first, arms downwards: mass only ever moves to a later cell.
    for (Index m = bins_ - 1; m >= 0; --m) {
        for (Index k = m; k >= 0; --k) {
            const double was = before.share(m, m - k);
            const double arrived = std::max(after.share(m, m - k), was);  // rounding may shrink it by an ulp
            const double settled = was < 1.0 ? (arrived - was) / (1.0 - was) : 0.0;
            visit(m, k, settled, arrived, state, out);
            if (k < m) visit(k, m, settled, arrived, state, out);
        }
    }
}

}  // namespace comminute::detail
