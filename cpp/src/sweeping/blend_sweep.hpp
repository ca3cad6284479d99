// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "sweeping/band_sweep.hpp"

namespace comminute::detail {

/// One sweep of the blend (Eq. 67), bin by bin: (1 - rate) slow + rate fast, the fast share crushing both grains.
///
/// What crushes in both is spread in psi at once, and waits in the cells where it landed for its spread in psibar until
/// they have their turn: two lines instead of a rectangle.
class BlendSweep {
  public:
    BlendSweep(const FragmentPmf& fragments, double rate);

    /// @param out  (N, N), all of it written; may be `state` itself
    void run(const ActiveBand& before, const ActiveBand& after, MatrixView<const double> state,
             const std::vector<OuterProduct>& arrivals, MatrixView<double> out);

    double crushed() const { return crushed_; }
    double crushed_neighbour() const { return crushed_neighbour_; }

  private:
    void visit(Index i, Index j, double settled_share, double arrived_share, MatrixView<const double> state,
               MatrixView<double> out);
    void crush(Index i, Index j, double mass);
    void spread(double mass, Index from, bool with_stay, double* line) const;
    double* row(Index i) { return along_rows_.data() + i * bins_; }
    double* column(Index j) { return along_columns_.data() + j * bins_; }
    double* pending(Index j) { return pending_.data() + j * bins_; }

    FragmentPmf fragments_;
    std::vector<double> upwards_;  // f_m at N - 1 - m
    double rate_;
    Index bins_;
    std::vector<double> along_rows_;     // [i][j] what has landed by crushes in psibar
    std::vector<double> along_columns_;  // [j][i] by crushes in psi
    std::vector<double> pending_;        // [j][i] landed in psi, still to crush in psibar
    double crushed_ = 0.0;
    double crushed_neighbour_ = 0.0;
};

}  // namespace comminute::detail
