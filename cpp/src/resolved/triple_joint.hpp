// SPDX-License-Identifier: BSD-3-Clause
// The paper's fabric of a law of three cells (docs/theory/three_cells.md, section 2).
#pragma once

#include <functional>
#include <vector>

#include "comminute/grid.hpp"
#include "resolved/triple_tables.hpp"

namespace comminute::detail {

/// (bins, bins) mass by bins of log grainsize and log neighbourhood grainsize.
/// @param mass_of  mass of the centre b between a and c
/// @throws ParameterError for a grid below the largest grain
std::vector<double> joint_of(const TripleTables& tables, const LogGrid& bins,
                             const std::function<double(Index, Index, Index)>& mass_of);

}  // namespace comminute::detail
