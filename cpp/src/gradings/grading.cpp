// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/grading.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/normal.hpp"
#include "comminute/criterion.hpp"
#include "comminute/error.hpp"

namespace comminute {

using namespace detail;

namespace {

void require_size(const char* parameter, double value) {
    require(value > 0.0 && std::isfinite(value), parameter, value, "greater than 0 and finite");
}

// x -> (e^{a x} - 1) / (e^{a} - 1) without cancellation, x in [0, 1]; a = 0 gives x.
double exponential_ramp(double a, double x) {
    if (std::abs(a) < 1e-12) return x;
    // for a > 0 both terms are written with decaying exponentials, which cannot overflow
    return a > 0.0 ? std::exp(a * (x - 1.0)) * std::expm1(-a * x) / std::expm1(-a)
                   : std::expm1(a * x) / std::expm1(a);
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

double PointMasses::finer(double size_at) const {
    double sum = 0.0;
    for (std::size_t q = 0; q < size.size() && size[q] <= size_at; ++q) sum += share[q];
    return size_at >= size.back() ? 1.0 : sum;
}

double PowerLawGrading::finer(double size_at) const {
    if (size_at <= smallest) return 0.0;
    if (size_at >= largest) return 1.0;
    if (smallest == 0.0) return std::pow(size_at / largest, 3.0 - fractal_dimension);
    const double range = std::log(largest / smallest);
    return exponential_ramp((3.0 - fractal_dimension) * range, std::log(size_at / smallest) / range);
}

double LogNormalGrading::finer(double size_at) const {
    if (size_at >= largest) return 1.0;
    return normal_cdf(std::log(size_at / median) / sd_log) / normal_cdf(std::log(largest / median) / sd_log);
}

double RosinRammlerGrading::finer(double size_at) const {
    if (size_at >= largest) return 1.0;
    return std::expm1(-std::pow(size_at / d63, exponent)) / std::expm1(-std::pow(largest / d63, exponent));
}

double SieveCurve::finer(double size_at) const {
    if (size_at >= size.back()) return 1.0;
    if (size_at < size.front()) {
        return finer_than.front() > 0.0 ? finer_than.front() * std::pow(size_at / size.front(), tail_slope)
                                        : 0.0;
    }
    const auto above =
        static_cast<std::size_t>(std::upper_bound(size.begin(), size.end(), size_at) - size.begin());
    const double fraction = std::log(size_at / size[above - 1]) / std::log(size[above] / size[above - 1]);
    return finer_than[above - 1] + fraction * (finer_than[above] - finer_than[above - 1]);
}

double Grading::finer(double size) const {
    require(size > 0.0, "size", size, "greater than 0");
    return std::visit([size](const auto& l) { return l.finer(size); }, law);
}

double Grading::largest() const {
    return std::visit([](const auto& l) { return l.largest_size(); }, law);
}

double Grading::smallest(double tail) const {
    require(tail >= 0.0 && tail < 1.0, "tail", tail, "at least 0 and less than 1");
    const double smallest_size = std::visit([](const auto& l) { return l.smallest_size(); }, law);
    if (finer(largest()) <= tail || tail == 0.0 || finer(std::max(smallest_size, 1e-300)) > tail)
        return smallest_size;
    // bisection in ln s; a tail that runs on for ever is bracketed by ever smaller sizes
    double high = std::log(largest());
    double low = smallest_size > 0.0 ? std::log(smallest_size) : high - 1.0;
    const double least = std::log(std::numeric_limits<double>::min());
    while (finer(std::exp(low)) > tail) {
        if (low == least) return 0.0;  // that size is smaller than any number
        low = std::max(low - 2.0 * (high - low), least);
    }
    for (int halving = 0; halving < 60; ++halving) {
        const double middle = 0.5 * (low + high);
        (finer(std::exp(middle)) <= tail ? low : high) = middle;
    }
    return std::exp(high);
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
    std::vector<double> pmf(static_cast<std::size_t>(grid.bins()), 0.0);
    if (const auto* points = std::get_if<PointMasses>(&law)) {
        for (std::size_t q = 0; q < points->size.size(); ++q) {
            pmf[static_cast<std::size_t>(grid.bin_of(std::log(points->size[q])))] += points->share[q];
        }
        return pmf;
    }
    double below = 0.0;
    for (Index i = 0; i < grid.bins(); ++i) {
        const double finer_than = i == grid.bins() - 1 ? 1.0 : finer(std::exp(grid.edge(i + 1)));
        pmf[static_cast<std::size_t>(i)] = finer_than - below;
        below = finer_than;
    }
    return pmf;
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
    if (sizes == nullptr || points == PointHandling::binned) return mixed_fabric(grid, std::move(pmf), mean);
    std::vector<PointMass> exact;
    for (std::size_t q = 0; q < sizes->size.size(); ++q) {
        exact.push_back({std::min(std::log(sizes->size[q]), grid.edge(grid.bins())), sizes->share[q]});
    }
    std::fill(pmf.begin(), pmf.end(), 0.0);
    return mixed_fabric(grid, std::move(pmf), mean, std::move(exact));
}

}  // namespace comminute
