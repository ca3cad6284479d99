// SPDX-License-Identifier: BSD-3-Clause
// Scaling of pairs of lines, and removal of the noise of their FFT (docs/theory/one_sweep.md, section 13).
#include "stepping/line_pairs.hpp"

#include <algorithm>
#include <cmath>

#include "simd/pairs.hpp"

namespace comminute::detail {

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

}  // namespace comminute::detail
