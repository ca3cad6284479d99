// SPDX-License-Identifier: BSD-3-Clause
// One step with any kernel, by sums or by FFT (docs/theory/one_sweep.md, section 13).
#include "comminute/full_convolution.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/check.hpp"
#include "simd/loops.hpp"
#include "stepping/sum_step.hpp"
#ifdef COMMINUTE_HAS_FFTW
#include "stepping/transform_step.hpp"
#endif

namespace comminute {

using namespace detail;

namespace {

void require_finite(MatrixView<const double> p) {
    for (Index i = 0; i < p.rows(); ++i) {
        if (all_finite(p.row(i), p.cols())) continue;
        const double* bad =
            std::find_if_not(p.row(i), p.row(i) + p.cols(), [](double v) { return std::isfinite(v); });
        throw ParameterError("p[" + std::to_string(i) + ", " + std::to_string(bad - p.row(i)) + "] is " +
                             text(*bad) + "; every entry must be finite");
    }
}

}  // namespace

struct FullConvolution::Workspace {
    Workspace(Kernel k, StepPath asked, PlanEffort effort)
        : kernel(std::move(k)), path(asked), zones(kernel.grid(), kernel.material(), 0.0), runs(zones) {
        if (path != StepPath::transforms) set_sums();
        if (!sums) set_transforms(effort);
    }

    void set_sums() {
        sums.emplace(kernel);
        if (sums->available()) return;
        sums.reset();
        if (path == StepPath::sums) {
            throw ParameterError(
                "path is sums, but these fragments have no accurate exponential sum on this grid; use "
                "automatic or "
                "transforms");
        }
    }

    void set_transforms([[maybe_unused]] PlanEffort effort) {
#ifdef COMMINUTE_HAS_FFTW
        transforms.emplace(kernel, effort);
#else
        throw UnavailableError(
            "FullConvolution needs FFTW for this, which this build of comminute leaves out; install "
            "libfftw3-dev and "
            "build with -DCOMMINUTE_WITH_FFTW=ON, or use SlowUpdate, which needs none");
#endif
    }

    Kernel kernel;
    StepPath path;
    CrushZones zones;
    ZoneRuns runs;
    std::optional<SumStep> sums;
#ifdef COMMINUTE_HAS_FFTW
    std::optional<TransformStep> transforms;
#endif
};

FullConvolution::FullConvolution(Kernel kernel, StepPath path, PlanEffort effort)
    : work_(std::make_unique<Workspace>(std::move(kernel), path, effort)) {}
FullConvolution::~FullConvolution() = default;
FullConvolution::FullConvolution(FullConvolution&&) noexcept = default;
FullConvolution& FullConvolution::operator=(FullConvolution&&) noexcept = default;

StepReport FullConvolution::step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out) {
    require_square(p, work_->kernel.grid().bins(), "p");
    require_square(out, work_->kernel.grid().bins(), "out");
    require_same_or_apart(p, out);
    require_finite(p);
    work_->zones.set_load(stress_ratio);
    work_->runs.set_load();
#ifdef COMMINUTE_HAS_FFTW
    if (work_->transforms) return work_->transforms->run(p, work_->kernel, work_->runs, out);
#endif
    return work_->sums->run(p, work_->kernel, work_->runs, out);
}

const Kernel& FullConvolution::kernel() const {
    return work_->kernel;
}

StepPath FullConvolution::path() const {
    return work_->path;
}

bool has_fftw() {
#ifdef COMMINUTE_HAS_FFTW
    return true;
#else
    return false;
#endif
}

}  // namespace comminute
