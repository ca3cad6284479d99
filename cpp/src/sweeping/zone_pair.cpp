// SPDX-License-Identifier: BSD-3-Clause
// Pairs of zones, kept from one solve to the next (docs/theory/one_sweep.md, sections 4 and 15).
#include "sweeping/zone_pair.hpp"

#include <algorithm>
#include <utility>

#include "zones/moving_shares.hpp"

namespace comminute::detail {

ZonePair::ZonePair(const LogGrid& grid, const Material& material, Scheme scheme)
    : bins_(grid.bins()),
      before_(grid, material, scheme),
      after_(grid, material, scheme),
      extent_(grid.bins()) {
    set_shares();
}

void ZonePair::set_material(const LogGrid& grid, const Material& material, Scheme scheme) {
    before_ = ActiveBand(grid, material, scheme);
    after_ = ActiveBand(grid, material, scheme);
    settled_at_ = stress_ratio_ = largest_ = 0.0;
    set_shares();
}

// Zones cost as much as a small sweep, so they are kept: for many states under the same loads, and for a load path, whose
// next solve starts in the zone in which the last one ended.
void ZonePair::set(double settled_at, double stress_ratio, double largest) {
    if (is(settled_at, stress_ratio, largest)) return;
    const bool same_grains = largest == std::exchange(largest_, largest);
    const double earlier = std::exchange(settled_at_, settled_at);
    const double later = std::exchange(stress_ratio_, stress_ratio);
    if (same_grains && settled_at == later && settled_at != earlier) {
        std::swap(before_, after_);
        after_.set_load(stress_ratio, largest);
    } else {
        if (!same_grains || settled_at != earlier) before_.set_load(settled_at, largest);
        if (!same_grains || stress_ratio != later) after_.set_load(stress_ratio, largest);
    }
    set_shares();
}

void ZonePair::set_shares() {
    extent_known_ = false;
    width_ = -1;
    for (Index m = 0; m < bins_; ++m) width_ = std::max(width_, last(m));
    if (!narrow()) return;
    const Index stride = std::max(width_, Index{0}) + 1;
    settled_.assign(bins_ * stride, 0.0);
    arrived_.assign(bins_ * stride, 0.0);
    for (Index m = 0; m < bins_; ++m) {
        for (Index d = 0; d <= last(m); ++d) {
            const double before = d > before_.last(m) ? 0.0 : before_.share(m, d);
            const MovingShares moving = moving_shares(before, after_.share(m, d));
            settled_[m * stride + d] = moving.settled;
            arrived_[m * stride + d] = moving.arrived;
        }
    }
}

}  // namespace comminute::detail
