// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "comminute/fabric.hpp"

namespace comminute::detail {

/// The library's own way into a Fabric: its marginals as they were handed on, and fabrics made of parts that are known
/// to be right.
class FabricAccess {
  public:
    using Data = Fabric::Data;

    static Fabric make(Data data) { return Fabric(std::make_shared<const Data>(std::move(data))); }
    /// (N) marginal of the bins and of the ridges that spread over psi, without the exact sizes.
    static const std::vector<double>& spread(const Fabric& fabric) { return fabric.data_->spread; }
    /// (N) marginal of the bins alone.
    static const std::vector<double>& rows(const Fabric& fabric) { return fabric.data_->rows; }
    static std::vector<double> probability(const Fabric& fabric) { return fabric.data_->probability; }
};

/// The exact sizes among atoms and ridges, each once, fine to coarse.
std::vector<PointMass> exact_sizes(const std::vector<Atom>& atoms, const std::vector<Ridge>& ridges);

/// (N) `spread` with every point in the bin that holds it.
std::vector<double> with_points(const LogGrid& grid, std::vector<double> spread,
                                const std::vector<PointMass>& points);

}  // namespace comminute::detail
