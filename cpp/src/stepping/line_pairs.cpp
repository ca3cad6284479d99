// SPDX-License-Identifier: BSD-3-Clause
// Scaling of pairs of lines, and removal of the noise of their FFT (docs/theory/one_sweep.md, section 13).
#include "stepping/line_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "simd/lanes.hpp"
#include "simd/multiversion.hpp"

namespace comminute::detail {
namespace {

// Multiplies bins 1 .. coarsest of a pair, empties them of what is negative, and says what is left in either line.
COMMINUTE_MULTIVERSION std::array<double, 2> keep_positive(double* pair, Index coarsest,
                                                           std::array<double, 2> factor) {
    const Index end = 2 * (coarsest + 1);
    double partial[lanes] = {};
    Index k = 2;
    for (; k + lanes <= end; k += lanes) {
        for (Index lane = 0; lane < lanes; ++lane) {
            pair[k + lane] = std::max(pair[k + lane] * (lane % 2 == 0 ? factor[0] : factor[1]), 0.0);
            partial[lane] += pair[k + lane];
        }
    }
    for (; k < end; ++k) {
        pair[k] = std::max(pair[k] * (k % 2 == 0 ? factor[0] : factor[1]), 0.0);
        partial[k % 2] += pair[k];
    }
    return {(partial[0] + partial[2]) + (partial[4] + partial[6]),
            (partial[1] + partial[3]) + (partial[5] + partial[7])};
}

}  // namespace

std::array<double, 2> level(double* pair, const LinePair& lines) {
    std::array<double, 2> undone{1.0, 1.0};
    const std::size_t light = lines[0].pushed < lines[1].pushed ? 0 : 1;
    if (!(lines[light].pushed > 0.0)) return undone;
    // At most 2^1000, a number whose inverse is one too.
    const double powers =
        std::min(std::logb(lines[1 - light].pushed) - std::logb(lines[light].pushed), 1000.0);
    if (!(powers > 3.0)) return undone;
    const double up = std::ldexp(1.0, static_cast<int>(powers));
    double* line = pair + light;
    for (Index i = lines[light].finest; i <= lines[light].coarsest; ++i) line[2 * i] *= up;
    undone[light] = 1.0 / up;
    return undone;
}

void clean(double* pair, const LinePair& lines, std::array<double, 2> unlevel, bool some_stays) {
    const Index end = coarsest(lines) + 1;
    for (std::size_t b = 0; b < 2; ++b) {
        const Index highest = some_stays ? lines[b].coarsest : lines[b].coarsest - 1;
        for (Index i = std::max<Index>(highest, 0) + 1; i < end; ++i)
            pair[2 * i + static_cast<Index>(b)] = 0.0;
    }
    const std::array<double, 2> landed = keep_positive(pair, end - 1, unlevel);
    for (std::size_t b = 0; b < 2; ++b) {
        double* line = pair + b;
        const double fines = lines[b].pushed - landed[b];
        line[0] = std::max(fines, 0.0);
        if (fines >= 0.0) continue;
        Index largest = 0;
        for (Index i = 1; i < end; ++i) {
            if (line[2 * i] > line[2 * largest]) largest = i;
        }
        line[2 * largest] += fines;
    }
}

COMMINUTE_MULTIVERSION void add_line(const double* line, double* to, Index bins) {
    COMMINUTE_INDEPENDENT
    for (Index i = 0; i < bins; ++i) to[i] += line[2 * i];
}

COMMINUTE_MULTIVERSION void gather_columns(const double* columns, Index stride, Index rows, double* pairs,
                                           Index distance, double* pushed) {
    for (Index i = 0; i < rows; ++i) {
        const double* from = columns + i * stride;
        for (Index c = 0; c < lanes; ++c) {
            pairs[c / 2 * distance + 2 * i + c % 2] = from[c];
            pushed[c] += from[c];
        }
    }
}

COMMINUTE_MULTIVERSION void add_columns(const double* pairs, Index distance, Index rows,
                                        MatrixView<double> out, Index begin) {
    if (begin + lanes > out.cols()) {
        for (Index c = 0; begin + c < out.cols(); ++c) {
            const double* line = pairs + c / 2 * distance + c % 2;
            for (Index i = 0; i < rows; ++i) out(i, begin + c) += line[2 * i];
        }
        return;
    }
    for (Index i = 0; i < rows; ++i) {
        double* to = out.row(i) + begin;
        for (Index c = 0; c < lanes; ++c) to[c] += pairs[c / 2 * distance + 2 * i + c % 2];
    }
}

}  // namespace comminute::detail
