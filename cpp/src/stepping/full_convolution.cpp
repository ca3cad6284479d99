// SPDX-License-Identifier: BSD-3-Clause
// One step with any kernel, by sums or by FFT (docs/theory/one_sweep.md, section 13).
#include "comminute/full_convolution.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "base/check.hpp"
#include "simd/loops.hpp"
#include "stepping/direct_step.hpp"
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

struct FullConvolution::Work {
    Work(const LogGrid& grid, const Material& material, const FullConvolutionOptions& o)
        : options(o), kernel(grid, material, o), runs(grid, material) {
        if (options.path == StepPath::automatic || options.path == StepPath::sums) set_sums();
        const bool wants_direct =
            options.path == StepPath::direct || (options.path == StepPath::automatic && !has_fftw());
        if (sums) return;
        if (wants_direct) {
            direct.emplace(kernel);
        } else {
            set_transforms();
        }
    }

    void set_sums() {
        sums.emplace(kernel);
        if (sums->available()) return;
        sums.reset();
        if (options.path == StepPath::sums) {
            throw ParameterError({.parameter = "path",
                                  .value = "sums",
                                  .rule = "these fragments have no accurate exponential sum on this grid",
                                  .remedy = Remedy::choose_path});
        }
    }

    void set_transforms() {
#ifdef COMMINUTE_HAS_FFTW
        transforms.emplace(kernel, options.effort);
#else
        throw UnavailableError({.subject = "FullConvolution",
                                .finding = "needs FFTW for this, which this build of comminute leaves out",
                                .remedy = Remedy::build_with_fftw});
#endif
    }

    FullConvolutionOptions options;
    Kernel kernel;
    ZoneRuns runs;
    std::optional<SumStep> sums;
    std::optional<DirectStep> direct;
#ifdef COMMINUTE_HAS_FFTW
    std::optional<TransformStep> transforms;
#endif
};

FullConvolution::FullConvolution(const LogGrid& grid, const Material& material,
                                 const FullConvolutionOptions& options)
    : work_(std::make_unique<Work>(grid, material, options)) {}
FullConvolution::~FullConvolution() = default;
FullConvolution::FullConvolution(const FullConvolution& other)
    : work_(std::make_unique<Work>(*other.work_)) {}
FullConvolution& FullConvolution::operator=(const FullConvolution& other) {
    work_ = std::make_unique<Work>(*other.work_);  // this one may have been moved from
    return *this;
}
FullConvolution::FullConvolution(FullConvolution&&) noexcept = default;
FullConvolution& FullConvolution::operator=(FullConvolution&&) noexcept = default;

StepReport FullConvolution::step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out) {
    require_square(p, grid().bins(), "p");
    require_square(out, grid().bins(), "out");
    require_same_or_apart(p, out);
    require_all_finite(p);
    work_->runs.set_load(stress_ratio);
#ifdef COMMINUTE_HAS_FFTW
    if (work_->transforms) return work_->transforms->run(p, work_->kernel, work_->runs, out);
#endif
    if (work_->direct) return work_->direct->run(p, work_->kernel, work_->runs, out);
    return work_->sums->run(p, work_->kernel, work_->runs, out);
}

StepPath FullConvolution::path() const {
    if (work_->sums) return StepPath::sums;
    return work_->direct ? StepPath::direct : StepPath::transforms;
}

const LogGrid& FullConvolution::grid() const {
    return kernel().grid();
}
const Material& FullConvolution::material() const {
    return kernel().material();
}
const FullConvolutionOptions& FullConvolution::options() const {
    return work_->options;
}
const Kernel& FullConvolution::kernel() const {
    return work_->kernel;
}

bool has_fftw() {
#ifdef COMMINUTE_HAS_FFTW
    return true;
#else
    return false;
#endif
}

}  // namespace comminute
