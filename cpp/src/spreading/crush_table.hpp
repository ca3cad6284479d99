// SPDX-License-Identifier: BSD-3-Clause
// Landing of crushed mass along its line, for all engines that add it up (docs/theory/one_sweep.md, section 6).
#pragma once

#include "base/arrays.hpp"
#include "comminute/fragments.hpp"
#include "simd/sums.hpp"

namespace comminute::detail {

/// Landing places of mass that crushes once, or until it leaves its bin, in the two forms in which an engine adds it up:
/// bin by bin for the first `head` reductions, and as running sums of exponentials beyond them.
///
/// For m > head, mass[m] = sum_a coefficient[a] exp(-decay[a] (m - head)).
struct CrushTable {
    Index bins = 0;      ///< N
    Index head = 0;      ///< H; bins - 1 where there are no sums
    Index terms = 0;     ///< K; 0 where there are no sums
    Array<double> mass;  ///< (N) share that lands m bins down; mass[0] = 0
    Array<double>
        mass_upwards;     ///< (N + lanes) the same in the order of the bins: mass[m] at N - 1 - m, then 0
    Array<double> below;  ///< (N) share of mass from bin m that lands in the fines bin
    Array<double> coefficient;    ///< (K) the slowest decay first
    Array<double> decay;          ///< (K) per bin
    Array<Index> terms_from;      ///< (N) number of terms that still count m bins beyond the head
    Index stride = 0;             ///< distance between the rows of the next two arrays, at least N + lanes
    Array<double> power;          ///< (K, stride) exp(-decay m), 0 where it would be denormal
    Array<double> power_upwards;  ///< (K, stride) the same at N - 1 - m

    // Running sums are kept as of the first shell of a block of B shells, and decay once a block.
    Index shells_a_block = 1;  ///< B
    Array<double> entering;    ///< (B, K) weights of mass that enters the sums at each shell of the block
    Array<double> falling;  ///< (B, K) exp(-decay b), the decay of the sums from the first shell to shell b
    Array<double> block_decay;  ///< (K) exp(-decay B)

    const double* powers(Index a) const { return power.data() + a * stride; }
    const double* entering_at(Index block_shell) const { return entering.data() + block_shell * terms; }
    const double* falling_at(Index block_shell) const { return falling.data() + block_shell * terms; }
    /// exp(-decay (from - to)); the next entries are those of the next larger `to`.
    const double* powers_towards(Index a, Index from, Index to) const {
        return power_upwards.data() + a * stride + bins - 1 - from + to;
    }
    /// mass[from - to]; the next entries are those of the next larger `to`.
    const double* mass_towards(Index from, Index to) const {
        return mass_upwards.data() + bins - 1 - from + to;
    }

    /// The weights by which advance() brings `sums` to a shell of the block.
    Falling falling_sums(Index block_shell, double* sums) const {
        return {terms, entering_at(block_shell), falling_at(block_shell), sums};
    }

    /// @param pmf     fragments of one crush
    /// @param sum     the same as a sum of exponentials; empty for a table without sums
    /// @param leaves  mass of one crush that counts as one: the share that leaves its bin, 1 - f_0, for mass that crushes
    ///                until it leaves; 1 for a single crush
    static CrushTable make(const FragmentPmf& pmf, const ExponentialSum& sum, double leaves);

  private:
    void set_powers();
    void set_block();
    void set_terms_from();
    void set_mass(const FragmentPmf& pmf, double leaves);
};

}  // namespace comminute::detail
