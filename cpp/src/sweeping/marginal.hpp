// SPDX-License-Identifier: BSD-3-Clause
// The grading after a sweep, without the state after it (docs/theory/one_sweep.md, section 10).
#pragma once

#include <vector>

#include "base/arrays.hpp"
#include "spreading/crush_table.hpp"
#include "sweeping/outer_product.hpp"

namespace comminute::detail {

/// (N) Sum of each row of a state: mass by grainsize.
std::vector<double> row_sums(MatrixView<const double> state);

/// Brings a grading from before a sweep to after it. Crushes in psibar do not change it, so it takes one line of running
/// sums.
/// @param arrivals  mass from atoms and ridges, none of it in the grading yet
/// @param crushed   (N) mass crushed in psi out of each bin, counted each time that it leaves the bin
/// @param grading   (N) mass by grainsize
void move_marginal(const CrushTable& table, const Arrivals& arrivals, const Array<double>& crushed,
                   VectorView<double> grading);

}  // namespace comminute::detail
