// SPDX-License-Identifier: BSD-3-Clause
// FFTW behind one interface: plans, transforms, its global state left as found (docs/theory/one_sweep.md, section 13).
#include "stepping/fft_plan.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <new>
#include <type_traits>
#include <vector>

#include "simd/multiversion.hpp"

namespace comminute::detail {
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
using Buffer = std::unique_ptr<double[], FftwFree>;

Buffer zeros(Index count) {
    Buffer buffer(static_cast<double*>(fftw_malloc(sizeof(double) * static_cast<std::size_t>(count))));
    if (!buffer) throw std::bad_alloc();
    std::fill_n(buffer.get(), count, 0.0);
    return buffer;
}

fftw_complex* complex(double* numbers) {
    return reinterpret_cast<fftw_complex*>(numbers);
}

struct DestroyPlan {
    void operator()(fftw_plan plan) const {
        const std::lock_guard lock(planner());
        fftw_destroy_plan(plan);
    }
};
using FftwPlan = std::unique_ptr<std::remove_pointer_t<fftw_plan>, DestroyPlan>;

/// The filter's first `reach` numbers, transformed, conjugated since mass moves down, and scaled for FFTW's
/// unscaled round trip. Lines whose mass lies below bin `reach` and spans `width` bins come out right: what
/// wraps around ends above their coarsest bin.
struct Spectrum {
    Index reach;
    Index width;
    std::vector<double> numbers;  // interleaved
};

/// Transforms of one length.
struct Rung {
    Index length;
    FftwPlan forward;
    FftwPlan backward;
    std::vector<Spectrum> spectra;  // by growing reach
};

/// Lengths on which FFTW is at its quickest, 4, 5 and 6 times a power of two: from about an eighth of the bins, since
/// shorter lines are few, to the first that serves any line.
std::vector<Index> ladder(Index bins) {
    std::vector<Index> lengths;
    Index power = 8;
    while (32 * power < bins) power *= 2;
    for (;; power *= 2) {
        for (const Index factor : {4, 5, 6}) {
            lengths.push_back(factor * power);
            if (lengths.back() >= 2 * bins) return lengths;
        }
    }
}

COMMINUTE_MULTIVERSION void multiply(double* z, const double* by, Index count) {
    COMMINUTE_INDEPENDENT
    for (Index q = 0; q < count; ++q) {
        const double re = z[2 * q];
        const double im = z[2 * q + 1];
        z[2 * q] = re * by[2 * q] - im * by[2 * q + 1];
        z[2 * q + 1] = re * by[2 * q + 1] + im * by[2 * q];
    }
}

}  // namespace

struct LineSpreader::Plans {
    Plans(VectorView<const double> filter, Index pairs, PlanEffort effort)
        : used(static_cast<std::size_t>(pairs), 0) {
        const std::vector<Index> lengths = ladder(filter.size());
        distance = 2 * lengths.back() + 8;  // one cache line off, so that pairs do not share their sets
        lines = zeros(distance * pairs);
        spectral = zeros(distance);
        // So that nothing throws, and no plan is destroyed, while the planner is locked.
        rungs.reserve(lengths.size());
        {
            const std::lock_guard lock(planner());
            const WisdomAside aside;
            for (const Index length : lengths) plan(length, effort);
        }
        for (Rung& rung : rungs) {
            if (!rung.forward || !rung.backward) throw std::bad_alloc();
            for (const Index eighths : {4, 5, 6, 7}) {
                const Index reach = std::min(eighths * rung.length / 8, filter.size());
                if (rung.spectra.empty() || rung.spectra.back().reach < reach) transform(filter, reach, rung);
            }
        }
        std::fill_n(lines.get(), distance * pairs, 0.0);
    }

    void plan(Index length, PlanEffort effort) {
        const int n = static_cast<int>(length);
        const unsigned flags =
            FFTW_DESTROY_INPUT | (effort == PlanEffort::measure ? FFTW_MEASURE : FFTW_ESTIMATE);
        fftw_complex* line = complex(lines.get());
        fftw_complex* to = complex(spectral.get());
        rungs.push_back({length,
                         FftwPlan(fftw_plan_dft_1d(n, line, to, FFTW_FORWARD, flags)),
                         FftwPlan(fftw_plan_dft_1d(n, to, line, FFTW_BACKWARD, flags)),
                         {}});
    }

    void transform(VectorView<const double> filter, Index reach, Rung& rung) const {
        std::fill_n(lines.get(), 2 * rung.length, 0.0);
        for (Index m = 0; m < reach; ++m) lines[static_cast<std::size_t>(2 * m)] = filter[m];
        fftw_execute(rung.forward.get());
        std::vector<double> numbers(spectral.get(), spectral.get() + 2 * rung.length);
        for (std::size_t q = 0; q < numbers.size(); ++q) {
            numbers[q] /= static_cast<double>(q % 2 == 0 ? rung.length : -rung.length);
        }
        rung.spectra.push_back({reach, rung.length - reach + 1, std::move(numbers)});
    }

    std::vector<Index> used;  // length of each pair's last transform
    Index distance = 0;
    Buffer lines;
    Buffer spectral;
    std::vector<Rung> rungs;  // by growing length
};

LineSpreader::LineSpreader(VectorView<const double> filter, Index pairs, PlanEffort effort)
    : plans_(std::make_unique<Plans>(filter, pairs, effort)) {}
LineSpreader::~LineSpreader() = default;
LineSpreader::LineSpreader(LineSpreader&&) noexcept = default;
LineSpreader& LineSpreader::operator=(LineSpreader&&) noexcept = default;

double* LineSpreader::pair(Index q) {
    return plans_->lines.get() + q * plans_->distance;
}

Index LineSpreader::distance() const {
    return plans_->distance;
}

void LineSpreader::spread(Index q, Index finest, Index coarsest) {
    for (const Rung& rung : plans_->rungs) {
        for (const Spectrum& spectrum : rung.spectra) {
            if (coarsest >= spectrum.reach || coarsest - finest >= spectrum.width) continue;
            // The last rung serves any line.
            double* spectral = plans_->spectral.get();
            fftw_execute_dft(rung.forward.get(), complex(pair(q)), complex(spectral));
            multiply(spectral, spectrum.numbers.data(), rung.length);
            fftw_execute_dft(rung.backward.get(), complex(spectral), complex(pair(q)));
            plans_->used[static_cast<std::size_t>(q)] = rung.length;
            return;
        }
    }
}

void LineSpreader::clear(Index q) {
    std::fill_n(pair(q), 2 * plans_->used[static_cast<std::size_t>(q)], 0.0);
}

}  // namespace comminute::detail
