// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <functional>
#include <string>

#include "comminute/error.hpp"
#include "comminute/view.hpp"

namespace comminute::detail {

inline std::string shape_text(Index rows, Index cols) {
    return "(" + std::to_string(rows) + ", " + std::to_string(cols) + ")";
}

/// Throws ParameterError unless the value can be a share of the mass.
inline void require_share(double value, const std::string& place) {
    if (std::isfinite(value) && value >= 0.0) return;
    throw ParameterError(place + " is " + text(value) +
                         "; a share of the mass must be finite and at least 0");
}

/// Throws ParameterError unless the total is 1, as near as sums of shares come.
inline void require_whole(double total, const char* name) {
    if (std::abs(total - 1.0) <= 1e-9) return;
    throw ParameterError(std::string(name) + " adds up to " + text(total) +
                         "; it holds the whole mass, 1. Divide it by its sum");
}

/// Throws ShapeError unless the view is bins x bins.
template <class T>
void require_square(MatrixView<T> m, Index bins, const char* name) {
    if (m.rows() == bins && m.cols() == bins && m.stride() >= m.cols()) return;
    if (m.stride() < m.cols()) {
        throw ShapeError(std::string(name) + " has a stride of " + std::to_string(m.stride()) + "; rows of " +
                         std::to_string(m.cols()) + " need at least that");
    }
    throw ShapeError(std::string(name) + " has shape " + shape_text(m.rows(), m.cols()) +
                     "; the grid needs " + shape_text(bins, bins));
}

/// Whether the memory from the first to the last entry of one view meets that of the other.
inline bool overlap(MatrixView<const double> a, MatrixView<const double> b) {
    const double* a_end = a.row(a.rows() - 1) + a.cols();
    const double* b_end = b.row(b.rows() - 1) + b.cols();
    const std::less<> before;  // a total order, also between arrays
    return before(a.data(), b_end) && before(b.data(), a_end);
}

/// Throws ShapeError if the two views share memory without being the same view.
inline void require_same_or_apart(MatrixView<const double> p, MatrixView<double> out) {
    if (p.data() == out.data() && p.stride() == out.stride()) return;
    if (!overlap(p, out)) return;
    throw ShapeError("out overlaps p in part; pass p itself to step in place, or an array of its own");
}

}  // namespace comminute::detail
