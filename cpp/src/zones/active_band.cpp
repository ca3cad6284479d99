// SPDX-License-Identifier: BSD-3-Clause
#include "zones/active_band.hpp"

#include <algorithm>
#include <cmath>

namespace comminute::detail {

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
    for (Index begin = 0; begin < grid_.bins(); begin += lanes) set_shells(zones, begin);
}

// Fills in `lanes` shells from `begin` on; shell 0, fines among fines, rests.
void ActiveBand::set_shells(const ShellZones& zones, Index begin) {
    const ShellZones::Extents extents = zones.extents(begin);
    const auto end = static_cast<std::size_t>(std::min(lanes, grid_.bins() - begin));
    Index rows = 0;
    for (std::size_t l = begin == 0 ? 1 : 0; l < end; ++l) {
        rows = std::max(rows, extents.last[l] + 1 - extents.whole[l]);
    }
    shares_.resize(std::max(shares_.size(), static_cast<std::size_t>(rows * lanes)));
    zones.shares(begin, extents.whole, rows, shares_.data());
    for (std::size_t l = begin == 0 ? 1 : 0; l < end; ++l) {
        const auto m = static_cast<std::size_t>(begin) + l;
        const double* const share = shares_.data() + l;
        Index partly = std::max(extents.last[l] + 1 - extents.whole[l], Index{0});
        while (partly > 0 && share[(partly - 1) * lanes] == 0.0) --partly;
        full_[m] = extents.whole[l];
        last_[m] = extents.whole[l] + partly - 1;
        first_partial_[m] = static_cast<Index>(partial_.size());
        for (Index row = 0; row < partly; ++row) partial_.push_back(share[row * lanes]);
    }
}

}  // namespace comminute::detail
