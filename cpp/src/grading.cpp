// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/grading.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "comminute/criterion.hpp"
#include "comminute/error.hpp"

namespace comminute {
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

// The size below which `tail` of the mass lies, by bisection in ln s between two sizes that bracket it.
double size_at(const Grading& grading, double tail, double lower, double upper) {
    double low = std::log(lower);
    double high = std::log(upper);
    for (int halving = 0; halving < 60; ++halving) {
        const double middle = 0.5 * (low + high);
        (grading.finer(std::exp(middle)) < tail ? low : high) = middle;
    }
    return std::exp(high);
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
    const double range = std::log(largest / smallest);
    return exponential_ramp((3.0 - fractal_dimension) * range, std::log(size_at / smallest) / range);
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
    if (const auto* points = std::get_if<PointMasses>(&law)) return points->size.back();
    if (const auto* power = std::get_if<PowerLawGrading>(&law)) return power->largest;
    return std::get<SieveCurve>(law).size.back();
}

double Grading::smallest(double tail) const {
    require(tail >= 0.0 && tail < 1.0, "tail", tail, "at least 0 and less than 1");
    if (const auto* points = std::get_if<PointMasses>(&law)) {
        for (const double size : points->size) {
            if (finer(size) > tail) return size;
        }
        return points->size.back();
    }
    if (const auto* power = std::get_if<PowerLawGrading>(&law)) {
        return tail == 0.0 ? power->smallest : size_at(*this, tail, power->smallest, power->largest);
    }
    const auto& curve = std::get<SieveCurve>(law);
    const double finest = curve.finer_than.front();
    if (tail < finest) {
        return tail == 0.0 ? 0.0 : curve.size.front() * std::pow(tail / finest, 1.0 / curve.tail_slope);
    }
    return size_at(*this, tail, curve.size.front(), curve.size.back());
}

std::vector<double> Grading::on_grid(const LogGrid& grid) const {
    const double top = std::log(largest());
    const double edge = grid.edge(grid.bins());
    if (top > edge + 1e-12 * std::max(1.0, std::abs(edge))) {
        throw ParameterError("the largest grain, " + text(largest()) + ", lies above the grid's top edge, " +
                             text(std::exp(edge)) +
                             "; raise psi_max, or leave the grid out to have it sized from the grading");
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
        throw ParameterError("fine is " + text(fine) + " and coarse is " + text(coarse) +
                             "; fine must be less than coarse");
    }
    if (coarse_share == 0.0) return monodisperse(fine);
    if (coarse_share == 1.0) return monodisperse(coarse);
    return {PointMasses{{fine, coarse}, {1.0 - coarse_share, coarse_share}}, "", {}};
}

Grading power_law(double fractal_dimension, double smallest, double largest) {
    require(std::isfinite(fractal_dimension), "fractal_dimension", fractal_dimension, "finite");
    require_size("smallest", smallest);
    require_size("largest", largest);
    if (!(smallest < largest)) {
        throw ParameterError("smallest is " + text(smallest) + " and largest is " + text(largest) +
                             "; smallest must be less than largest");
    }
    return {PowerLawGrading{fractal_dimension, smallest, largest}, "", {}};
}

Fabric mixed_fabric(const Grading& grading, const LogGrid& grid, Mean mean) {
    return mixed_fabric(grid, grading.on_grid(grid), mean);
}

LogGrid fitting_grid(const Grading& grading, const Material& material, double max_stress_ratio,
                     double spacing) {
    material.validate();
    require_stress_ratio(max_stress_ratio);
    require(max_stress_ratio < 1e300, "max_stress_ratio", max_stress_ratio,
            "finite; with no bound on the load a grid must be given");
    require(spacing > 0.0 && std::isfinite(spacing), "spacing", spacing, "greater than 0 and finite");

    constexpr double finest_grains = 1e-3;  // shares that may fall below the grid
    constexpr double finest_fragments = 1e-2;
    const double top = std::log(grading.largest());
    double bottom = std::log(grading.smallest(finest_grains));
    const double strength = 3.0 / material.weibull_modulus;
    const double crushable =
        std::log(material.reference_size) - std::log(std::max(max_stress_ratio, 1e-300)) / strength;
    if (crushable < top + spacing) {
        double reach = 0.0;  // of the fragments of the smallest grain that crushes
        const auto finer = [&](double r) {
            return std::visit([r](const auto& law) { return law.cdf(r); }, material.fragments);
        };
        while (finer(-reach) > finest_fragments && reach < 20.0) reach += 0.25;
        const double band = std::min(0.25 * material.k(), 1.0);  // the zone's lowest point below its tip
        bottom = std::min(bottom, crushable - band - reach);
    }
    bottom = std::min(bottom - 8.0 * spacing, top - 16.0 * spacing);

    double h = spacing;
    double psi_max = top;
    if (const auto* points = std::get_if<PointMasses>(&grading.law)) {
        if (points->size.size() > 1) {
            const double gap = top - std::log(points->size[points->size.size() - 2]);
            h = gap / std::ceil(gap / spacing);
        }
    } else {
        psi_max = top - 0.5 * h;  // the top edge at the largest grain
    }
    const auto below_top = static_cast<Index>(std::ceil((psi_max - bottom) / h));
    return {psi_max - static_cast<double>(below_top) * h, psi_max, below_top + 1};
}

double percentile(const LogGrid& grid, VectorView<const double> cdf, double percent, bool extrapolate) {
    require(percent >= 0.0 && percent <= 100.0, "percent", percent, "between 0 and 100");
    if (cdf.size() != grid.bins()) {
        throw ShapeError("cdf has " + std::to_string(cdf.size()) + " entries; the grid has " +
                         std::to_string(grid.bins()) + " bins");
    }
    constexpr double rounding = 1e-12;  // a cdf is a sum: its plateaus and its 1 are good to this
    const double finer = percent / 100.0;
    const std::string name = "D" + text(percent);
    const auto* bin = std::find_if(cdf.begin(), cdf.end(), [&](double f) { return f >= finer - rounding; });
    if (bin == cdf.end()) {
        throw ParameterError(name + " lies above the largest size: only " +
                             text(100.0 * cdf[cdf.size() - 1]) + " % are finer");
    }
    const auto i = bin - cdf.begin();
    if (i == 0) {
        const double slope = std::log(cdf[1] / cdf[0]) / grid.spacing();
        if (extrapolate && finer > 0.0 && slope > 0.0) {
            return std::exp(grid.edge(1) + std::log(finer / cdf[0]) / slope);
        }
        throw ParameterError(name + " lies in the fines bin, which holds " + text(100.0 * cdf[0]) +
                             " % below a size of " + text(std::exp(grid.edge(1))) +
                             "; lower psi_min to resolve it, or pass extrapolate = true");
    }
    const double below = cdf[i - 1];
    const double fraction = *bin > below ? std::clamp((finer - below) / (*bin - below), 0.0, 1.0) : 1.0;
    return std::exp(grid.edge(i) + fraction * grid.spacing());
}

}  // namespace comminute
