// SPDX-License-Identifier: BSD-3-Clause
#include "fabric/fabric_access.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace comminute::detail {

std::vector<PointMass> exact_sizes(const std::vector<Atom>& atoms, const std::vector<Ridge>& ridges) {
    std::vector<PointMass> sizes;
    sizes.reserve(atoms.size() + ridges.size());
    for (const Atom& atom : atoms) sizes.push_back({atom.psi, atom.mass});
    for (const Ridge& ridge : ridges) {
        if (ridge.exact != Axis::grain) continue;
        sizes.push_back({ridge.at, std::accumulate(ridge.mass.begin(), ridge.mass.end(), 0.0)});
    }
    std::stable_sort(sizes.begin(), sizes.end(),
                     [](const PointMass& a, const PointMass& b) { return a.psi < b.psi; });
    std::vector<PointMass> merged;
    for (const PointMass& size : sizes) {
        if (merged.empty() || merged.back().psi != size.psi) merged.push_back({size.psi, 0.0});
        merged.back().mass += size.mass;
    }
    return merged;
}

std::vector<PointMass> with_sizes(std::vector<PointMass> points, const std::vector<PointMass>& named) {
    for (PointMass& point : points) {
        const auto same = std::find_if(named.begin(), named.end(),
                                       [&](const PointMass& other) { return other.psi == point.psi; });
        if (same != named.end()) point.size = same->size;
    }
    return points;
}

double mass_above(const LogGrid& grid, VectorView<const double> mass, double psi) {
    const Index own = grid.bin_of(psi);
    if (own + 1 >= grid.bins()) return 0.0;
    const double upper_part = std::clamp((grid.edge(own + 1) - psi) / grid.spacing(), 0.0, 1.0);
    return std::min(upper_part * mass[own + 1], mass[own]);
}

std::vector<double> with_points(const LogGrid& grid, std::vector<double> spread,
                                const std::vector<PointMass>& points) {
    const VectorView<double> in_bins(spread);
    for (const PointMass& point : points) in_bins[grid.bin_of(point.psi)] += point.mass;
    return spread;
}

Fabric FabricAccess::make(FabricParts parts) {
    std::vector<double> grainsize = with_points(parts.grid, parts.spread, parts.points);
    return Fabric(std::make_shared<const Fabric::Data>(Fabric::Data{std::move(parts), std::move(grainsize)}));
}

}  // namespace comminute::detail
