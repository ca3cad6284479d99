// SPDX-License-Identifier: BSD-3-Clause
// One sweep of the blend of slow and fast crushing, bin by bin (docs/theory/one_sweep.md, section 12).
#pragma once

#include "base/arrays.hpp"
#include "comminute/fragments.hpp"
#include "sweeping/outer_product.hpp"
#include "zones/active_band.hpp"
#include "zones/moving_shares.hpp"

namespace comminute::detail {

/// One sweep of the blend (Eq. 67), bin by bin: (1 - rate) slow + rate fast, the fast share crushing both grains.
///
/// Mass that crushes in both grains is spread in psi at once. Its spread in psibar waits in the cells where it landed
/// until they have their turn: two lines for each cell instead of a rectangle.
class BlendSweep {
  public:
    BlendSweep(const FragmentPmf& fragments, double rate);

    /// @param before  shares of the cells that were active when `state` settled
    /// @param after   shares that are active now, none smaller
    /// @param out     (N, N), all of it written; may be `state` itself
    void run(const ActiveBand& before, const ActiveBand& after, MatrixView<const double> state,
             const Arrivals& arrivals, MatrixView<double> out);

    /// Mass crushed in psi and in psibar, every crush counted.
    double crushed() const { return crushed_; }
    double crushed_neighbour() const { return crushed_neighbour_; }

  private:
    void begin(const Arrivals& arrivals);
    void visit(Index i, Index j, MovingShares share, MatrixView<const double> state, MatrixView<double> out);
    void crush(Index i, Index j, double mass);
    void spread(double mass, Index from, bool with_stay, double* line) const;
    double* row(Index i) { return along_rows_.data() + i * bins_; }
    double* column(Index j) { return along_columns_.data() + j * bins_; }
    double* pending(Index j) { return pending_.data() + j * bins_; }

    Index bins_;
    double rate_;
    double stays_;                 // f_0
    Array<double> upwards_;        // (N) f_m at N - 1 - m
    Array<double> below_;          // (N) share of mass from bin m that lands in the fines bin
    Array<double> along_rows_;     // (N, N) [i, j] mass landed by crushes in psibar
    Array<double> along_columns_;  // (N, N) [j, i] mass landed by crushes in psi
    Array<double> pending_;        // (N, N) [j, i] mass landed in psi that has still to crush in psibar
    double crushed_ = 0.0;
    double crushed_neighbour_ = 0.0;
};

}  // namespace comminute::detail
