// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/grading.hpp"
#include "comminute/lattice.hpp"

namespace comminute::detail {

/// A ring whose sizes are drawn from a grading independently, by the stream of a replica.
LatticeRing sampled_ring(Index cells, Index replica, const Grading& grading, const Material& material,
                         std::uint64_t seed);

/// A ring of given sizes > 0, with the stream of a replica.
LatticeRing ring_of_sizes(VectorView<const double> sizes, Index replica, const Material& material,
                          std::uint64_t seed);

}  // namespace comminute::detail
