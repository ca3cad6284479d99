// SPDX-License-Identifier: BSD-3-Clause
// Spreading of pairs of lines by FFT (docs/theory/one_sweep.md, section 13).
#pragma once

#include <memory>

#include "base/arrays.hpp"
#include "comminute/full_convolution.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {

/// Real lines, two and two, each spread downwards by one fixed pmf: out[i] = sum_m filter[m] in[i + m].
///
/// A pair is one complex line: the filter is real, so what is real and what is imaginary never mix, and two
/// lines cost one complex transform. Linear, not circular, by the shortest transform on a ladder of lengths
/// whose wrapped end stays clear of the bins that are read. The only part of the library that knows FFTW; plans are
/// made and destroyed under PlannerLock, spreading needs no lock. Copies share the plans and have lines of their own.
class LineSpreader {
  public:
    /// @param filter  (N) f_m, m = 0 .. N-1
    /// @param pairs   held at once, >= 1
    LineSpreader(VectorView<const double> filter, Index pairs, PlanEffort effort);

    /// Pair q: bin i of its lines at [2 i] and [2 i + 1]. Zero until the caller writes.
    double* pair(Index q) { return lines_.data() + q * distance_; }
    /// Numbers from one pair to the next.
    Index distance() const { return distance_; }
    /// Spreads pair q, whose mass lies in bins finest .. coarsest; then bins 0 .. coarsest may be read.
    void spread(Index q, Index finest, Index coarsest);
    /// Zeroes pair q again after spread().
    void clear(Index q);

  private:
    struct Plans;

    std::shared_ptr<const Plans> plans_;
    Index distance_;
    LaneArray lines_;     // (pairs, distance)
    LaneArray spectral_;  // (distance) a pair, transformed
    Array<Index> used_;   // (pairs) length of each pair's last transform
};

}  // namespace comminute::detail
