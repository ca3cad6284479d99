// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include "comminute/error.hpp"
#include "comminute/view.hpp"

namespace comminute::detail {

std::string shape_text(Index rows, Index cols);

/// An entry of a list or an array, as a step of a place; no index: the whole of it.
Place entry(const char* list, std::initializer_list<Index> index = {});
Place entry(const char* list, std::size_t index);

/// Tells whether the value can be a share of the mass.
inline bool is_share(double value) {
    return std::isfinite(value) && value >= 0.0;
}

/// Throws ParameterError that the value at a place is no share of the mass; the last step names the parameter.
[[noreturn]] void refuse_share(double value, std::vector<Place> place);

/// Throws ParameterError unless the total is 1, as near as sums of shares come.
void require_whole(double total, const char* name);

/// Throws ParameterError unless the value can be the size that no grain exceeds.
void require_largest(double largest);

inline constexpr const char* finite = "every entry must be finite";
inline constexpr const char* finite_in_zone = "every entry inside the crush zone must be finite";

/// Throws ParameterError that an entry is not finite.
[[noreturn]] void refuse_not_finite(double value, Place at, const char* rule);

/// Throws ParameterError unless the entry of a state is finite.
inline void require_finite(double value, const char* state, std::initializer_list<Index> index,
                           const char* rule = finite_in_zone) {
    if (!std::isfinite(value)) refuse_not_finite(value, entry(state, index), rule);
}

/// Throws ShapeError unless a list has as many entries as it must; `rule` says why that many.
void require_entries(Index found, Index wanted, const Place& list, const std::string& rule,
                     std::vector<Place> outer = {});

/// Throws ShapeError unless a list has one entry for each bin of the grid.
void require_bins(Index found, Index bins, const Place& list, std::vector<Place> outer = {});

/// Throws ShapeError unless the view is bins x bins.
void require_square(Index rows, Index cols, Index stride, Index bins, const char* name);
template <class T>
void require_square(MatrixView<T> m, Index bins, const char* name) {
    require_square(m.rows(), m.cols(), m.stride(), bins, name);
}

/// Tells whether the memory from the first to the last entry of one view meets that of the other.
bool overlap(MatrixView<const double> a, MatrixView<const double> b);

/// Throws ShapeError if the two views share memory without being the same view.
void require_same_or_apart(MatrixView<const double> p, MatrixView<double> out);

}  // namespace comminute::detail
