// SPDX-License-Identifier: BSD-3-Clause
// Monotone cubic interpolation of many columns over one rising abscissa (docs/theory/response_tables.md).
#pragma once

#include <vector>

#include "comminute/view.hpp"

namespace comminute::detail {

/// Intervals no wider than this are jumps: linear in themselves, and no matter to the slopes beside them.
constexpr double jump_width = 2e-9;

/// Value and slope of a column at one place.
struct Reading {
    double value;
    double slope;
};

/// A place between two nodes.
struct Interval {
    Index node;   ///< the one before it
    double part;  ///< share of the way to the next, in [0, 1]
};

/// (T) slopes of a column at its nodes, by Fritsch and Butland; at the ends and beside jumps from one side.
std::vector<double> monotone_slopes(const std::vector<double>& at, const std::vector<double>& values);

/// The interval that holds a place within the nodes.
Interval interval_of(const std::vector<double>& at, double place);

/// Reads one column, of which `value` and `slope` give the numbers at a node.
template <class Value, class Slope>
Reading read(const std::vector<double>& at, const Interval& where, const Value& value, const Slope& slope) {
    const auto k = static_cast<std::size_t>(where.node);
    const double width = at[k + 1] - at[k];
    const double rise = value(where.node + 1) - value(where.node);
    const double t = where.part;
    if (width <= jump_width) return {value(where.node) + t * rise, rise / width};
    const double before = slope(where.node) * width - rise;
    const double after = rise - slope(where.node + 1) * width;
    const double s = 1.0 - t;
    return {value(where.node) + t * (rise + s * (before * s + after * t)),
            (rise + before * s * (s - 2.0 * t) + after * t * (2.0 * s - t)) / width};
}

}  // namespace comminute::detail
