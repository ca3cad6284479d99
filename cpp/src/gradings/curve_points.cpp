// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "base/check.hpp"
#include "comminute/grading.hpp"

namespace comminute {

using namespace detail;

double CurvePoints::finer(double size_at) const {
    const auto above =
        static_cast<std::size_t>(std::upper_bound(size.begin(), size.end(), size_at) - size.begin());
    if (above == size.size()) return 1.0;
    if (above == 0)
        return tail_slope > 0.0 ? finer_than.front() * std::pow(size_at / size.front(), tail_slope) : 0.0;
    const double fraction = std::log(size_at / size[above - 1]) / std::log(size[above] / size[above - 1]);
    return finer_than[above - 1] + fraction * (finer_than[above] - finer_than[above - 1]);
}

double CurvePoints::mean_log() const {
    const double finest = std::log(size.front());
    double mean = 0.0;
    double below = finest;
    for (std::size_t q = 1; q < size.size(); ++q) {
        const double at = std::log(size[q]);
        mean += (finer_than[q] - finer_than[q - 1]) * 0.5 * (at + below);
        below = at;
    }
    if (!(finer_than.front() > 0.0)) return mean;
    if (!(tail_slope > 0.0)) return std::numeric_limits<double>::quiet_NaN();
    return mean + finer_than.front() * (finest - 1.0 / tail_slope);
}

double CurvePoints::breakage_potential(double silt) const {
    // Between two points the mass is even in ln d, and so is the potential above the silt size.
    const auto potential_at = [silt](double at) { return std::log10(std::max(at / silt, 1.0)); };
    const double at_silt = finer(silt);
    const double b = potential_at(size.front());
    double potential = 0.0;
    double lower = b;
    for (std::size_t q = 1; q < size.size(); ++q) {
        if (size[q] <= silt) continue;
        const double upper = potential_at(size[q]);
        const double below = size[q - 1] < silt ? at_silt : finer_than[q - 1];
        potential += (finer_than[q] - below) * 0.5 * (lower + upper);
        lower = upper;
    }
    if (!(b > 0.0) || !(finer_than.front() > 0.0)) return potential;
    const double share_at_silt = std::pow(silt / size.front(), tail_slope);
    const double fall = tail_slope > 0.0 ? (1.0 - share_at_silt) / (tail_slope * std::log(10.0)) : b;
    return potential + finer_than.front() * (b - fall);
}

CurvePoints with_sieves(const CurvePoints& curve, const LogGrid& grid, VectorView<const double> mass,
                        VectorView<const double> start, const CurvePoints& measured) {
    require_bins(mass.size(), grid.bins(), entry("mass"));
    require_bins(start.size(), grid.bins(), entry("start"));
    if (std::equal(mass.begin(), mass.end(), start.begin())) return measured;
    std::vector<double> edges(static_cast<std::size_t>(grid.bins()) + 1);
    for (std::size_t i = 0; i < edges.size(); ++i) edges[i] = std::exp(grid.edge(static_cast<Index>(i)));
    std::vector<double> below(static_cast<std::size_t>(grid.bins()) + 1, 0.0);  // mass finer than each edge
    std::partial_sum(mass.begin(), mass.end(), below.begin() + 1);
    std::vector<std::pair<double, double>> points;
    for (std::size_t q = 0; q < curve.size.size(); ++q)
        points.emplace_back(curve.size[q], curve.finer_than[q]);
    for (std::size_t q = 0; q < measured.size.size(); ++q) {
        const double sieve = measured.size[q];
        const Index bin = std::lower_bound(edges.begin(), edges.end(), sieve) - edges.begin() - 1;
        if (bin <= 0 || bin >= grid.bins() || sieve >= curve.size.back()) continue;
        const double low = edges[static_cast<std::size_t>(bin)];
        const double had = start[bin];
        const double has = mass[bin];
        const double share = had > 0.0 ? (measured.finer_than[q] - measured.finer(low)) / had : 0.0;
        const double even = std::log(sieve / low) / grid.spacing();
        const double here =
            std::min(had, has) * std::clamp(share, 0.0, 1.0) + std::max(has - had, 0.0) * even;
        points.emplace_back(sieve, below[static_cast<std::size_t>(bin)] + here);
    }
    std::stable_sort(points.begin(), points.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    CurvePoints bent;
    bent.tail_slope = curve.tail_slope;
    double finer = 0.0;
    for (const auto& [at, share] : points) {
        finer = std::max(finer, share);
        bent.size.push_back(at);
        bent.finer_than.push_back(finer);
    }
    return bent;
}

}  // namespace comminute
