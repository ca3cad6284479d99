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
    automatic,  ///< sums where the fragments' law has them, else transforms, or direct in a build without FFTW
    transforms,  ///< FFTW, any law, O(N^2 log N)
    sums,        ///< running sums, O(K N^2), for a law that is a sum of K exponentials from its first bin on
    direct,      ///< bin by bin, any law, O(N) for each active cell
};

/// Choices of a FullConvolution: those of its kernel, and how it is computed.
struct FullConvolutionOptions : KernelOptions {
    StepPath path = StepPath::automatic;
    PlanEffort effort = PlanEffort::estimate;  ///< of FFTW's planner; of no account where sums are taken
    friend bool operator==(const FullConvolutionOptions& a, const FullConvolutionOptions& b) {
        return static_cast<const KernelOptions&>(a) == b && a.path == b.path && a.effort == b.effort;
    }
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
/// Owns its workspace (about one state); one object per thread. A copy has a workspace of its own and shares FFTW's plans,
/// which never change, so it costs no planning. A step allocates nothing.
///
/// @throws UnavailableError if transforms are asked for and the library was built without FFTW; ParameterError as Kernel, and
///         for sums that the law does not have
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 1.0, 64);
/// comminute::FullConvolutionOptions options;
/// options.kind = comminute::KernelKind::exact;
/// options.scheme = comminute::Scheme::paper;  // every crush moves a bin or more
/// comminute::FullConvolution engine(grid, comminute::Material{}, options);
/// std::vector<double> p(64 * 64, 0.0);
/// p[54 * 64 + 54] = 1.0;
/// comminute::MatrixView<double> state(p.data(), 64, 64);
/// auto report = engine.step(state, 100.0, state);
/// CHECK(report.crushed == 1.0);
/// CHECK(p[54 * 64 + 54] < 1e-30);
/// @endcode
class COMMINUTE_API FullConvolution {
  public:
    FullConvolution(const LogGrid& grid, const Material& material,
                    const FullConvolutionOptions& options = {});
    ~FullConvolution();
    FullConvolution(const FullConvolution& other);
    FullConvolution& operator=(const FullConvolution& other);
    FullConvolution(FullConvolution&&) noexcept;
    FullConvolution& operator=(FullConvolution&&) noexcept;

    /// @param p    (N, N) state before the step, entries finite and at least 0
    /// @param out  (N, N) state after it; may be p itself
    /// @throws ShapeError for other shapes or a partial overlap, ParameterError for a bad load or an entry that is not
    ///         finite; `out` is then untouched
    StepReport step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out);

    const LogGrid& grid() const;
    const Material& material() const;
    const FullConvolutionOptions& options() const;
    const Kernel& kernel() const;
    /// The path that steps take: transforms, sums or direct.
    StepPath path() const;

  private:
    struct Work;
    std::unique_ptr<Work> work_;
};

/// Tells whether this build has FFTW, and so FullConvolution its transforms.
COMMINUTE_API bool has_fftw();

/// Lends the library the lock with which the host guards FFTW's planner.
///
/// Making and destroying plans changes state that FFTW keeps for the whole process, and no two threads may do so at once;
/// executing a plan is safe. The library plans when a FullConvolution by transforms is made, and destroys the plans with
/// its last copy. By default it does both under a mutex of its own, which suffices unless the host plans in other threads
/// meanwhile. Under the lock it sets FFTW's wisdom aside and puts it back, and it never calls fftw_cleanup: it leaves no
/// trace in the host's FFTW. A build without FFTW never takes the lock.
///
/// Not to be called while an engine is being made, copied or destroyed in another thread.
///
/// @param lock, unlock  called with `data`, in pairs and in one thread, never nested; both null: the library's own mutex
/// @throws ParameterError if only one of the two is null
///
/// @code{.cpp}
/// static std::mutex planner;  // outlives every engine
/// const auto lock = [](void* mutex) { static_cast<std::mutex*>(mutex)->lock(); };
/// const auto unlock = [](void* mutex) { static_cast<std::mutex*>(mutex)->unlock(); };
/// comminute::set_fft_planner_lock(lock, unlock, &planner);
/// comminute::set_fft_planner_lock(nullptr, nullptr);  // back to the default
/// @endcode
COMMINUTE_API void set_fft_planner_lock(void (*lock)(void*), void (*unlock)(void*), void* data = nullptr);

}  // namespace comminute
