// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <utility>

#include "base/check.hpp"
#include "base/workers.hpp"
#include "comminute/lattice.hpp"
#include "gradings/fitting_grid.hpp"
#include "lattice/ring_criterion.hpp"

namespace comminute {

using namespace detail;

namespace {

LatticeEstimate estimate(const std::vector<std::vector<double>>& samples) {
    const auto count = static_cast<double>(samples.size());
    const std::size_t bins = samples.front().size();
    LatticeEstimate result{std::vector<double>(bins, 0.0), std::vector<double>(bins, 0.0)};
    for (std::size_t i = 0; i < bins; ++i) {
        double sum = 0.0;
        for (const auto& sample : samples) sum += sample[i];
        result.mean[i] = sum / count;
        double square = 0.0;
        for (const auto& sample : samples)
            square += (sample[i] - result.mean[i]) * (sample[i] - result.mean[i]);
        // 0 / 0 with a single replica: NaN, an error that is not known
        result.standard_error[i] = std::sqrt(square / (count - 1.0) / count);
    }
    return result;
}

}  // namespace

void LatticeState::psi(Index replica, VectorView<double> out) const {
    const auto& cells = rings_[checked(replica)].cells;
    const auto length = static_cast<Index>(cells.size());
    require_entries(out.size(), length, entry("out"), "the ring has " + std::to_string(length) + " cells");
    const double origin = std::log(material_.reference_size);
    std::transform(cells.begin(), cells.end(), out.begin(),
                   [&](const LatticeCell& c) { return c.psi + origin; });
}

VectorView<const std::uint32_t> LatticeState::crushes(Index replica) const {
    return rings_[checked(replica)].crushes;
}

std::size_t LatticeState::checked(Index replica) const {
    require(replica >= 0 && replica < replicas(), "replica", static_cast<double>(replica),
            "the index of a replica, 0 to replicas - 1");
    return static_cast<std::size_t>(replica);
}

std::vector<double> LatticeState::mean_crushes() const {
    std::vector<double> means;
    for (const auto& ring : rings_) {
        const auto total = std::accumulate(ring.crushes.begin(), ring.crushes.end(), std::uint64_t{0});
        means.push_back(static_cast<double>(total) / static_cast<double>(cells()));
    }
    return means;
}

std::vector<std::vector<double>> LatticeState::grainsizes(const LogGrid& grid) const {
    std::vector<std::vector<double>> pmf(rings_.size());
    const double origin = std::log(material_.reference_size);
    const auto work = [&](std::size_t r, const auto&) {
        std::vector<std::uint64_t> count(static_cast<std::size_t>(grid.bins()), 0);
        for (const auto& cell : rings_[r].cells)
            ++count[static_cast<std::size_t>(grid.bin_of(cell.psi + origin))];
        for (const auto n : count) pmf[r].push_back(static_cast<double>(n) / static_cast<double>(cells()));
    };
    for_each_index(rings_.size(), static_cast<std::size_t>(options_.threads), work, {});
    return pmf;
}

LatticeEstimate LatticeState::cdf(const LogGrid& grid) const {
    auto pmf = grainsizes(grid);
    for (auto& row : pmf) std::partial_sum(row.begin(), row.end(), row.begin());
    return estimate(pmf);
}

Fabric LatticeState::fabric(const LogGrid& grid) const {
    const auto bins = static_cast<std::size_t>(grid.bins());
    std::vector<double> p(bins * bins, 0.0);
    const double origin = std::log(material_.reference_size);
    const auto bin = [&](double psi) { return static_cast<std::size_t>(grid.bin_of(psi + origin)); };
    for (const auto& ring : rings_) {
        const std::size_t count = ring.cells.size();
        for (std::size_t c = 0; c < count; ++c) {
            const auto& left = ring.cells[c == 0 ? count - 1 : c - 1];
            const auto& right = ring.cells[c + 1 == count ? 0 : c + 1];
            p[bin(ring.cells[c].psi) * bins + bin(neighbourhood(left, right, options_.mean))] += 1.0;
        }
    }
    const double share = 1.0 / (static_cast<double>(cells()) * static_cast<double>(replicas()));
    for (double& mass : p) mass *= share;
    return {grid, std::move(p), {}, settled_at(), options_.mean, {}, largest_};
}

std::vector<PointMass> LatticeState::points() const {
    std::vector<std::uint64_t> count(exact_.size(), 0);
    for (const auto& ring : rings_) {
        for (std::size_t c = 0; !exact_.empty() && c < ring.cells.size(); ++c) {
            if (ring.crushes[c] > 0) continue;
            for (std::size_t q = 0; q < exact_.size(); ++q) count[q] += exact_[q].psi == ring.cells[c].psi;
        }
    }
    const double share = 1.0 / (static_cast<double>(cells()) * static_cast<double>(replicas()));
    std::vector<PointMass> left;
    for (std::size_t q = 0; q < exact_.size(); ++q) {
        if (count[q] == 0) continue;
        // the log of the size as its bin was found
        const double psi = exact_[q].psi + std::log(material_.reference_size);
        left.push_back({psi, share * static_cast<double>(count[q]), exact_[q].size});
    }
    return left;
}

LogGrid LatticeState::fitting_grid(double max_stress_ratio, const GridOptions& options) const {
    const auto finer = [](const LatticeCell& a, const LatticeCell& b) { return a.psi < b.psi; };
    double finest = std::numeric_limits<double>::infinity();
    double coarsest = -finest;
    for (const auto& ring : rings_) {
        const auto [low, high] = std::minmax_element(ring.cells.begin(), ring.cells.end(), finer);
        finest = std::min(finest, low->psi);
        coarsest = std::max(coarsest, high->psi);
    }
    const double origin = std::log(material_.reference_size);
    const double smallest = std::exp(finest + origin);
    const double largest = std::exp(coarsest + origin);
    const PointMasses one_size{{largest}, {1.0}};
    SizeRange sizes = spread_between(smallest, largest);
    if (smallest == largest) sizes.points = &one_size;
    sizes.needed = needed_spacing(material_);
    return grid_over(sizes, material_, max_stress_ratio, options);
}

}  // namespace comminute
