// SPDX-License-Identifier: BSD-3-Clause
// Exchanges of rows that are shifted past each other (docs/theory/columns.md, section 2).
#pragma once

#include "columns/exchange.hpp"

namespace comminute::detail {

/// Changes the law of two rows that are shifted past each other by one random distance, so that neighbours arrive together
/// (docs/theory/columns.md, section 2). It needs the whole law of either row, and is there for comparison.
/// @param sizes  (N) mean size of each node
void exchange_shifted(const TripleTables& tables, const std::vector<double>& sizes, Swaps swaps,
                      Exchange& exchange, TripleState& lower, FreshPairs& lower_fresh, TripleState& upper,
                      FreshPairs& upper_fresh);

}  // namespace comminute::detail
