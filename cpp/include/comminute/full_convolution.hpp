// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "comminute/export.hpp"
#include "comminute/kernel.hpp"

namespace comminute {

/// Effort of FFTW's planner when an engine is made.
enum class PlanEffort {
    estimate,  ///< milliseconds
    measure,   ///< seconds, for a somewhat faster step
};

/// Means by which a step spreads mass.
enum class StepPath {
    automatic,   ///< sums where the fragments' law has them, else transforms
    transforms,  ///< FFTW, any law, O(N^2 log N)
    sums,        ///< running sums, O(K N^2), for a law that is a sum of K exponentials from its first bin on
};

/// One step of Eq. 61 with any kernel, every active cell at once, by separable linear convolutions.
///
/// With the mass masked by what crushes into a (psi), b (psibar) and c (both), the step is
/// p' = rest + f *_psi (a + f *_psibar c) + f *_psibar b. Mass at rest is not touched.
///
/// Running sums meet f to 2e-14 of its largest entry and take a fraction of FFTW's time; the report's `terms` is K then,
/// and 0 for a step by FFTW. In the latter two lines share a complex transform, the shortest that keeps both linear, and
/// lines without mass take none. FFT noise is removed line by line: bins where no fragment can land are set to 0 (above a
/// line's coarsest source, and in that bin too where no fragment stays in its bin), so are negative entries, and the fines
/// bin takes the mass crushed less the mass landed (a deficit there is taken from the line's largest entry).
///
/// Owns its workspace (about one state); use one object per thread. A step allocates nothing.
///
/// @throws UnavailableError if it needs FFTW and the library was built without; ParameterError for sums that the law does
///         not have
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 1.0, 64);
/// comminute::FullConvolution engine(
///     comminute::Kernel(grid, comminute::Material{}, comminute::KernelKind::exact));
/// std::vector<double> p(64 * 64, 0.0);
/// p[54 * 64 + 54] = 1.0;
/// comminute::MatrixView<double> state(p.data(), 64, 64);
/// auto report = engine.step(state, 100.0, state);
/// CHECK(report.crushed == 1.0);
/// CHECK(p[54 * 64 + 54] < 1e-30);
/// @endcode
class COMMINUTE_API FullConvolution {
  public:
    explicit FullConvolution(Kernel kernel, StepPath path = StepPath::automatic,
                             PlanEffort effort = PlanEffort::estimate);
    ~FullConvolution();
    FullConvolution(FullConvolution&&) noexcept;
    FullConvolution& operator=(FullConvolution&&) noexcept;
    FullConvolution(const FullConvolution&) = delete;
    FullConvolution& operator=(const FullConvolution&) = delete;

    /// @param p    (N, N) state before the step, entries finite and at least 0
    /// @param out  (N, N) state after it; may be p itself
    /// @throws ShapeError for other shapes or a partial overlap, ParameterError for a bad load or an entry
    /// that is
    ///         not finite; `out` is then untouched
    StepReport step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out);

    const Kernel& kernel() const;
    /// As it was asked for.
    StepPath path() const;

  private:
    struct Workspace;
    std::unique_ptr<Workspace> work_;
};

/// Whether this build has FFTW, and so FullConvolution for any law.
COMMINUTE_API bool has_fftw();

}  // namespace comminute
