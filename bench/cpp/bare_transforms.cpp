// SPDX-License-Identifier: BSD-3-Clause
// The transforms of a full convolution step and nothing else, for bench/contestants/bare_fftw.py.
#include <fftw3.h>

#include <algorithm>
#include <cstddef>
#include <memory>

namespace {

struct Free {
    void operator()(void* memory) const { fftw_free(memory); }
};

// Smallest even length >= n without prime factors above 7.
long fast_length(long n) {
    for (long length = n + n % 2;; length += 2) {
        long rest = length;
        for (const long prime : {2L, 3L, 5L, 7L}) {
            while (rest % prime == 0) rest /= prime;
        }
        if (rest == 1) return length;
    }
}

// A batch of lines transformed in place, one behind the other as FFTW lays out real-to-complex data.
struct Batch {
    Batch(long line_bins, long line_count, bool measure)
        : bins(line_bins),
          lines(line_count),
          length(fast_length(2 * bins)),
          stride(2 * (length / 2 + 1)),
          buffer(
              static_cast<double*>(fftw_malloc(sizeof(double) * static_cast<std::size_t>(stride * lines)))) {
        const int n = static_cast<int>(length);
        const int howmany = static_cast<int>(lines);
        const int real_gap = static_cast<int>(stride);
        const unsigned flags = measure ? FFTW_MEASURE : FFTW_ESTIMATE;
        auto* complex = reinterpret_cast<fftw_complex*>(buffer.get());
        forward = fftw_plan_many_dft_r2c(1, &n, howmany, buffer.get(), nullptr, 1, real_gap, complex, nullptr,
                                         1, real_gap / 2, flags);
        backward = fftw_plan_many_dft_c2r(1, &n, howmany, complex, nullptr, 1, real_gap / 2, buffer.get(),
                                          nullptr, 1, real_gap, flags);
        clear();
    }
    Batch(const Batch&) = delete;
    Batch& operator=(const Batch&) = delete;
    ~Batch() {
        fftw_destroy_plan(forward);
        fftw_destroy_plan(backward);
    }

    void clear() const { std::fill_n(buffer.get(), stride * lines, 0.0); }
    void there_and_back() const {
        fftw_execute(forward);
        fftw_execute(backward);
    }

    long bins;
    long lines;
    long length;
    long stride;
    std::unique_ptr<double[], Free> buffer;
    fftw_plan forward = nullptr;
    fftw_plan backward = nullptr;
};

}  // namespace

extern "C" {

Batch* bare_new(long bins, long lines, int measure) {
    return new Batch(bins, lines, measure != 0);
}

void bare_free(Batch* batch) {
    delete batch;
}

const char* bare_version() {
    return fftw_version;
}

long bare_length(const Batch* batch) {
    return batch->length;
}

// The numbers are zero: FFTW's arithmetic takes no shorter way for them, and they cannot overflow however often.
void bare_run(const Batch* batch, long times) {
    for (long t = 0; t < times; ++t) batch->there_and_back();
}

void bare_round_trip(const Batch* batch, double* lines) {
    batch->clear();
    for (long b = 0; b < batch->lines; ++b) {
        std::copy_n(lines + b * batch->bins, batch->bins, batch->buffer.get() + b * batch->stride);
    }
    batch->there_and_back();
    for (long b = 0; b < batch->lines; ++b) {
        std::transform(batch->buffer.get() + b * batch->stride,
                       batch->buffer.get() + b * batch->stride + batch->bins, lines + b * batch->bins,
                       [batch](double value) { return value / static_cast<double>(batch->length); });
    }
    batch->clear();
}
}
