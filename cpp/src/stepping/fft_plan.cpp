// SPDX-License-Identifier: BSD-3-Clause
// FFTW behind one interface: plans, transforms, its global state left as found (docs/theory/one_sweep.md, section 13).
#include "stepping/fft_plan.hpp"

#include <fftw3.h>

#include <algorithm>
#include <cstdlib>
#include <new>
#include <type_traits>
#include <vector>

#include "simd/pairs.hpp"
#include "stepping/planner_lock.hpp"

namespace comminute::detail {
namespace {

// Sets FFTW's wisdom aside while plans are made, and puts it back as it was. So what an engine computes does not depend,
// to the last bit, on what else was planned in the process, and nothing that is planned here stays in the host's wisdom.
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

fftw_complex* complex(double* numbers) {
    return reinterpret_cast<fftw_complex*>(numbers);
}

struct DestroyPlan {
    void operator()(fftw_plan plan) const {
        const PlannerLock lock;
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
    Array<double> numbers;  // interleaved
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

}  // namespace

/// Transforms of every length that a line may need, and the filter in each; nothing here changes once it is made.
struct LineSpreader::Plans {
    // The buffers are for planning alone; what they hold is lost.
    Plans(VectorView<const double> filter, double* line, double* spectral, PlanEffort effort) {
        const std::vector<Index> lengths = ladder(filter.size());
        // So that nothing throws, and no plan is destroyed, while the planner is locked.
        rungs.reserve(lengths.size());
        {
            const PlannerLock lock;
            const WisdomAside aside;
            for (const Index length : lengths) plan(length, line, spectral, effort);
        }
        for (Rung& rung : rungs) {
            if (!rung.forward || !rung.backward) throw std::bad_alloc();
            for (const Index eighths : {4, 5, 6, 7}) {
                const Index reach = std::min(eighths * rung.length / 8, filter.size());
                if (!rung.spectra.empty() && rung.spectra.back().reach >= reach) continue;
                std::fill_n(line, 2 * rung.length, 0.0);
                for (Index m = 0; m < reach; ++m) line[2 * m] = filter[m];
                add_spectrum(rung, reach, line, spectral);
            }
        }
    }

    void plan(Index length, double* line, double* spectral, PlanEffort effort) {
        const int n = static_cast<int>(length);
        const unsigned flags =
            FFTW_DESTROY_INPUT | (effort == PlanEffort::measure ? FFTW_MEASURE : FFTW_ESTIMATE);
        rungs.push_back(
            {length,
             FftwPlan(fftw_plan_dft_1d(n, complex(line), complex(spectral), FFTW_FORWARD, flags)),
             FftwPlan(fftw_plan_dft_1d(n, complex(spectral), complex(line), FFTW_BACKWARD, flags)),
             {}});
    }

    static void add_spectrum(Rung& rung, Index reach, double* line, double* spectral) {
        fftw_execute_dft(rung.forward.get(), complex(line), complex(spectral));
        const auto length = static_cast<double>(rung.length);
        Array<double> numbers(2 * rung.length);
        for (Index q = 0; q < numbers.size(); ++q) numbers[q] = spectral[q] / (q % 2 == 0 ? length : -length);
        rung.spectra.push_back({reach, rung.length - reach + 1, std::move(numbers)});
    }

    std::vector<Rung> rungs;  // by growing length
};

// Pairs lie one cache line further apart than they are long, so that they do not share their sets. All begin with a cache
// line, as the buffers do for which the plans are made.
LineSpreader::LineSpreader(VectorView<const double> filter, Index pairs, PlanEffort effort)
    : distance_(2 * ladder(filter.size()).back() + lanes), used_(pairs) {
    lines_.resize(distance_ * pairs);
    spectral_.resize(distance_);
    plans_ = std::make_shared<const Plans>(filter, lines_.data(), spectral_.data(), effort);
    std::fill(lines_.begin(), lines_.end(), 0.0);
}

void LineSpreader::spread(Index q, Index finest, Index coarsest) {
    for (const Rung& rung : plans_->rungs) {
        for (const Spectrum& spectrum : rung.spectra) {
            if (coarsest >= spectrum.reach || coarsest - finest >= spectrum.width) continue;
            // The last rung serves any line.
            double* spectral = spectral_.data();
            fftw_execute_dft(rung.forward.get(), complex(pair(q)), complex(spectral));
            multiply(spectral, spectrum.numbers.data(), rung.length);
            fftw_execute_dft(rung.backward.get(), complex(spectral), complex(pair(q)));
            used_[q] = rung.length;
            return;
        }
    }
}

void LineSpreader::clear(Index q) {
    std::fill_n(pair(q), 2 * used_[q], 0.0);
}

}  // namespace comminute::detail
