// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "comminute/lattice.hpp"

namespace comminute::detail {

/// Raises the load on one ring from where it stands up to `stress_ratio`, always crushing the weakest cell of all
/// first (equally weak ones in random order), until no cell is left that this load crushes.
///
/// @param go_on  asked now and then; if it answers false (or throws) the ring is left as it is at that moment, and
///               the same call made again ends in the very state that an undisturbed one would have reached
/// @return       whether it came to the end
bool crush_weakest_first(LatticeRing& ring, const Material& material, Mean mean, double stress_ratio,
                         bool record_avalanches, const std::function<bool()>& go_on);

}  // namespace comminute::detail
