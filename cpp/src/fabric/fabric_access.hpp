// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/fabric.hpp"

namespace comminute::detail {

/// The library's own way to a Fabric, of parts that are known to be right.
class FabricAccess {
  public:
    static Fabric make(FabricParts parts);
};

/// The exact sizes among atoms and ridges, each once, fine to coarse.
std::vector<PointMass> exact_sizes(const std::vector<Atom>& atoms, const std::vector<Ridge>& ridges);

/// The same points, each with the size that `named` has beside the same log size.
std::vector<PointMass> with_sizes(std::vector<PointMass> points, const std::vector<PointMass>& named);

/// Mass of the grains that are larger than an exact log size and share its bin.
///
/// Grains of that size leave fragments on its lower side alone, while those of coarser grains pass through evenly, as they
/// do through the next bin up, whose density therefore holds above the exact size.
double mass_above(const LogGrid& grid, VectorView<const double> mass, double psi);

/// (N) `spread` with every point in the bin that holds it.
std::vector<double> with_points(const LogGrid& grid, std::vector<double> spread,
                                const std::vector<PointMass>& points);

}  // namespace comminute::detail
