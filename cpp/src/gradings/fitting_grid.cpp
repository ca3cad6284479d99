// SPDX-License-Identifier: BSD-3-Clause
#include "gradings/fitting_grid.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "comminute/error.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr Index most_bins = 2000;         // of a grid that nobody asked for: its state takes 32 MB
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
    double h = std::max(spacing, (top - bottom) / static_cast<double>(most_bins - 1));
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
    const LogGrid fitted = free_grid(sizes, material, max_stress_ratio, options.spacing);
    if (!options.bins && !options.psi_min && !options.psi_max) return fitted;
    return completed(fitted, sizes, options);
}

LogGrid fitting_grid(const Grading& grading, const Material& material, double max_stress_ratio,
                     const GridOptions& options) {
    const double top = std::log(grading.largest());
    const double finest =
        std::log(std::max(grading.smallest(negligible), grading.largest() * std::exp(-deepest)));
    return grid_over({top, finest, std::get_if<PointMasses>(&grading.law)}, material, max_stress_ratio,
                     options);
}

LogGrid fitting_grid(const Grading& grading, const Material& material, double max_stress_ratio,
                     double spacing) {
    GridOptions options;
    options.spacing = spacing;
    return fitting_grid(grading, material, max_stress_ratio, options);
}

}  // namespace comminute
