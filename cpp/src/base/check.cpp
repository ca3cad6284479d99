// SPDX-License-Identifier: BSD-3-Clause
#include "base/check.hpp"

#include <functional>

namespace comminute::detail {

std::string shape_text(Index rows, Index cols) {
    return "(" + std::to_string(rows) + ", " + std::to_string(cols) + ")";
}

Place entry(const char* list, std::initializer_list<Index> index) {
    return {.name = list, .index = index};
}

Place entry(const char* list, std::size_t index) {
    return entry(list, {static_cast<Index>(index)});
}

void refuse_share(double value, std::vector<Place> place) {
    throw ParameterError({.parameter = place.back().name,
                          .value = text(value),
                          .number = value,
                          .rule = "a share of the mass must be finite and at least 0",
                          .place = place});
}

void require_whole(double total, const char* name) {
    if (std::abs(total - 1.0) <= 1e-9) return;
    throw ParameterError({.parameter = name,
                          .value = text(total),
                          .number = total,
                          .finding = "adds up to " + text(total),
                          .rule = "it holds the whole mass, 1",
                          .remedy = Remedy::normalise});
}

void require_largest(double largest) {
    require(largest >= 0.0 && std::isfinite(largest), "largest", largest,
            "a size, or 0 where it is not known");
}

void refuse_not_finite(double value, Place at, const char* rule) {
    throw ParameterError(
        {.parameter = at.name, .value = text(value), .number = value, .rule = rule, .place = {at}});
}

void require_entries(Index found, Index wanted, const Place& list, const std::string& rule,
                     std::vector<Place> outer) {
    if (found == wanted) return;
    outer.push_back(list);
    throw ShapeError({.parameter = list.name,
                      .value = std::to_string(found),
                      .number = static_cast<double>(found),
                      .finding = "has " + std::to_string(found) + " entries",
                      .rule = rule,
                      .place = std::move(outer)});
}

void require_bins(Index found, Index bins, const Place& list, std::vector<Place> outer) {
    if (found == bins) return;  // words cost memory
    require_entries(found, bins, list, "the grid has " + std::to_string(bins) + " bins", std::move(outer));
}

void require_square(Index rows, Index cols, Index stride, Index bins, const char* name) {
    if (stride < cols) {
        throw ShapeError({.parameter = name,
                          .value = std::to_string(stride),
                          .number = static_cast<double>(stride),
                          .finding = "has a stride of " + std::to_string(stride),
                          .rule = "rows of " + std::to_string(cols) + " need at least that"});
    }
    if (rows == bins && cols == bins) return;
    throw ShapeError({.parameter = name,
                      .value = shape_text(rows, cols),
                      .finding = "has shape " + shape_text(rows, cols),
                      .rule = "the grid needs " + shape_text(bins, bins)});
}

bool overlap(MatrixView<const double> a, MatrixView<const double> b) {
    const double* a_end = a.row(a.rows() - 1) + a.cols();
    const double* b_end = b.row(b.rows() - 1) + b.cols();
    const std::less<> before;  // a total order, also between arrays
    return before(a.data(), b_end) && before(b.data(), a_end);
}

void require_same_or_apart(MatrixView<const double> p, MatrixView<double> out) {
    if (p.data() == out.data() && p.stride() == out.stride()) return;
    if (!overlap(p, out)) return;
    throw ShapeError({.parameter = "out",
                      .finding = "overlaps p in part",
                      .rule = "it must be p itself, to step in place, or an array of its own"});
}

}  // namespace comminute::detail
