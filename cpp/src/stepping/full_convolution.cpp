// SPDX-License-Identifier: BSD-3-Clause
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

void require_all_finite(MatrixView<const double> p) {
    for (Index i = 0; i < p.rows(); ++i) {
        if (all_finite(p.row(i), p.cols())) continue;
        for (Index j = 0; j < p.cols(); ++j) require_finite(p(i, j), "p", {i, j}, finite);
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
            throw ParameterError({.parameter = "path",
                                  .value = "sums",
                                  .rule = "these fragments have no accurate exponential sum on this grid",
                                  .remedy = Remedy::choose_path});
        }
    }

    void set_transforms([[maybe_unused]] PlanEffort effort) {
#ifdef COMMINUTE_HAS_FFTW
        transforms.emplace(kernel, effort);
#else
        throw UnavailableError({.subject = "FullConvolution",
                                .finding = "needs FFTW for this, which this build of comminute leaves out",
                                .remedy = Remedy::build_with_fftw});
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
    require_all_finite(p);
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
