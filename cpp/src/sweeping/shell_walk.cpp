// SPDX-License-Identifier: BSD-3-Clause
// The edge of the band, shell by shell (docs/theory/one_sweep.md, section 5).
#include "sweeping/shell_walk.hpp"

namespace comminute::detail {

void ShellWalk::begin(const CrushTable& table, const ActiveBand& after) {
    table_ = &table;
    block_shell_ = -1;
    longest_ = 0;
    Index lowest = bins_;
    for (Index m = bins_ - 1; m >= 0; --m) {
        lowest = std::min({lowest, m - after.last(m), m});
        first_[m] = lowest;
        longest_ = std::max(longest_, m - lowest);
    }
}

}  // namespace comminute::detail
