// SPDX-License-Identifier: BSD-3-Clause
// Mass that crushed at an exact size and enters the bins (docs/theory/one_sweep.md, section 11).
#pragma once

#include <vector>

#include "base/arrays.hpp"

namespace comminute::detail {

/// Mass arriving in the bins from atoms and ridges: psi[i] * psibar[j] in cell (i, j).
struct OuterProduct {
    Array<double> psi;     ///< (N) factor by bin of the grain's own size
    Array<double> psibar;  ///< (N) factor by bin of the neighbourhood's size
};
using Arrivals = std::vector<OuterProduct>;

}  // namespace comminute::detail
