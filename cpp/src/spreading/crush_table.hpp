// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "comminute/fragments.hpp"
#include "simd/sums.hpp"

namespace comminute::detail {

/// Where mass lands along its line that crushes once, or until it leaves its bin, in the two forms in which a sweep adds it up:
/// bin by bin for the first `head` reductions, and beyond them as running sums.
struct CrushTable {
    Index bins = 0;
    Index head = 0;                    ///< H; bins - 1 where there are no sums
    Index terms = 0;                   ///< K; 0: no sums
    std::vector<double> mass;          ///< (N) share that lands m bins down, mass[0] = 0
    std::vector<double> mass_upwards;  ///< (N + 8) the same in the order of the bins: entry N - 1 - m, then 0
    std::vector<double> below;         ///< (N) from bin m: share that lands in the fines bin
    std::vector<double> coefficient;   ///< (K)
    std::vector<double> decay;         ///< (K) of a bin
    std::vector<Index> terms_from;     ///< (N) how many terms count m bins beyond the head
    Index stride = 0;                  ///< between the rows of the next two, more than N + 8
    std::vector<double> power;         ///< (K, stride) exp(-decay m), 0 where it would be denormal
    std::vector<double> power_upwards;  ///< the same at N - 1 - m

    // Running sums are kept as they would be at the first shell of a block of shells, and decay once a block.
    Index shells_a_block = 1;  ///< B
    std::vector<double>
        entering;  ///< (B, K) what to weigh mass with that enters the sums at a shell of the block
    std::vector<double>
        falling;  ///< (B, K) exp(-decay b), by which the sums have decayed at shell b of the block
    std::vector<double> block_decay;  ///< (K) exp(-decay B)

    const double* powers(Index a) const { return power.data() + a * stride; }
    const double* entering_at(Index block_shell) const { return entering.data() + block_shell * terms; }
    const double* falling_at(Index block_shell) const { return falling.data() + block_shell * terms; }
    /// exp(-decay (from - to)), and on to the next `to` in order of the bins.
    const double* powers_towards(Index a, Index from, Index to) const {
        return power_upwards.data() + a * stride + bins - 1 - from + to;
    }
    /// mass[from - to], and on to the next `to` in order of the bins.
    const double* mass_towards(Index from, Index to) const {
        return mass_upwards.data() + bins - 1 - from + to;
    }

    /// What advances sums at a shell of a block.
    Falling falling_sums(Index block_shell, double* sums) const {
        return {terms, entering_at(block_shell), falling_at(block_shell), sums};
    }

    /// @param sum     empty for a table without sums
    /// @param leaves  what the masses are shares of: all that leaves the bin, or 1 for one crush
    static CrushTable make(const FragmentPmf& pmf, const ExponentialSum& sum, double leaves);

  private:
    void set_powers();
    void set_block();
};

}  // namespace comminute::detail
