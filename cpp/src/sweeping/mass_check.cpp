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
#include "simd/loops.hpp"

namespace comminute::detail {

namespace {

constexpr Index rows_ahead = 8;  // rows of the state asked for before their turn
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

void ZoneExtent::set(const ActiveBand& zone) {
    const Index bins = begin_.size();
    Array<Index>& finest =
        begin_;  // bin of the active cells of this shell and all coarser ones, for the time being
    for (Index m = bins - 1; m >= 0; --m) {
        finest[m] = m - zone.last(m);
        if (m + 1 < bins) finest[m] = std::min(finest[m], finest[m + 1]);
    }
    Index end = 0;  // one past the coarsest shell that reaches this row
    for (Index i = 0; i < bins; ++i) {
        while (end < bins && finest[end] <= i) ++end;
        end_[i] = std::max(end, i);
    }
    for (Index i = 0; i < bins; ++i) begin_[i] = std::min(i - zone.last(i), i);
}

std::optional<Cell> first_bad_mass(MatrixView<const double> state, const ActiveBand& zone,
                                   const ZoneExtent& extent) {
    const Index bins = state.rows();
    for (Index i = 0; i < bins; ++i) {
        if (const Index ahead = i + rows_ahead; ahead < bins) {
            fetch(state.row(ahead) + extent.begin(ahead), extent.end(ahead) - extent.begin(ahead));
        }
        if (bad_masses(state.row(i), extent.begin(i), extent.end(i), any_number) == 0) continue;
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
