// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/fabric.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "check.hpp"
#include "comminute/material.hpp"

namespace comminute {
namespace {

using Line = Eigen::Map<Eigen::ArrayXd>;
using ConstLine = Eigen::Map<const Eigen::ArrayXd>;

constexpr double total_tolerance = 1e-9;

void require_whole(double total, const char* name) {
    if (std::abs(total - 1.0) <= total_tolerance) return;
    throw ParameterError(std::string(name) + " adds up to " + text(total) +
                         "; it holds the whole mass, 1. Divide it by its sum");
}

void require_share(bool ok, const std::string& place, double value) {
    if (ok) return;
    throw ParameterError(place + " is " + text(value) +
                         "; a share of the mass must be finite and at least 0");
}

// Where the mean of two neighbours d bins apart lies: `bins` whole bins and a bit below the larger one's
// centre, with `upper` the share given to the upper of the two centres next to it. The same for every pair,
// since bins are even.
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

}  // namespace

Fabric::Fabric(const LogGrid& grid, std::vector<double> probability, std::optional<double> settled_at,
               Mean mean) {
    const Index bins = grid.bins();
    if (static_cast<Index>(probability.size()) != bins * bins) {
        throw ShapeError("probability has " + std::to_string(probability.size()) +
                         " entries; the grid needs shape " + shape_text(bins, bins));
    }
    if (settled_at) require_stress_ratio(*settled_at);
    std::vector<double> grainsize(static_cast<std::size_t>(bins));
    for (Index i = 0; i < bins; ++i) {
        const ConstLine row(probability.data() + i * bins, bins);
        for (Index j = 0; j < bins; ++j) {
            require_share(std::isfinite(row[j]) && row[j] >= 0.0,
                          "probability[" + std::to_string(i) + ", " + std::to_string(j) + "]", row[j]);
        }
        grainsize[static_cast<std::size_t>(i)] = row.sum();
    }
    require_whole(std::accumulate(grainsize.begin(), grainsize.end(), 0.0), "probability");
    data_ = std::make_shared<const Data>(
        Data{grid, std::move(probability), std::move(grainsize), settled_at, mean});
}

MatrixView<const double> Fabric::probability() const {
    return {data_->probability.data(), grid().bins(), grid().bins()};
}

std::vector<double> Fabric::neighbourhood() const {
    const Index bins = grid().bins();
    std::vector<double> pmf(static_cast<std::size_t>(bins), 0.0);
    for (Index i = 0; i < bins; ++i) Line(pmf.data(), bins) += ConstLine(probability().row(i), bins);
    return pmf;
}

std::vector<double> Fabric::cdf() const {
    std::vector<double> finer(data_->grainsize.size());
    std::partial_sum(data_->grainsize.begin(), data_->grainsize.end(), finer.begin());
    return finer;
}

bool operator==(const Fabric& a, const Fabric& b) {
    return a.grid() == b.grid() && a.mean() == b.mean() && a.settled_at() == b.settled_at() &&
           a.data_->probability == b.data_->probability;
}

std::vector<double> neighbourhood_pmf(const LogGrid& grid, VectorView<const double> grainsize, Mean mean) {
    const Index bins = grid.bins();
    if (grainsize.size() != bins) {
        throw ShapeError("grainsize has " + std::to_string(grainsize.size()) + " entries; the grid has " +
                         std::to_string(bins) + " bins");
    }
    std::vector<double> pmf(static_cast<std::size_t>(bins), 0.0);
    for (Index d = 0; d < bins; ++d) {
        const MeanPlace place = place_of_mean(grid.spacing(), d, mean);
        const double ways = d == 0 ? 1.0 : 2.0;
        const Index pairs = bins - d;  // the smaller one in bin 0 .. pairs - 1
        const auto weight =
            ways * ConstLine(grainsize.data(), pairs) * ConstLine(grainsize.data() + d, pairs);
        Line(pmf.data() + d - place.bins, pairs) += place.upper * weight;
        if (place.upper < 1.0) Line(pmf.data() + d - place.bins - 1, pairs) += (1.0 - place.upper) * weight;
    }
    return pmf;
}

Fabric mixed_fabric(const LogGrid& grid, std::vector<double> grainsize, Mean mean) {
    for (std::size_t i = 0; i < grainsize.size(); ++i) {
        require_share(std::isfinite(grainsize[i]) && grainsize[i] >= 0.0,
                      "grainsize[" + std::to_string(i) + "]", grainsize[i]);
    }
    require_whole(std::accumulate(grainsize.begin(), grainsize.end(), 0.0), "grainsize");
    std::vector<double> neighbours = neighbourhood_pmf(grid, grainsize, mean);
    const double pairs = std::accumulate(neighbours.begin(), neighbours.end(), 0.0);
    for (double& share : neighbours) share /= pairs;  // the product then adds up to what the grains do
    const Index bins = grid.bins();
    std::vector<double> probability(static_cast<std::size_t>(bins * bins));
    for (Index i = 0; i < bins; ++i) {
        Line(probability.data() + i * bins, bins) =
            grainsize[static_cast<std::size_t>(i)] * ConstLine(neighbours.data(), bins);
    }
    // The given marginal is kept as it is, not summed anew: remixing a mixed fabric then gives the same bits.
    return Fabric(std::make_shared<const Fabric::Data>(
        Fabric::Data{grid, std::move(probability), std::move(grainsize), std::nullopt, mean}));
}

Fabric remix(const Fabric& fabric) {
    const VectorView<const double> grainsize = fabric.grainsize();
    return mixed_fabric(fabric.grid(), {grainsize.begin(), grainsize.end()}, fabric.mean());
}

}  // namespace comminute
