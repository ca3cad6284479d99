// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "comminute/fragments.hpp"

namespace comminute {

/// Where mass that crushes until it leaves its bin lands along its line, in the two forms in which a sweep adds it up:
/// bin by bin for the first `head` reductions, and beyond them as running sums.
struct CrushTable {
    Index bins = 0;
    Index head = 0;                     ///< H; bins - 1 where there are no sums
    Index terms = 0;                    ///< K, padded with empty terms to a multiple of 4; 0: no sums
    double leaves = 1.0;                ///< 1 - f_0, the share of one crush that leaves the bin
    std::vector<double> mass;           ///< (N) share that lands m bins down, mass[0] = 0
    std::vector<double> mass_upwards;   ///< (N) the same in the order of the bins: entry N - 1 - m
    std::vector<double> below;          ///< (N) from bin m: share that lands in the fines bin
    std::vector<double> coefficient;    ///< (K)
    std::vector<double> ratio;          ///< (K)
    std::vector<double> entering;       ///< (K) ratio * coefficient
    std::vector<Index> terms_from;      ///< (N) how many terms, a multiple of 4, count m bins beyond the head
    std::vector<double> power;          ///< (K, N) ratio^m, 0 where it would be denormal
    std::vector<double> power_upwards;  ///< the same at lead + N - 1 - m
    static constexpr Index lead = 4;    ///< entries before it, so that a loop may begin below bin 0

    const double* powers(Index a) const { return power.data() + a * bins; }
    /// ratio^(from - to), and on to the next `to` in order of the bins.
    const double* powers_towards(Index a, Index from, Index to) const {
        return power_upwards.data() + lead + (a + 1) * bins - 1 - from + to;
    }
    /// mass[from - to], and on to the next `to` in order of the bins.
    const double* mass_towards(Index from, Index to) const {
        return mass_upwards.data() + bins - 1 - from + to;
    }

    /// @param sum  empty for a table without sums
    static CrushTable make(const FragmentPmf& pmf, const ExponentialSum& sum);
};

}  // namespace comminute
