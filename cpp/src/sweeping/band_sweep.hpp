// SPDX-License-Identifier: BSD-3-Clause
// One sweep of the slow rule over the band of the zone (docs/theory/one_sweep.md, section 5).
#pragma once

#include "sweeping/far_field.hpp"
#include "sweeping/lines_in_flight.hpp"
#include "sweeping/outer_product.hpp"
#include "sweeping/shell_arms.hpp"
#include "sweeping/shell_shares.hpp"
#include "sweeping/shell_walk.hpp"
#include "sweeping/state_columns.hpp"

namespace comminute::detail {

/// One sweep of the slow rule over the band of the zone, shell by shell from coarse to fine.
///
/// Shell m holds the cells whose larger index is m: the diagonal cell (m, m), the arm (m, j < m) whose mass crushes in
/// psi and falls down column j, and the arm (i < m, m) whose mass crushes in psibar and falls along row i. When shell m
/// has its turn, all mass that lands in it has been pushed by shells above, but for the fragments of (m, m) in its own
/// arms; and the cells of an arm do not feed each other, so every inner loop runs along an arm.
class BandSweep {
  public:
    explicit BandSweep(Index bins);
    /// Makes a workspace of its own; the results of the other are not copied.
    BandSweep(const BandSweep& other) : BandSweep(other.walk_.bins()) {}
    BandSweep& operator=(const BandSweep&) = delete;

    /// @param table   fragments of mass that crushes until it leaves its bin
    /// @param before  shares of the cells that were active when `state` settled
    /// @param after   shares that are active now, none smaller
    /// @param out     (N, N) the cells in the band are written; null: no state is wanted
    void run(const CrushTable& table, const ActiveBand& before, const ActiveBand& after,
             MatrixView<const double> state, const Arrivals& arrivals, MatrixView<double>* out);

    /// Writes the cells outside the band: their mass before and the mass that lands there. Only after a run with `out`
    /// and the same table, state and arrivals.
    void far_field(MatrixView<const double> state, const Arrivals& arrivals, MatrixView<double> out) {
        far_field_.write(state, arrivals, out);
    }

    /// (N) mass crushed in psi out of each row, counted each time that it leaves its bin.
    const Array<double>& crushed_rows() const { return crushed_rows_; }
    /// Sum of these, and the same for mass crushed in psibar out of the columns.
    double crushed() const { return crushed_; }
    double crushed_neighbour() const { return crushed_neighbour_; }

  private:
    void crush_shell(Index m, MatrixView<const double> state, const Arrivals& arrivals, double* rest);
    double crush_diagonal(Index m, double there, const Arrivals& arrivals, double* rest);
    const double* row_of(MatrixView<const double> state, Index m);

    ShellWalk walk_;
    LinesInFlight columns_;
    LinesInFlight rows_;
    ShellShares shares_;
    ShellArms arms_;
    StateColumns state_columns_;
    FarField far_field_;
    LaneArray last_row_;
    Array<double> crushed_rows_;
    double crushed_ = 0.0;
    double crushed_neighbour_ = 0.0;
};

}  // namespace comminute::detail
