// SPDX-License-Identifier: BSD-3-Clause
// The table of shares, filled a pack of shells at a time (docs/theory/one_sweep.md, section 3).
#include "zones/active_band.hpp"

#include <algorithm>
#include <cmath>

#include "zones/cut_shares.hpp"

namespace comminute::detail {

ActiveBand::ActiveBand(const LogGrid& grid, const Material& material, Scheme scheme)
    : grid_(grid),
      material_(material),
      scheme_(scheme),
      zones_(grid, material, 0.0),
      full_(grid.bins(), 0),
      last_(grid.bins(), -1),
      first_partial_(grid.bins(), 0) {}

void ActiveBand::clear() {
    std::fill(full_.begin(), full_.end(), 0);
    std::fill(last_.begin(), last_.end(), -1);
    partial_.clear();
}

void ActiveBand::set_load(double stress_ratio, double largest) {
    clear();
    if (scheme_ == Scheme::paper) {
        zones_.set_load(stress_ratio);
        for (Index m = 1; m < grid_.bins(); ++m) {
            last_[m] = zones_.band(m);
            full_[m] = zones_.band(m) + 1;
        }
        return;
    }
    if (stress_ratio == 0.0) return;
    const ShellZones zones(grid_, material_, std::log(stress_ratio));
    for (Index begin = 0; begin < grid_.bins(); begin += lanes) {
        if (!zones.none(begin)) set_shells(zones, begin);
    }
    if (largest > 0.0) cut_shell(largest, std::log(stress_ratio));
}

// Computes the partial shares in the bin of the largest grain anew. Cells that lie in the zone as a whole, or outside,
// stay so when they are cut off.
void ActiveBand::cut_shell(double largest, double log_stress_ratio) {
    const double h = grid_.spacing();
    const double top = (std::log(largest) - grid_.centre(0)) / h;
    if (!(top < static_cast<double>(grid_.bins()) - 0.5)) return;
    const auto own = static_cast<Index>(std::floor(top + 0.5));
    constexpr double rounding = 1e-9;  // a size this near to an edge, in bins, lies on it
    const double part = top + 0.5 - static_cast<double>(own);
    if (own < 1 || part < rounding || part > 1.0 - rounding) return;
    const CutShell cut{(zone_onset(material_, log_stress_ratio) - grid_.centre(0)) / h, material_.k() / h,
                       own, top};
    for (Index d = full_[own]; d <= last_[own]; ++d)
        partial_[first_partial_[own] + d - full_[own]] = cut_share(cut, d);
}

// Sets a pack of shells from `begin` on. Shell 0, fines among fines, is always at rest.
void ActiveBand::set_shells(const ShellZones& zones, Index begin) {
    const ShellZones::Extents extents = zones.extents(begin);
    const Index first = begin == 0 ? 1 : 0;
    const Index end = std::min(lanes, grid_.bins() - begin);
    const VectorView<const Index> whole(extents.whole.data(), lanes);
    const VectorView<const Index> last(extents.last.data(), lanes);
    Index rows = 0;
    for (Index l = first; l < end; ++l) rows = std::max(rows, last[l] + 1 - whole[l]);
    shares_.resize(std::max(shares_.size(), rows * lanes));
    zones.shares(begin, extents.whole, rows, shares_.data());
    for (Index l = first; l < end; ++l) {
        const Index m = begin + l;
        const double* const share = shares_.data() + l;
        Index partly = std::max(last[l] + 1 - whole[l], Index{0});
        while (partly > 0 && share[(partly - 1) * lanes] == 0.0) --partly;
        full_[m] = whole[l];
        last_[m] = whole[l] + partly - 1;
        first_partial_[m] = partial_.size();
        for (Index row = 0; row < partly; ++row) partial_.push_back(share[row * lanes]);
    }
}

}  // namespace comminute::detail
