// SPDX-License-Identifier: BSD-3-Clause
// Shares of a cell's mass that move when its zone grows (docs/theory/one_sweep.md, section 4).
#pragma once

#include <algorithm>

namespace comminute::detail {

/// Shares of the mass in one cell that crush during a solve.
struct MovingShares {
    double settled = 0.0;  ///< of the mass that had come to rest in the cell under the load before
    double arrived = 0.0;  ///< of the mass that lands in the cell during the solve

    /// Divides the mass of the cell into the part that moves, returned, and the part that stays.
    /// @param there   mass that was there before; may be infinite or NaN where its share is 0
    /// @param landed  mass that has landed
    /// @param rest    out: mass that stays; null to skip
    double divide(double there, double landed, double* rest) const {
        if (rest != nullptr) *rest = there * (1.0 - settled) + landed * (1.0 - arrived);
        return (settled != 0.0 ? there * settled : 0.0) + landed * arrived;
    }
};

/// Shares for a cell whose part inside the zone grows from `before` to `after`, both in [0, 1].
///
/// Mass at rest fills the part outside the old zone, 1 - before, of which the new zone takes after - before. Zones are
/// nested, so `after` is the larger; where rounding says otherwise, `before` is used for both.
inline MovingShares moving_shares(double before, double after) {
    after = std::max(after, before);
    return {before < 1.0 ? (after - before) / (1.0 - before) : 0.0, after};
}

}  // namespace comminute::detail
