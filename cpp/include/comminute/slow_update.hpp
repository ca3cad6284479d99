// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/kernel.hpp"

namespace comminute {

/// One step of the slow kernel (Eq. 63) that looks only at the band of the zone and spreads only the cells in
/// it that hold mass, each along its row or column (Section 8.2). Equal to FullConvolution with the slow
/// kernel.
///
/// Costs one look at the band plus O(N) for each active cell: where the state was at rest and the load has risen a
/// little, those are the O(N) cells at the zone's boundary. Never makes a negative entry. One object per thread; a step
/// allocates nothing.
///
/// @throws ParameterError for a bad material
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 1.0, 64);
/// comminute::SlowUpdate engine(grid, comminute::Material{});
/// std::vector<double> p(64 * 64, 0.0);
/// p[60 * 64 + 59] = 1.0;
/// comminute::MatrixView<double> state(p.data(), 64, 64);
/// CHECK(engine.step(state, 100.0, state).crushed == 1.0);
/// CHECK(std::accumulate(p.begin(), p.end(), 0.0) == doctest::Approx(1.0));
/// @endcode
class SlowUpdate {
  public:
    SlowUpdate(const LogGrid& grid, const Material& material, FragmentRule rule = FragmentRule::paper);

    /// @param p    (N, N) state before the step; active entries must be finite
    /// @param out  (N, N) state after it; may be p itself, and is then updated in place
    /// @throws ShapeError for other shapes or a partial overlap, ParameterError for a bad load or an active
    /// entry
    ///         that is not finite; `out` is then untouched
    StepReport step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out);

    const Kernel& kernel() const { return kernel_; }

  private:
    /// The run of cells in one arm of a shell, from the first with mass to the last.
    struct Run {
        Index begin = 0;
        Index end = 0;
    };
    /// A run taken out of row `shell`, waiting to be spread up its columns.
    struct Lifted {
        Index shell;
        Index begin;
        Index end;
        Index mass;  // where its masses start in lifted_mass_
    };
    void look(MatrixView<const double> p);
    void spread_along_rows(Index m, MatrixView<double> p);
    void lift_row(Index m, MatrixView<double> p);
    void spread_along_columns(MatrixView<double> p);

    Kernel kernel_;
    CrushZones zones_;
    std::vector<double> fragments_reversed_;
    std::vector<Run> in_row_;     // cells (m, j < m): psi crushes
    std::vector<Run> in_column_;  // cells (i < m, m): psibar crushes
    std::vector<Lifted> lifted_;
    std::size_t lifted_runs_ = 0;
    std::vector<double> lifted_mass_;
    Index lifted_cells_ = 0;
    StepReport report_;
};

}  // namespace comminute
