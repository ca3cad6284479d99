// SPDX-License-Identifier: BSD-3-Clause
// A way into the closed law for rows that leave it (docs/theory/three_cells.md, section 5).
#pragma once

#include "comminute/resolved.hpp"
#include "resolved/triple_state.hpp"

namespace comminute::detail {

/// The library's own way into a Resolved.
class ResolvedAccess {
  public:
    /// The state of the finer steps under the largest load. Unlike what is extrapolated it is nowhere negative.
    static const TripleState& fine(const Resolved& law);
};

}  // namespace comminute::detail
