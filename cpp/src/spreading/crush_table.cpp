// SPDX-License-Identifier: BSD-3-Clause
// Powers, weights and shares of the table (docs/theory/one_sweep.md, sections 6 and 7).
#include "spreading/crush_table.hpp"

#include <algorithm>
#include <cmath>

#include "base/powers.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {
namespace {

constexpr double nearly_denormal = 1e-290;
constexpr double rounding = 1e-17;
constexpr double largest_growth =
    16.0;  // of ln(weight) within a block, whose exp() magnifies rounding as much
constexpr Index longest_block = 64;

}  // namespace

void CrushTable::set_powers() {
    stride = row_stride(bins + lanes);
    power.assign(std::max(terms, Index{1}) * stride, 0.0);  // one row at least, to point into
    power_upwards.assign(power.size(), 0.0);
    for (Index a = 0; a < terms; ++a) {
        double* const row = power.data() + a * stride;
        fill_powers(decay[a], row, bins);
        std::replace_if(
            row, row + bins, [](double value) { return value < nearly_denormal; }, 0.0);
        std::reverse_copy(row, row + bins, power_upwards.data() + a * stride);
    }
}

// The weights of entering mass grow within a block as the sums should have decayed, and the more the steeper the term.
// Their product with the decay is exact for a fall of one bin, where a steep term has most of its mass.
void CrushTable::set_block() {
    if (terms == 0) return;
    const double steepest = *std::max_element(decay.begin(), decay.end());
    shells_a_block =
        std::max(static_cast<Index>(std::min(largest_growth / steepest, static_cast<double>(longest_block))),
                 Index{1});
    for (Index b = 0; b < shells_a_block; ++b) {
        const auto shells = static_cast<double>(b);
        for (Index a = 0; a < terms; ++a) {
            falling.push_back(std::exp(-decay[a] * shells));
            entering.push_back(coefficient[a] * std::exp(-decay[a]) / falling.back());
        }
    }
    for (const double d : decay) block_decay.push_back(std::exp(-d * static_cast<double>(shells_a_block)));
}

// A term is left out from the distance on where it is no more than rounding beside the slowest term. That holds for the
// sums of any masses, since each mass alone keeps to it.
void CrushTable::set_terms_from() {
    terms_from.assign(bins, terms);
    for (Index m = 0; m < bins && terms > 0; ++m) {
        const double slowest = std::abs(coefficient[0]) * power[m];
        Index left = terms;
        while (left > 1 && std::abs(coefficient[left - 1]) * powers(left - 1)[m] <= rounding * slowest) {
            --left;
        }
        terms_from[m] = left;
    }
}

void CrushTable::set_mass(const FragmentPmf& pmf, double leaves) {
    const VectorView<const double> pmf_mass(pmf.mass);
    const VectorView<const double> pmf_below(pmf.below);
    mass.assign(bins, 0.0);
    below.assign(bins, 1.0);
    double lack = 0.0;  // mass by which the bins so far fall short of the law, by the error of the sum
    for (Index m = 1; m < bins; ++m) {
        below[m] = std::max(pmf_below[m] / leaves + lack, 0.0);
        const double by_law = pmf_mass[m] / leaves;
        mass[m] = by_law;
        if (m > head) {
            mass[m] = 0.0;
            for (Index a = 0; a < terms; ++a) mass[m] += coefficient[a] * powers(a)[m - head];
            lack += by_law - mass[m];
        }
    }
    mass_upwards.assign(bins + lanes, 0.0);
    std::reverse_copy(mass.begin(), mass.end(), mass_upwards.begin());
}

CrushTable CrushTable::make(const FragmentPmf& pmf, const ExponentialSum& sum, double leaves) {
    CrushTable table;
    table.bins = VectorView<const double>(pmf.mass).size();
    table.decay = Array<double>(sum.decay);
    table.coefficient = Array<double>(sum.coefficient);
    for (double& coefficient : table.coefficient) coefficient /= leaves;
    table.terms = table.decay.size();
    table.head = table.terms > 0 ? sum.head : table.bins - 1;
    table.set_powers();
    table.set_block();
    table.set_terms_from();
    table.set_mass(pmf, leaves);
    return table;
}

}  // namespace comminute::detail
