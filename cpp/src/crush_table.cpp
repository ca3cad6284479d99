// SPDX-License-Identifier: BSD-3-Clause
#include "crush_table.hpp"

#include <algorithm>
#include <cmath>

namespace comminute {
namespace {

constexpr double nearly_denormal = 1e-290;
constexpr double rounding = 1e-17;

}  // namespace

CrushTable CrushTable::make(const FragmentPmf& pmf, const ExponentialSum& sum) {
    CrushTable table;
    const std::size_t bins = pmf.mass.size();
    table.bins = static_cast<Index>(bins);
    const double leaves = pmf.below[1];
    table.leaves = leaves;
    const std::size_t terms = (sum.coefficient.size() + 3) / 4 * 4;
    table.terms = static_cast<Index>(terms);
    table.head = terms > 0 ? sum.head : table.bins - 1;
    table.coefficient.assign(terms, 0.0);
    table.ratio.assign(terms, 0.0);
    table.entering.assign(terms, 0.0);
    for (std::size_t a = 0; a < sum.coefficient.size(); ++a) {
        table.coefficient[a] = sum.coefficient[a] / leaves;
        table.ratio[a] = sum.ratio[a];
        table.entering[a] = table.ratio[a] * table.coefficient[a];
    }

    table.power.assign(terms * bins, 0.0);
    table.power_upwards.assign(static_cast<std::size_t>(lead) + terms * bins, 0.0);
    for (std::size_t a = 0; a < sum.coefficient.size(); ++a) {
        double power = 1.0;
        for (std::size_t m = 0; m < bins && power > nearly_denormal; ++m) {
            table.power[a * bins + m] = power;
            table.power_upwards[static_cast<std::size_t>(lead) + (a + 1) * bins - 1 - m] = power;
            power *= table.ratio[a];
        }
    }

    // Whatever masses a line holds, a term's share of its sum is at most that of one mass alone at the same place.
    table.terms_from.assign(bins, table.terms);
    for (std::size_t m = 0; m < bins && terms > 0; ++m) {
        const double slowest = std::abs(table.coefficient[0]) * table.power[m];
        std::size_t left = terms;
        while (left > 4 && std::abs(table.coefficient[left - 1]) * table.power[(left - 1) * bins + m] <=
                               rounding * slowest) {
            --left;
        }
        table.terms_from[m] = static_cast<Index>((left + 3) / 4 * 4);
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
                table.mass[m] += table.coefficient[a] * table.power[a * bins + distance];
            }
            short_of_law += by_law - table.mass[m];
        }
    }
    table.mass_upwards.assign(table.mass.rbegin(), table.mass.rend());
    return table;
}

}  // namespace comminute
