// SPDX-License-Identifier: BSD-3-Clause
// One step with any kernel and any law, bin by bin (docs/theory/one_sweep.md, section 13).
#pragma once

#include "base/arrays.hpp"
#include "comminute/kernel.hpp"
#include "simd/lanes.hpp"
#include "zones/zone_runs.hpp"

namespace comminute::detail {

/// One step of Eq. 61 by pushing the fragments of each crushing cell along its lines, O(N) a cell: for laws without an
/// exponential sum in builds without FFTW.
///
/// As the separable convolution does, it spreads what crushes in psibar along the rows, what crushes in both there first, and
/// then all that crushes in psi, whole rows at a time, down the columns.
class DirectStep {
  public:
    explicit DirectStep(const Kernel& kernel);

    /// @param out  (N, N); may be `p` itself. Entries in the zones must be finite
    StepReport run(MatrixView<const double> p, const Kernel& kernel, ZoneRuns& runs, MatrixView<double> out);

  private:
    void divide_row(Index i, const Kernel& kernel, ZoneRuns& runs, double* row);
    void spread(double mass, Index from, double* line) const;
    double* grain(Index i) { return grain_.data() + i * stride_; }

    Index bins_;
    Index stride_;
    Array<double> mass_;     // (N) f_m
    Array<double> upwards_;  // (N) the same at N - 1 - m
    Array<double> below_;    // (N) share of mass from bin m that lands in the fines bin
    LaneArray grain_;        // (N, stride) what crushes in psi
    Array<char> any_;        // (N) whether any of a row does
    StepReport report_;
};

}  // namespace comminute::detail
