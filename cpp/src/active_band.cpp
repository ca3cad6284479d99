// SPDX-License-Identifier: BSD-3-Clause
#include "active_band.hpp"

#include <algorithm>
#include <cmath>

#include "shell_zone.hpp"

namespace comminute {

ActiveBand::ActiveBand(const LogGrid& grid, const Material& material, Scheme scheme)
    : grid_(grid),
      material_(material),
      scheme_(scheme),
      zones_(grid, material, 0.0),
      full_(static_cast<std::size_t>(grid.bins()), 0),
      last_(static_cast<std::size_t>(grid.bins()), -1),
      first_partial_(static_cast<std::size_t>(grid.bins()), 0) {}

void ActiveBand::clear() {
    std::fill(full_.begin(), full_.end(), 0);
    std::fill(last_.begin(), last_.end(), -1);
    partial_.clear();
}

void ActiveBand::set_load(double stress_ratio) {
    clear();
    if (scheme_ == Scheme::paper) {
        zones_.set_load(stress_ratio);
        for (Index m = 1; m < grid_.bins(); ++m) {
            last_[static_cast<std::size_t>(m)] = zones_.band(m);
            full_[static_cast<std::size_t>(m)] = zones_.band(m) + 1;
        }
        return;
    }
    if (stress_ratio == 0.0) return;
    const ShellZones zones(grid_, material_, std::log(stress_ratio));
    for (Index m = 1; m < grid_.bins(); ++m) {
        const ShellZone zone = zones[m];
        const auto at = static_cast<std::size_t>(m);
        full_[at] = zone.surely_whole(m);
        last_[at] = zone.surely_last(m);
        first_partial_[at] = static_cast<Index>(partial_.size());
        const auto partial = static_cast<std::size_t>(std::max(last_[at] + 1 - full_[at], Index{0}));
        partial_.resize(partial_.size() + partial);
        zone.shares(full_[at], last_[at], partial_.data() + first_partial_[at]);
        while (last_[at] >= full_[at] && partial_.back() == 0.0) {
            partial_.pop_back();
            --last_[at];
        }
    }
}

}  // namespace comminute
