// SPDX-License-Identifier: BSD-3-Clause
#include "fft_plan.hpp"

#include <fftw3.h>

#include <algorithm>
#include <complex>
#include <cstdlib>
#include <mutex>
#include <new>
#include <vector>

namespace comminute {
namespace {

// FFTW's planner is global and not thread safe; executing a plan is.
std::mutex& planner() {
    static std::mutex mutex;
    return mutex;
}

// Plans from FFTW's own judgement alone, and gives its wisdom back as it was: what an engine computes does not depend, to
// the last bit, on what else was planned in the process, and the host's wisdom is its own.
class WisdomAside {
  public:
    WisdomAside() : kept_(fftw_export_wisdom_to_string()) { fftw_forget_wisdom(); }
    WisdomAside(const WisdomAside&) = delete;
    WisdomAside& operator=(const WisdomAside&) = delete;
    ~WisdomAside() {
        fftw_forget_wisdom();
        if (kept_ != nullptr) fftw_import_wisdom_from_string(kept_);
        std::free(kept_);  // as FFTW's manual asks for
    }

  private:
    char* kept_;
};

struct FftwFree {
    void operator()(void* memory) const { fftw_free(memory); }
};

struct FftwPlan {
    fftw_plan plan = nullptr;
    FftwPlan() = default;
    FftwPlan(const FftwPlan&) = delete;
    FftwPlan& operator=(const FftwPlan&) = delete;
    ~FftwPlan() {
        const std::lock_guard lock(planner());
        fftw_destroy_plan(plan);
    }
};

/// Smallest even length >= n without prime factors above 7, FFTW's fast sizes.
Index fast_length(Index n) {
    for (Index length = n + n % 2;; length += 2) {
        Index rest = length;
        for (const Index prime : {2, 3, 5, 7}) {
            while (rest % prime == 0) rest /= prime;
        }
        if (rest == 1) return length;
    }
}

}  // namespace

struct LineSpreader::Plans {
    Plans(VectorView<const double> filter, Index batch_lines, PlanEffort effort)
        : lines(batch_lines),
          length(fast_length(2 * filter.size())),
          harmonics(length / 2 + 1),
          buffer(static_cast<double*>(
              fftw_malloc(sizeof(double) * static_cast<std::size_t>(2 * harmonics * lines)))) {
        if (!buffer) throw std::bad_alloc();
        const int n = static_cast<int>(length);
        const int real_gap = static_cast<int>(2 * harmonics);
        const unsigned flags = effort == PlanEffort::measure ? FFTW_MEASURE : FFTW_ESTIMATE;
        {
            const std::lock_guard lock(planner());
            const WisdomAside aside;
            const int howmany = static_cast<int>(lines);
            forward.plan = fftw_plan_many_dft_r2c(1, &n, howmany, buffer.get(), nullptr, 1, real_gap,
                                                  complex(), nullptr, 1, static_cast<int>(harmonics), flags);
            backward.plan =
                fftw_plan_many_dft_c2r(1, &n, howmany, complex(), nullptr, 1, static_cast<int>(harmonics),
                                       buffer.get(), nullptr, 1, real_gap, flags);
        }
        if (forward.plan == nullptr || backward.plan == nullptr) throw std::bad_alloc();
        // The filter's own spectrum, conjugated since mass moves down, and scaled for FFTW's unscaled round
        // trip.
        std::fill_n(buffer.get(), 2 * harmonics * lines, 0.0);
        std::copy(filter.begin(), filter.end(), buffer.get());
        fftw_execute(forward.plan);
        spectrum.resize(static_cast<std::size_t>(harmonics));
        const auto* values = reinterpret_cast<const std::complex<double>*>(buffer.get());
        for (std::size_t q = 0; q < spectrum.size(); ++q) {
            spectrum[q] = std::conj(values[q]) / static_cast<double>(length);
        }
    }

    fftw_complex* complex() const { return reinterpret_cast<fftw_complex*>(buffer.get()); }

    Index lines;
    Index length;
    Index harmonics;
    std::unique_ptr<double[], FftwFree> buffer;
    FftwPlan forward;
    FftwPlan backward;
    std::vector<std::complex<double>> spectrum;
};

LineSpreader::LineSpreader(VectorView<const double> filter, Index batch, PlanEffort effort)
    : plans_(std::make_unique<Plans>(filter, batch, effort)) {}
LineSpreader::~LineSpreader() = default;
LineSpreader::LineSpreader(LineSpreader&&) noexcept = default;
LineSpreader& LineSpreader::operator=(LineSpreader&&) noexcept = default;

Index LineSpreader::batch() const {
    return plans_->lines;
}

double* LineSpreader::line(Index b) {
    return plans_->buffer.get() + b * 2 * plans_->harmonics;
}

void LineSpreader::clear() {
    std::fill_n(plans_->buffer.get(), 2 * plans_->harmonics * plans_->lines, 0.0);
}

void LineSpreader::spread() {
    fftw_execute(plans_->forward.plan);
    for (Index b = 0; b < plans_->lines; ++b) {
        // Interleaved (re, im) products by hand: std::complex's operator* calls out for its NaN rules.
        double* z = line(b);
        for (Index q = 0; q < plans_->harmonics; ++q) {
            const std::complex<double> f = plans_->spectrum[static_cast<std::size_t>(q)];
            const double re = z[2 * q];
            const double im = z[2 * q + 1];
            z[2 * q] = re * f.real() - im * f.imag();
            z[2 * q + 1] = re * f.imag() + im * f.real();
        }
    }
    fftw_execute(plans_->backward.plan);
}

}  // namespace comminute
