// SPDX-License-Identifier: BSD-3-Clause
// The shares of one shell from the bands before and after the load (docs/theory/one_sweep.md, sections 4 and 8).
#include "sweeping/shell_shares.hpp"

#include <algorithm>

namespace comminute::detail {

ShellShares::ShellShares(const ShellWalk& walk)
    : walk_(walk), settled_share_(walk.bins() + lanes), arrived_share_(walk.bins() + lanes) {}

void ShellShares::begin() {
    ones_from_ = walk_.bins();
    std::fill(arrived_share_.begin(), arrived_share_.end(), 0.0);
}

void ShellShares::set(const ActiveBand& before, const ActiveBand& after, Index m) {
    double* const arrived = arrived_share_.data();
    const Index first = walk_.first(m);
    const Index last = std::clamp(after.last(m), Index{0}, m);
    const Index whole = std::max(after.full(m) - 1, Index{0});  // cells of an arm that move as a whole
    for (Index line = lanes_down(first); line < m - last; ++line) arrived[line] = 0.0;
    for (Index d = last; d > whole; --d) arrived[m - d] = after.share(m, d);
    for (Index line = m - whole; line < std::min(m, ones_from_); ++line) arrived[line] = 1.0;
    ones_from_ = m - whole;
    arrived[m] = 0.0;
    if (walk_.reaches_fines(m)) arrived[0] = after.share(m, m);
    diagonal_.arrived = diagonal_.settled = after.share(m, 0);
    settled_ = arrived;
    if (before.last(m) >= 0) {
        double* const settled = settled_share_.data();
        settled_ = settled;
        std::copy(arrived + lanes_down(first), arrived + lanes_up(m), settled + lanes_down(first));
        for (Index d = std::min(before.last(m), m - first); d > 0; --d) {
            const MovingShares moving = moving_shares(before.share(m, d), arrived[m - d]);
            settled[m - d] = moving.settled;
            arrived[m - d] = moving.arrived;
        }
        diagonal_ = moving_shares(before.share(m, 0), diagonal_.arrived);
    }
    if (walk_.reaches_fines(m)) {
        fines_ = {settled_[0], arrived[0]};
        arrived[0] = settled_share_[0] = 0.0;
    }
}

}  // namespace comminute::detail
