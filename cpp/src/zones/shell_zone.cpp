// SPDX-License-Identifier: BSD-3-Clause
// Integrals of the zone over cells, several shells side by side (docs/theory/one_sweep.md, section 3).
#include "zones/shell_zone.hpp"

#include <algorithm>
#include <cmath>

#include "simd/zone_shares.hpp"

namespace comminute::detail {

double zone_onset(const Material& material, double log_stress_ratio) {
    return std::log(material.reference_size) - material.weibull_modulus / 3.0 * log_stress_ratio;
}

ShellZones::ShellZones(const LogGrid& grid, const Material& material, double log_stress_ratio)
    : tip_((zone_onset(material, log_stress_ratio) - grid.centre(0)) / grid.spacing()),
      steepness_(material.k() / grid.spacing()) {}

ShellZones::Extents ShellZones::extents(Index m) const {
    double inner[lanes];
    double outer[lanes];
    if (std::isinf(tip_) || std::isinf(steepness_)) {
        for (Index l = 0; l < lanes; ++l) {
            const double tip = steepness_ > 0.0 ? tip_ - static_cast<double>(m + l) : 0.5;
            inner[l] = tip < -0.5 ? steepness_ * (-0.5 - tip) : -1.0;
            outer[l] = tip < 0.5 ? steepness_ * (0.5 - tip) : -1.0;
        }
    } else {
        zone_widths({tip_, steepness_}, m, inner, outer);
    }
    Extents extents;
    for (Index l = 0; l < lanes; ++l) {
        const auto most = static_cast<double>(m + l);
        at(extents.whole, l) = inner[l] >= 0.0 ? static_cast<Index>(std::min(inner[l], most)) + 1 : 0;
        at(extents.last, l) = outer[l] >= 0.0 ? static_cast<Index>(std::min(outer[l], most)) : -1;
    }
    return extents;
}

void ShellZones::shares(Index m, const Distances& first, Index rows, double* share) const {
    if (!std::isinf(tip_) && !std::isinf(steepness_)) {
        double distance[lanes];
        std::copy(first.begin(), first.end(), distance);
        zone_shares({tip_, steepness_}, m, distance, rows, share);
        return;
    }
    // With the fabric off the zone holds all sizes above the tip; a fabric so narrow that its square is 0 has none.
    for (Index row = 0; row < rows; ++row) {
        for (Index l = 0; l < lanes; ++l) {
            const double begin = std::clamp(tip_ - static_cast<double>(m + l), -0.5, 0.5);
            const double above = steepness_ > 0.0 ? 0.5 - begin : 0.0;
            share[row * lanes + l] = at(first, l) + row == 0 ? above * (2.0 - above) : above;
        }
    }
}

}  // namespace comminute::detail
