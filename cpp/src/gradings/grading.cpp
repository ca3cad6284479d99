// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/grading.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/arrays.hpp"
#include "comminute/criterion.hpp"
#include "comminute/error.hpp"

namespace comminute {

using namespace detail;

namespace {

void require_size(const char* parameter, double value) {
    require(value > 0.0 && std::isfinite(value), parameter, value, "greater than 0 and finite");
}

void require_ordered(double smallest, double largest) {
    if (smallest < largest) return;
    throw ParameterError({.parameter = "smallest",
                          .value = text(smallest),
                          .number = smallest,
                          .finding = "is " + text(smallest) + " and largest is " + text(largest),
                          .rule = "smallest must be less than largest"});
}

}  // namespace

double Grading::finer(double size) const {
    require(size > 0.0, "size", size, "greater than 0");
    return std::visit([size](const auto& l) { return l.finer(size); }, law);
}

double Grading::largest() const {
    return std::visit([](const auto& l) { return l.largest_size(); }, law);
}

double Grading::quantile(double share) const {
    require(share > 0.0 && share <= 1.0, "share", share, "greater than 0 and at most 1");
    return std::visit([share](const auto& l) { return l.quantile(share); }, law);
}

double Grading::smallest(double tail) const {
    require(tail >= 0.0 && tail < 1.0, "tail", tail, "at least 0 and less than 1");
    if (tail == 0.0) return std::visit([](const auto& l) { return l.smallest_size(); }, law);
    return quantile(tail);
}

std::vector<double> Grading::on_grid(const LogGrid& grid) const {
    const double top = std::log(largest());
    const double edge = grid.edge(grid.bins());
    if (top > edge + 1e-12 * std::max(1.0, std::abs(edge))) {
        throw ParameterError({.parameter = "largest",
                              .value = text(largest()),
                              .number = largest(),
                              .subject = "the largest grain, " + text(largest()) + ",",
                              .finding = "lies above the grid's top edge, " + text(std::exp(edge)),
                              .remedy = Remedy::size_grid_automatically});
    }
    Array<double> pmf(grid.bins());
    if (const auto* points = std::get_if<PointMasses>(&law)) {
        for (std::size_t q = 0; q < points->size.size(); ++q) {
            pmf[grid.bin_of(std::log(points->size[q]))] += points->share[q];
        }
        return std::move(pmf).vector();
    }
    double below = 0.0;
    for (Index i = 0; i < grid.bins(); ++i) {
        const double finer_than = i == grid.bins() - 1 ? 1.0 : finer(std::exp(grid.edge(i + 1)));
        pmf[i] = finer_than - below;
        below = finer_than;
    }
    return std::move(pmf).vector();
}

Grading monodisperse(double size) {
    require_size("size", size);
    return {PointMasses{{size}, {1.0}}, "", {}};
}

Grading gap_graded(double coarse, double fine, double coarse_share) {
    require_size("coarse", coarse);
    require_size("fine", fine);
    require(coarse_share >= 0.0 && coarse_share <= 1.0, "coarse_share", coarse_share, "between 0 and 1");
    if (!(fine < coarse)) {
        throw ParameterError({.parameter = "fine",
                              .value = text(fine),
                              .number = fine,
                              .finding = "is " + text(fine) + " and coarse is " + text(coarse),
                              .rule = "fine must be less than coarse"});
    }
    if (coarse_share == 0.0) return monodisperse(fine);
    if (coarse_share == 1.0) return monodisperse(coarse);
    return {PointMasses{{fine, coarse}, {1.0 - coarse_share, coarse_share}}, "", {}};
}

Grading power_law(double fractal_dimension, double smallest, double largest) {
    require(std::isfinite(fractal_dimension), "fractal_dimension", fractal_dimension, "finite");
    require(fractal_dimension < 3.0 ? smallest >= 0.0 : smallest > 0.0, "smallest", smallest,
            "greater than 0 (or 0, for a fractal dimension below 3)");
    require_size("largest", largest);
    require_ordered(smallest, largest);
    return {PowerLawGrading{fractal_dimension, smallest, largest}, "", {}};
}

Grading uniform_size(double smallest, double largest) {
    return power_law(2.0, smallest, largest);
}

Grading log_uniform(double smallest, double largest) {
    return power_law(3.0, smallest, largest);
}

Grading fuller(double largest, double exponent) {
    require(exponent > 0.0 && std::isfinite(exponent), "exponent", exponent, "greater than 0 and finite");
    return power_law(3.0 - exponent, 0.0, largest);
}

Grading lognormal(double median, double sd_log, std::optional<double> largest) {
    require_size("median", median);
    require(sd_log > 0.0 && std::isfinite(sd_log), "sd_log", sd_log, "greater than 0 and finite");
    std::vector<std::string> notes;
    if (!largest) {
        largest = median * std::exp(4.0 * sd_log);
        notes.push_back("the lognormal law is cut off 4 standard deviations above its median, at " +
                        text(*largest));
    }
    require_size("largest", *largest);
    require(std::log(*largest / median) > -30.0 * sd_log, "largest", *largest,
            "within 30 standard deviations below the median");
    return {LogNormalGrading{median, sd_log, *largest}, "", std::move(notes)};
}

Grading rosin_rammler(double d63, double exponent, std::optional<double> largest) {
    require_size("d63", d63);
    require(exponent > 0.0 && std::isfinite(exponent), "exponent", exponent, "greater than 0 and finite");
    std::vector<std::string> notes;
    if (!largest) {
        largest = d63 * std::pow(-std::log(1e-4), 1.0 / exponent);
        notes.push_back("the Rosin-Rammler law is cut off where 0.01 % would be coarser, at " +
                        text(*largest));
    }
    require_size("largest", *largest);
    return {RosinRammlerGrading{d63, exponent, *largest}, "", std::move(notes)};
}

Fabric mixed_fabric(const Grading& grading, const LogGrid& grid, Mean mean, PointHandling points) {
    std::vector<double> pmf = grading.on_grid(grid);
    const auto* sizes = std::get_if<PointMasses>(&grading.law);
    if (sizes == nullptr || points == PointHandling::binned)
        return mixed_fabric(grid, std::move(pmf), mean, {}, sizes == nullptr ? grading.largest() : 0.0);
    std::vector<PointMass> exact;
    for (std::size_t q = 0; q < sizes->size.size(); ++q) {
        const double psi = std::min(std::log(sizes->size[q]), grid.edge(grid.bins()));
        exact.push_back({psi, sizes->share[q], sizes->size[q]});
    }
    std::fill(pmf.begin(), pmf.end(), 0.0);
    return mixed_fabric(grid, std::move(pmf), mean, std::move(exact), grading.largest());
}

}  // namespace comminute
