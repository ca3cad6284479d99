// SPDX-License-Identifier: BSD-3-Clause
// One step with any kernel by FFT (docs/theory/one_sweep.md, section 13).
#pragma once

#include <array>

#include "base/arrays.hpp"
#include "simd/lanes.hpp"
#include "stepping/fft_plan.hpp"
#include "stepping/line_pairs.hpp"
#include "zones/zone_runs.hpp"

namespace comminute::detail {

/// One step of Eq. 61 with any kernel by separable linear convolutions in FFTW, O(N^2 log N); see FullConvolution.
class TransformStep {
  public:
    TransformStep(const Kernel& kernel, PlanEffort effort);

    /// @param out  (N, N); may be `p` itself. Entries must be finite
    StepReport run(MatrixView<const double> p, const Kernel& kernel, ZoneRuns& runs, MatrixView<double> out);

  private:
    /// Columns in pairs side by side: the rows that may hold mass, and the mass of each column.
    struct Gathered {
        Index begin = 0;
        Index end = 0;
        std::array<double, lanes> pushed{};
    };

    void split_row(const Kernel& kernel, Index i, VectorView<const ZoneRun> runs, double* rest);
    void push(PairedLine*& line, double* to, double share, const double* mass, const ZoneRun& run);
    void spread_pair(Index q);
    void spread_lines();
    Gathered gather(Index begin);
    void spread_columns(Index begin, MatrixView<double> out);

    LineSpreader spreader_;
    bool some_stays_;  // whether part of a crush stays in its own bin; never under the paper's scheme
    Index stride_;
    LaneArray psi_crushing_;      // (N, stride) mass to be spread along psi: a + f *_psibar c
    Array<Index> reach_;          // (N) bins of psi_crushing's rows, from the finest, that may hold mass
    LinePair lines_;              // the pair at hand
    std::size_t line_count_ = 0;  // lines of it that are taken, while rows are divided
    StepReport report_;
};

}  // namespace comminute::detail
