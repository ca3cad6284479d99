// SPDX-License-Identifier: BSD-3-Clause
#include "active_band.hpp"

#include <algorithm>
#include <cmath>

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
    for (Index m = 1; m < grid_.bins(); ++m) set_shell_by_area(m, stress_ratio);
}

// With the larger grain at t bins from its centre, t in [-1/2, 1/2], the zone's half-width is
// omega(t) = sqrt(k/h (t - tip)) bins, tip its place of onset. A cell at distance d >= 1 lies inside where
// d <= omega(t) - t - 1/2 for all t; omega(t) - t is concave, so its least value is at an end. It lies outside where
// d >= 1/2 - t + omega(t) for all t; that is less than 1 + omega(1/2).
void ActiveBand::set_shell_by_area(Index m, double stress_ratio) {
    const auto at = static_cast<std::size_t>(m);
    const double h = grid_.spacing();
    const double strength = 3.0 / material_.weibull_modulus;
    const double excess =
        std::log(stress_ratio) + strength * (grid_.centre(m) - std::log(material_.reference_size));
    const double tip = -excess / (strength * h);
    if (!(tip < 0.5)) return;
    const double steepness = material_.k() / h;
    const double widest = std::sqrt(steepness * (0.5 - tip));
    const auto longest = static_cast<double>(m);
    Index full = 0;
    if (tip <= -0.5) {
        const double inner = std::min(std::sqrt(steepness * (-0.5 - tip)), widest - 1.0);
        if (inner >= 0.0) full = static_cast<Index>(std::min(std::floor(inner), longest)) + 1;
    }
    Index last = static_cast<Index>(std::min(std::ceil(1.0 + widest), longest));
    full_[at] = full;
    first_partial_[at] = static_cast<Index>(partial_.size());
    for (Index d = full; d <= last; ++d) {
        partial_.push_back(active_share(grid_, material_, stress_ratio, m, d));
    }
    while (last >= full && partial_.back() == 0.0) {
        partial_.pop_back();
        --last;
    }
    last_[at] = last;
}

}  // namespace comminute
