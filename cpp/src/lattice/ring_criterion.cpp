// SPDX-License-Identifier: BSD-3-Clause
#include "lattice/ring_criterion.hpp"

namespace comminute::detail {

double largest_psi(const LatticeRing& ring) {
    double largest = -std::numeric_limits<double>::infinity();
    for (const LatticeCell& cell : ring.cells) largest = std::max(largest, cell.psi);
    return largest;
}

double closed_log_load(const LatticeRing& ring, const Material& material, double stress_ratio) {
    const double log_load = std::log(stress_ratio);
    const double strength = 3.0 / material.weibull_modulus;
    const double cushion = std::max(log_load + strength * largest_psi(ring), 0.0);
    const double slope =
        std::sqrt(2.0 * cushion) / material.fabric_width;  // of the cushion, where it bears the load
    const double slack = std::abs(log_load) + strength + slope;
    return log_load + 8.0 * std::numeric_limits<double>::epsilon() * slack;
}

}  // namespace comminute::detail
