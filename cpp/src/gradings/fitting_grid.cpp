// SPDX-License-Identifier: BSD-3-Clause
#include "gradings/fitting_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "comminute/error.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr Index most_bins = 4000;         // of a grid that nobody asked for: its state takes 128 MB
constexpr Index most_bins_given = 10000;  // of one whose ends are given: 800 MB
constexpr double negligible = 1e-3;       // share of the grains that may start in the fines bin
constexpr double deepest = 25.0;          // below the top, for a tail that hardly falls

/// Log size below which 1 % of the fragments lie of the smallest grain that the load crushes; inf if none below `top`.
double finest_fragment(const Material& material, double top, double max_stress_ratio) {
    const double crushable = std::log(material.reference_size) -
                             material.weibull_modulus / 3.0 * std::log(std::max(max_stress_ratio, 1e-300));
    if (crushable >= top) return std::numeric_limits<double>::infinity();
    const auto finer = [&](double r) {
        return std::visit([r](const auto& law) { return law.cdf(r); }, material.fragments);
    };
    double reach = 0.0;
    while (finer(-reach) > 1e-2 && reach < 20.0) reach += 0.25;
    const double band = std::min(0.25 * material.k(), 1.0);  // the zone's lowest point below its tip
    return crushable - band - reach;
}

LogGrid free_grid(const SizeRange& sizes, const Material& material, double max_stress_ratio, double spacing) {
    require_stress_ratio(max_stress_ratio);
    require(max_stress_ratio < 1e300, "max_stress_ratio", max_stress_ratio,
            "finite; with no bound on the load a grid must be given");
    require(spacing > 0.0 && std::isfinite(spacing), "spacing", spacing, "greater than 0 and finite");

    const double top = sizes.top;
    const double bottom = std::min({sizes.finest, finest_fragment(material, top + spacing, max_stress_ratio),
                                    top - 8.0 * spacing}) -
                          8.0 * spacing;
    const double narrowest = (top - bottom) / static_cast<double>(most_bins - 1);
    double h = std::max(spacing, narrowest);
    if (sizes.jump > 0.0)
        h = sizes.jump /
            std::max(1.0, std::min(std::ceil(sizes.jump / h), std::floor(sizes.jump / narrowest)));
    const auto* points = sizes.points;
    if (points != nullptr && points->size.size() > 1) {
        const double gap = top - std::log(points->size[points->size.size() - 2]);
        // sizes that differ by less than a bin of the largest grid share one
        const double fitted = gap / std::ceil(gap / h);
        if ((top - bottom) / fitted < static_cast<double>(most_bins)) h = fitted;
    }
    // a point mass lies on the last centre, a spread grading ends at the last edge
    const double psi_max = points != nullptr ? top : top - 0.5 * h;
    const auto below_top = static_cast<Index>(std::ceil((psi_max - bottom) / h));
    return {psi_max - static_cast<double>(below_top) * h, psi_max, below_top + 1};
}

/// Range that holds the middle 68 % of a law, which is two standard deviations of a normal one.
template <class Quantile>
double middle(const Quantile& quantile) {
    return quantile(0.84) - quantile(0.16);
}

/// Bin width that resolves a grading.
double resolving(const Grading& grading) {
    double needed = std::numeric_limits<double>::infinity();
    if (std::holds_alternative<PointMasses>(grading.law)) return needed;
    needed = middle([&](double share) { return std::log(grading.quantile(share)); }) / 12.0;
    if (const auto* curve = std::get_if<SieveCurve>(&grading.law)) {
        for (std::size_t q = 1; q < curve->size.size(); ++q) {
            if (curve->finer_than[q] - curve->finer_than[q - 1] < 0.2) continue;
            needed = std::min(needed, std::log(curve->size[q] / curve->size[q - 1]) / 10.0);
        }
    }
    return needed;
}

