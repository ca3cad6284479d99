// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "comminute/fabric.hpp"
#include "fabric/fabric_access.hpp"
#include "fabric/neighbourhoods.hpp"

namespace comminute {

using namespace detail;

namespace {

// Log size of the mean of two neighbours; equal ones have exactly their own.
double mean_of(double a, double b, Mean mean) {
    const double larger = std::max(a, b);
    const double apart = larger - std::min(a, b);
    if (apart == 0.0) return larger;
    if (mean == Mean::geometric) return larger - 0.5 * apart;
    return larger + std::log1p(std::exp(-apart)) - std::numbers::ln2;
}

// Hat weights of a log size between the two centres next to it, such that the mean of s (or of psi) is kept.
struct Shared {
    Index lower;
    double upper_share;
};

Shared between_centres(const LogGrid& grid, double psi, Mean mean) {
    const double h = grid.spacing();
    const double place = (psi - grid.psi_min()) / h;
    const auto lower = std::clamp(static_cast<Index>(std::floor(place)), Index{0}, grid.bins() - 2);
    const double above = psi - grid.centre(lower);
    const double share = mean == Mean::geometric ? above / h : std::expm1(above) / std::expm1(h);
    return {lower, std::clamp(share, 0.0, 1.0)};
}

// Place of the mean of two neighbours d bins apart: `bins` whole bins and a bit below the larger one's centre, with
// `upper` the share given to the upper of the two centres next to it. It is the same for every pair, since bins are even.
struct MeanPlace {
    Index bins;
    double upper;
};

MeanPlace place_of_mean(double h, Index d, Mean mean) {
    if (d == 0) return {0, 1.0};
    const auto distance = static_cast<double>(d);
    if (mean == Mean::geometric) return {d / 2, d % 2 == 0 ? 1.0 : 0.5};
    // sizes in units of the larger one's; hat weights in s, so that E[sbar] = E[s]
    const double size = 0.5 * (1.0 + std::exp(-distance * h));
    const auto below = std::clamp(static_cast<Index>(-std::log(size) / h), Index{0}, d - 1);
    const double upper_size = std::exp(-static_cast<double>(below) * h);
    const double lower_size = upper_size * std::exp(-h);
    return {below, std::clamp((size - lower_size) / (upper_size - lower_size), 0.0, 1.0)};
}

// Neighbourhoods made of one grain of exact size and one from a bin.
void add_mixed_pairs(const LogGrid& grid, VectorView<const double> spread,
                     const std::vector<PointMass>& points, Mean mean, VectorView<double> pmf) {
    for (const PointMass& point : points) {
        for (Index i = 0; i < grid.bins(); ++i) {
            const double weight = 2.0 * point.mass * spread[i];
            if (weight == 0.0) continue;
            const Shared place = between_centres(grid, mean_of(point.psi, grid.centre(i), mean), mean);
            pmf[place.lower] += (1.0 - place.upper_share) * weight;
            pmf[place.lower + 1] += place.upper_share * weight;
        }
    }
}

std::vector<PointMass> exact_pairs(const std::vector<PointMass>& points, Mean mean) {
    std::vector<PointMass> pairs;
    for (std::size_t a = 0; a < points.size(); ++a) {
        for (std::size_t b = 0; b <= a; ++b) {
            const double ways = a == b ? 1.0 : 2.0;
            pairs.push_back(
                {mean_of(points[a].psi, points[b].psi, mean), ways * points[a].mass * points[b].mass});
        }
    }
    return pairs;
}

// Points of the same size as one, fine to coarse, those in the fines bin added to it.
std::vector<PointMass> resolved(const LogGrid& grid, const std::vector<PointMass>& points,
                                std::vector<double>& spread) {
    std::vector<Atom> as_atoms;
    for (const PointMass& point : points) {
        if (point.psi < grid.edge(1)) {
            spread[0] += point.mass;
        } else {
            as_atoms.push_back({point.psi, point.psi, point.mass});
        }
    }
    return with_sizes(exact_sizes(as_atoms, {}), points);
}

}  // namespace

void detail::add_neighbourhoods(const LogGrid& grid, VectorView<const double> grainsize, Mean mean,
                                VectorView<double> pmf) {
    const Index bins = grid.bins();
    for (Index d = 0; d < bins; ++d) {
        const MeanPlace place = place_of_mean(grid.spacing(), d, mean);
        const double ways = d == 0 ? 1.0 : 2.0;
        const Index pairs = bins - d;  // the smaller one in bin 0 .. pairs - 1
        const auto weight =
            ways * ConstLine(grainsize.data(), pairs) * ConstLine(grainsize.data() + d, pairs);
        Line(pmf.data() + d - place.bins, pairs) += place.upper * weight;
        if (place.upper < 1.0) Line(pmf.data() + d - place.bins - 1, pairs) += (1.0 - place.upper) * weight;
    }
}

void detail::mix_bins(const LogGrid& grid, VectorView<const double> grainsize, Mean mean,
                      VectorView<double> neighbours, MatrixView<double> out) {
    const Index bins = grid.bins();
    std::fill(neighbours.begin(), neighbours.end(), 0.0);
    add_neighbourhoods(grid, grainsize, mean, neighbours);
    Line in_bins(neighbours.data(), bins);
    in_bins /= std::accumulate(neighbours.begin(), neighbours.end(), 0.0);
    for (Index i = 0; i < bins; ++i) Line(out.row(i), bins) = grainsize[i] * in_bins;
}

std::vector<double> neighbourhood_pmf(const LogGrid& grid, VectorView<const double> grainsize, Mean mean) {
    require_bins(grainsize.size(), grid.bins(), entry("grainsize"));
    Array<double> pmf(grid.bins());
    add_neighbourhoods(grid, grainsize, mean, {pmf.data(), grid.bins()});
    return std::move(pmf).vector();
}

Fabric mixed_fabric(const LogGrid& grid, std::vector<double> grainsize, Mean mean,
                    std::vector<PointMass> points, double largest) {
    const Index bins = grid.bins();
    double total = 0.0;
    for (std::size_t i = 0; i < grainsize.size(); ++i) {
        if (!is_share(grainsize[i])) refuse_share(grainsize[i], {entry("grainsize", i)});
        total += grainsize[i];
    }
    for (std::size_t a = 0; a < points.size(); ++a) {
        if (!is_share(points[a].mass)) refuse_share(points[a].mass, {entry("points", a), entry("mass")});
        (void)grid.bin_of(points[a].psi);  // refuses what lies above the grid
        total += points[a].mass;
    }
    require_whole(total, points.empty() ? "grainsize" : "grainsize with its points");
    require_largest(largest);
    std::vector<double> neighbours = neighbourhood_pmf(grid, grainsize, mean);
    if (!points.empty()) {
        points = resolved(grid, points, grainsize);
        neighbours = neighbourhood_pmf(grid, grainsize, mean);  // of what now lies among the fines, too
    }
    add_mixed_pairs(grid, grainsize, points, mean, neighbours);
    std::vector<PointMass> exact_neighbours = exact_pairs(points, mean);

    // The product then adds up to what the grains do.
    double pairs = std::accumulate(neighbours.begin(), neighbours.end(), 0.0);
    for (const PointMass& neighbour : exact_neighbours) pairs += neighbour.mass;
    for (double& share : neighbours) share /= pairs;
    for (PointMass& neighbour : exact_neighbours) neighbour.mass /= pairs;
    const ConstLine in_bins(neighbours.data(), bins);
    const ConstLine grains(grainsize.data(), bins);

    Array<double> probability(bins * bins);
    for (Index i = 0; i < bins; ++i) Line(probability.data() + i * bins, bins) = grains[i] * in_bins;
    Array<double> rows(bins);
    Line(rows.data(), bins) =
        points.empty() ? Eigen::ArrayXd(grains) : Eigen::ArrayXd(in_bins.sum() * grains);
    FabricParts parts{grid, std::move(probability).vector(), {},        {},     std::nullopt,
                      mean, std::move(rows).vector(),        grainsize, points, largest};
    const auto add_ridge = [&](Axis exact, double at, const ConstLine& others, double share) {
        if ((others == 0.0).all()) return;
        Array<double> mass(bins);
        Line(mass.data(), bins) = share * others;
        const double above = mass_above(grid, {mass.data(), bins}, at);
        parts.ridges.push_back({exact, at, std::move(mass).vector(), above});
    };
    for (const PointMass& point : points) {
        for (const PointMass& neighbour : exact_neighbours) {
            parts.atoms.push_back({point.psi, neighbour.psi, point.mass * neighbour.mass});
        }
        add_ridge(Axis::grain, point.psi, in_bins, point.mass);
    }
    for (const PointMass& neighbour : exact_neighbours) {
        add_ridge(Axis::neighbour, neighbour.psi, grains, neighbour.mass);
    }
    return FabricAccess::make(std::move(parts));
}

// The marginals are handed on, not summed anew: remixing a mixed fabric gives the same bits.
Fabric remix(const Fabric& fabric) {
    return mixed_fabric(fabric.grid(), fabric.parts().spread, fabric.mean(), fabric.points(),
                        fabric.largest());
}

}  // namespace comminute
