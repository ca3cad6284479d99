// SPDX-License-Identifier: BSD-3-Clause
// Pairs of lines on their way into an FFT and out of it (docs/theory/one_sweep.md, section 13).
#pragma once

#include <array>

#include "comminute/view.hpp"

namespace comminute::detail {

/// A line of the state that is to be spread: how much mass it pushes, from which bins, and where what lands is
/// added.
struct PairedLine {
    double pushed = 0.0;
    Index finest = 0;
    Index coarsest = -1;  ///< -1 for a line without mass
    double* to = nullptr;
};
using LinePair = std::array<PairedLine, 2>;

inline Index finest(const LinePair& lines) {
    return lines[0].finest < lines[1].finest ? lines[0].finest : lines[1].finest;
}
inline Index coarsest(const LinePair& lines) {
    return lines[0].coarsest > lines[1].coarsest ? lines[0].coarsest : lines[1].coarsest;
}

// Pairs are interleaved as in simd/pairs.hpp: bin i of their lines at [2 i] and [2 i + 1].

/// Brings the lighter line of a pair to the other's size, by a power of two, lest it drown in the other's
/// noise. Returns what each line must be multiplied by afterwards.
std::array<double, 2> level(double* pair, const LinePair& lines);

/// Removes FFT noise from a spread pair by the rule stated in full_convolution.hpp, undoes level(), and closes
/// each line's mass balance in bin 0.
void clean(double* pair, const LinePair& lines, std::array<double, 2> unlevel, bool some_stays);

}  // namespace comminute::detail