/// Distance in ln s from the largest grain to the place at which the density of a grading jumps most; 0 where it does not
/// jump, or so far down that it matters to no grain above.
double largest_jump(const Grading& grading) {
    double place = 0.0;
    if (const auto* law = std::get_if<PowerLawGrading>(&grading.law); law != nullptr && law->smallest > 0.0)
        place = std::log(law->largest / law->smallest);
    if (const auto* curve = std::get_if<SieveCurve>(&grading.law)) {
        double above = 0.0;
        double most = 0.0;
        for (std::size_t q = curve->size.size() - 1; q > 0; --q) {
            const double length = std::log(curve->size[q] / curve->size[q - 1]);
            const double density = (curve->finer_than[q] - curve->finer_than[q - 1]) / length;
            const double jump = std::abs(density - above);
            if (q + 1 < curve->size.size() && jump > most) {
                most = jump;
                place = std::log(curve->size.back() / curve->size[q]);
            }
            above = density;
        }
        const bool ends = curve->finer_than.front() == 0.0;  // below the finest sieve there is nothing
        if (ends && above > most) place = std::log(curve->size.back() / curve->size.front());
    }
    return place < deepest ? place : 0.0;
}

Index bins_for(double span, double spacing) {
    if (!std::isfinite(span)) return 8;  // LogGrid then says what is wrong with its ends
    return static_cast<Index>(
        std::clamp(std::ceil(span / spacing) + 1.0, 8.0, static_cast<double>(most_bins_given)));
}

/// Spacing no finer than wanted that puts the two coarsest exact sizes on centres, where they are further apart.
double spacing_between(const PointMasses& points, double wanted) {
    if (points.size.size() < 2) return wanted;
    const double gap = std::log(points.size.back() / points.size[points.size.size() - 2]);
    return gap / std::max(1.0, std::floor(gap / wanted));
}

/// Grid of which bins or ends are given, and the rest taken from the one that fits freely.
LogGrid completed(const LogGrid& fitted, const SizeRange& sizes, const GridOptions& given) {
    const double low = given.psi_min.value_or(fitted.psi_min());
    if (given.psi_max) {
        const Index bins = given.bins.value_or(bins_for(*given.psi_max - low, fitted.spacing()));
        return {low, *given.psi_max, bins};
    }
    const double top = sizes.top;
    const Index bins = given.bins.value_or(bins_for(top - low, fitted.spacing()));
    if (!(low < top)) return {low, top, bins};  // LogGrid says what is wrong with it
    if (sizes.points == nullptr) {
        const double spacing = (top - low) / (static_cast<double>(bins) - 0.5);
        return {low, top - 0.5 * spacing, bins};
    }
    if (given.psi_min) return {low, top, bins};
    const auto intervals = static_cast<double>(bins - 1);
    return {top - intervals * spacing_between(*sizes.points, (top - low) / intervals), top, bins};
}

}  // namespace

double needed_spacing(const Material& material) {
    return middle([&](double share) {
               return std::visit([share](const auto& law) { return law.quantile(share); },
                                 material.fragments);
           }) /
           22.0;
}

double needed_spacing(const Grading& grading, const Material& material) {
    return std::min(resolving(grading), needed_spacing(material));
}

SizeRange detail::spread_between(double smallest, double largest) {
    const double top = std::log(largest);
    const double bottom = std::log(smallest);
    return {top, std::max(bottom + negligible * (top - bottom), top - deepest), nullptr};
}

LogGrid detail::grid_over(const SizeRange& sizes, const Material& material, double max_stress_ratio,
                          const GridOptions& options) {
    material.validate();
    if (options.bins) require(*options.bins >= 8, "bins", static_cast<double>(*options.bins), "at least 8");
    if (options.bins && options.psi_min && options.psi_max)
        return {*options.psi_min, *options.psi_max, *options.bins};
    const double spacing = options.spacing.value_or(std::min(usual_spacing, sizes.needed));
    const LogGrid fitted = free_grid(sizes, material, max_stress_ratio, spacing);
    if (!options.bins && !options.psi_min && !options.psi_max) return fitted;
    return completed(fitted, sizes, options);
}

LogGrid fitting_grid(const Grading& grading, const Material& material, double max_stress_ratio,
                     const GridOptions& options) {
    const double top = std::log(grading.largest());
    const double finest =
        std::log(std::max(grading.smallest(negligible), grading.largest() * std::exp(-deepest)));
    const SizeRange sizes{top, finest, std::get_if<PointMasses>(&grading.law), largest_jump(grading),
                          needed_spacing(grading, material)};
    return grid_over(sizes, material, max_stress_ratio, options);
}

LogGrid fitting_grid(const Grading& grading, const Material& material, double max_stress_ratio,
                     double spacing) {
    GridOptions options;
    options.spacing = spacing;
    return fitting_grid(grading, material, max_stress_ratio, options);
}

}  // namespace comminute
