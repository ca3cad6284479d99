// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>

#include "base/random.hpp"
#include "comminute/lattice.hpp"
#include "model/fragment_quantile.hpp"

namespace comminute::detail {

/// Crushes one cell. The fragment is drawn by place, crush count and remixing, so it does not matter when this is done.
inline void crush(LatticeRing& ring, std::uint32_t cell, const FragmentQuantile& draw) {
    const std::uint64_t when = static_cast<std::uint64_t>(ring.remixes) << 32 | ring.crushes[cell]++;
    ring.cells[cell].psi += draw(random_uniform(ring.stream, Purpose::fragment, cell, when));
    ring.cells[cell].size = std::exp(ring.cells[cell].psi);
}

}  // namespace comminute::detail
