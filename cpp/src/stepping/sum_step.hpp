// SPDX-License-Identifier: BSD-3-Clause
// One step with any kernel by running sums (docs/theory/one_sweep.md, sections 7 and 13).
#pragma once

#include <array>
#include <vector>

#include "comminute/kernel.hpp"
#include "simd/lanes.hpp"
#include "spreading/crush_table.hpp"
#include "zones/zone_runs.hpp"

namespace comminute::detail {

/// One step of Eq. 61 with any kernel by running sums, O(K N^2), where the fragments' law has an exponential sum from
/// the first bin on.
///
/// As the separable convolution does, it spreads what crushes in psibar along the rows, what crushes in both there first,
/// and then all that crushes in psi along the columns. Rows go sixteen at a time, side by side, as far as mass crushes in
/// them; below that their sums only fall, and give a product of K columns of numbers with the table of powers. Columns go
/// a tile at a time, down the rows, in the same two parts.
class SumStep {
  public:
    explicit SumStep(const Kernel& kernel);

    /// Tells whether the law has the sum that it takes; nothing else may be called where it has not.
    bool available() const { return table_.terms > 0; }
    Index terms() const { return table_.terms; }

    /// @param out  (N, N); may be `p` itself. Entries in the zones must be finite
    StepReport run(MatrixView<const double> p, const Kernel& kernel, ZoneRuns& runs, MatrixView<double> out);

  private:
    static constexpr Index rows_a_tile = 16;
    static constexpr Index columns_a_tile = 128;

    /// Bins [begin, end) of a row that may hold mass.
    struct Reach {
        Index begin = 0;
        Index end = 0;
        bool meets(Index from, Index to) const { return begin < to && from < end; }
    };

    void divide_row(Index i, Index lane, const Kernel& kernel, ZoneRuns& runs, double* row);
    void put(Index i, Index j, Index lane, double neighbour, double both, double* row);
    void spread_rows(Index begin, Index end, MatrixView<double> out);
    void land(Index begin, Index end, Index j, MatrixView<double> out);
    void fall_along_rows(Index begin, Index end, Index bottom, Index first_lane, MatrixView<double> to);
    void spread_columns(Index begin, Index end, MatrixView<double> out);
    void fall_along_columns(Index begin, Index end, Index row, Index shell, MatrixView<double> out);
    double* grain(Index i) { return grain_.data() + i * stride_; }
    double* entering(Index j) { return entering_.data() + j * 2 * rows_a_tile; }
    Reach& reach(Index i) { return reach_[i]; }
    static void widen(Reach& reach, Index begin, Index end);

    Index bins_;
    Index stride_;
    double stays_;  // f_0
    CrushTable table_;
    StepReport report_;
    LaneArray grain_;     // (N, stride) what crushes in psi; 0 outside its reach
    Array<Reach> reach_;  // (N)
    LaneArray
        entering_;  // (N, 2, 16) what crushes in psibar and in both, of the rows at hand, by bin; 0 between
    Reach tile_reach_;   // of them
    bool both_ = false;  // whether any of it crushes in both
    std::array<double, 2 * rows_a_tile> fines_{};
    LaneArray sums_;      // (packs, K, lanes) of the lines at hand
    LaneArray arriving_;  // by line
    LaneArray column_fines_;
    Array<double> factors_;  // (K, 4)
};

}  // namespace comminute::detail
