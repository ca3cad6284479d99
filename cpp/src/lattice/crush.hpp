// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "base/random.hpp"
#include "comminute/lattice.hpp"
#include "model/fragment_quantile.hpp"

namespace comminute::detail {

/// ln of a factor from the Weibull law of scale 1, for a number from (0, 1).
inline double log_strength(double uniform, double weibull_modulus) {
    return std::log(-std::log1p(-uniform)) / weibull_modulus;
}
/// No factor is less: of a uniform number of 52 bits.
inline double least_log_strength(double weibull_modulus) {
    return log_strength(0x1p-53, weibull_modulus);
}

/// Crushes one cell. The fragment and its strength are drawn by place, crush count and remixing, so it does not matter when this is done.
inline void crush(LatticeRing& ring, std::uint32_t cell, const FragmentQuantile& draw,
                  const Material& material) {
    const std::uint64_t when = static_cast<std::uint64_t>(ring.remixes) << 32 | ring.crushes[cell]++;
    ring.cells[cell].psi += draw(random_uniform(ring.stream, Purpose::fragment, cell, when));
    ring.cells[cell].size = std::exp(ring.cells[cell].psi);
    if (!material.strength_scatter) return;
    const double uniform = random_uniform(ring.stream, Purpose::strength, cell, when);
    ring.log_strength[cell] = log_strength(uniform, material.weibull_modulus);
}

}  // namespace comminute::detail
