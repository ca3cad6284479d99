// SPDX-License-Identifier: BSD-3-Clause
// Active shares of the cells of a bin that the largest grain cuts off (docs/theory/one_sweep.md, section 3).
#pragma once

#include "comminute/view.hpp"

namespace comminute::detail {

/// A zone and the bin of the largest grain, lengths in bins from the centre of bin 0.
struct CutShell {
    double tip;  ///< place of the zone's onset
    double
        steepness;  ///< k / h: a distance W from the diagonal lies in the zone where W^2 <= steepness (x - tip)
    Index shell;    ///< the bin that holds the largest grain
    double top;     ///< place of the largest grain, in that bin: no mass lies above it
};

/// Share of a cell of this shell that lies in the zone, the cell being as long as its bin is below the largest grain.
/// Exact but for rounding.
double cut_share(const CutShell& cut, Index distance);

}  // namespace comminute::detail
