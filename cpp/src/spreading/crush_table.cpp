// SPDX-License-Identifier: BSD-3-Clause
#include "spreading/crush_table.hpp"

#include <algorithm>
#include <cmath>

#include "base/powers.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {
namespace {

constexpr double nearly_denormal = 1e-290;
constexpr double rounding = 1e-17;
constexpr double largest_growth = 16.0;  // in logs, within a block of shells: exp rounds as often as that
constexpr Index longest_block = 64;

}  // namespace

void CrushTable::set_powers() {
    stride = row_stride(bins + lanes);
    power.assign(static_cast<std::size_t>(std::max(terms, Index{1}) * stride), 0.0);  // a row to point into
    power_upwards.assign(power.size(), 0.0);
    for (Index a = 0; a < terms; ++a) {
        double* const row = power.data() + a * stride;
        fill_powers(decay[static_cast<std::size_t>(a)], row, bins);
        std::replace_if(
            row, row + bins, [](double value) { return value < nearly_denormal; }, 0.0);
        std::reverse_copy(row, row + bins, power_upwards.data() + a * stride);
    }
}

// Within a block the weights of what enters grow as the sums should have decayed, the more the steeper the term. What
// falls by one bin, the most of a steep term, is right to the last bit.
void CrushTable::set_block() {
    if (terms == 0) return;
    const double steepest = *std::max_element(decay.begin(), decay.end());
    shells_a_block =
        std::max(static_cast<Index>(std::min(largest_growth / steepest, static_cast<double>(longest_block))),
                 Index{1});
    for (Index b = 0; b < shells_a_block; ++b) {
        const auto shells = static_cast<double>(b);
        for (std::size_t a = 0; a < decay.size(); ++a) {
            falling.push_back(std::exp(-decay[a] * shells));
            entering.push_back(coefficient[a] * std::exp(-decay[a]) / falling.back());
        }
    }
    for (const double d : decay) block_decay.push_back(std::exp(-d * static_cast<double>(shells_a_block)));
}

CrushTable CrushTable::make(const FragmentPmf& pmf, const ExponentialSum& sum, double leaves) {
    CrushTable table;
    const std::size_t bins = pmf.mass.size();
    table.bins = static_cast<Index>(bins);
    const std::size_t terms = sum.coefficient.size();
    table.terms = static_cast<Index>(terms);
    table.head = terms > 0 ? sum.head : table.bins - 1;
    table.decay = sum.decay;
    table.coefficient = sum.coefficient;
    for (double& coefficient : table.coefficient) coefficient /= leaves;
    table.set_powers();
    table.set_block();

    // Whatever masses a line holds, a term's share of its sum is at most that of one mass alone at the same place.
    table.terms_from.assign(bins, table.terms);
    for (std::size_t m = 0; m < bins && terms > 0; ++m) {
        const double slowest = std::abs(table.coefficient[0]) * table.power[m];
        std::size_t left = terms;
        while (left > 1 &&
               std::abs(table.coefficient[left - 1]) * table.powers(static_cast<Index>(left) - 1)[m] <=
                   rounding * slowest) {
            --left;
        }
        table.terms_from[m] = static_cast<Index>(left);
    }

    table.mass.assign(bins, 0.0);
    table.below.assign(bins, 1.0);
    double short_of_law = 0.0;  // what the bins so far hold too little, by the error of the sum
    for (std::size_t m = 1; m < bins; ++m) {
        table.below[m] = std::max(pmf.below[m] / leaves + short_of_law, 0.0);
        const double by_law = pmf.mass[m] / leaves;
        table.mass[m] = by_law;
        if (static_cast<Index>(m) > table.head) {
            table.mass[m] = 0.0;
            const std::size_t distance = m - static_cast<std::size_t>(table.head);
            for (std::size_t a = 0; a < terms; ++a) {
                table.mass[m] += table.coefficient[a] * table.powers(static_cast<Index>(a))[distance];
            }
            short_of_law += by_law - table.mass[m];
        }
    }
    table.mass_upwards.assign(table.mass.rbegin(), table.mass.rend());
    table.mass_upwards.resize(bins + static_cast<std::size_t>(lanes));
    return table;
}

}  // namespace comminute::detail
