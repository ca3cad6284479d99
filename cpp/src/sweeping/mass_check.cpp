// SPDX-License-Identifier: BSD-3-Clause
// The search counts in vector code first and looks for the place only where there is one (docs/theory/one_sweep.md,
// section 14).
#include "sweeping/mass_check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>

#include "base/check.hpp"

namespace comminute::detail {

namespace {

constexpr double any_number = std::numeric_limits<double>::max();

bool is_mass(double entry, double most) {
    return entry >= negative_by_rounding && entry <= most;
}

// Counts instead of stopping at the first, so that the loop has no branch and compiles to vector code.
Index bad_masses(const double* row, Index begin, Index end, double most) {
    Index bad = 0;
    for (Index j = begin; j < end; ++j) bad += static_cast<Index>(!is_mass(row[j], most));
    return bad;
}

}  // namespace

std::optional<Cell> first_bad_mass(MatrixView<const double> state) {
    for (Index i = 0; i < state.rows(); ++i) {
        if (bad_masses(state.row(i), 0, state.cols(), most_summable) == 0) continue;
        for (Index j = 0; j < state.cols(); ++j) {
            if (!is_mass(state(i, j), most_summable)) return Cell(i, j);
        }
    }
    return std::nullopt;
}

std::optional<Cell> first_bad_mass(MatrixView<const double> state, const ActiveBand& zone) {
    const Index bins = state.rows();
    Array<Index> reach(bins);  // finest bin of the active cells of this shell and all coarser ones
    for (Index m = bins - 1; m >= 0; --m) {
        const Index own = m - zone.last(m);
        reach[m] = m + 1 < bins ? std::min(own, reach[m + 1]) : own;
    }
    Index end = 0;  // one past the coarsest shell that reaches this row
    for (Index i = 0; i < bins; ++i) {
        while (end < bins && reach[end] <= i) ++end;
        const Index begin = i - zone.last(i);
        if (bad_masses(state.row(i), std::min(begin, i), std::max(end, i), any_number) == 0) continue;
        for (Index j = 0; j < bins; ++j) {
            if (!is_mass(state(i, j), any_number) && std::abs(i - j) <= zone.last(std::max(i, j)))
                return Cell(i, j);
        }
    }
    return std::nullopt;
}

Fault mass_fault(double value, const char* list, std::vector<Index> index, bool zone) {
    const std::string which = zone ? "every entry inside the crush zone must be " : "every entry must be ";
    const char* what = !std::isfinite(value) ? "finite"
                       : value < 0.0         ? "a mass of at least 0"
                                             : "a share of a total of 1";
    return {.parameter = list,
            .value = text(value),
            .number = value,
            .rule = which + what,
            .place = {Place{.name = list, .index = std::move(index)}}};
}

}  // namespace comminute::detail
