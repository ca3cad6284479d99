// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "base/point_curve.hpp"
#include "comminute/grading.hpp"
#include "fabric/fabric_access.hpp"

namespace comminute {

using namespace detail;

namespace {

void require_rising(VectorView<const double> cdf) {
    for (Index i = 0; i < cdf.size(); ++i) {
        const double before = i > 0 ? cdf[i - 1] : 0.0;
        if (cdf[i] >= before - share_rounding && std::isfinite(cdf[i])) continue;
        throw ParameterError({.parameter = "cdf",
                              .value = text(cdf[i]),
                              .number = cdf[i],
                              .finding = "is " + text(cdf[i]) + " after " + text(before),
                              .rule = "a cdf is 0 or more and never falls",
                              .place = {entry("cdf", {i})},
                              .remedy = Remedy::cumulate_masses});
    }
}

/// The fault of a percentile that a curve does not reach.
Fault percentile_fault(double percent, std::string finding, Remedy remedy) {
    return {.parameter = "percent",
            .value = text(percent),
            .number = percent,
            .subject = "D" + text(percent),
            .finding = std::move(finding),
            .remedy = remedy};
}

double tail_slope(const LogGrid& grid, VectorView<const double> cdf) {
    const double slope = std::log(cdf[1] / cdf[0]) / grid.spacing();
    return std::isfinite(slope) ? slope : 0.0;
}

}  // namespace

CurvePoints curve_on_grid(const LogGrid& grid, VectorView<const double> cdf,
                          const std::vector<PointMass>& points, double largest) {
    require_bins(cdf.size(), grid.bins(), entry("cdf"));
    require_rising(cdf);
    require(largest >= 0.0 && std::isfinite(largest), "largest", largest,
            "a size, or 0 where it is not known");
    CurvePoints curve;
    curve.tail_slope = tail_slope(grid, cdf);
    const auto add = [&curve](double size, double finer) {
        if (!curve.finer_than.empty()) finer = std::max(finer, curve.finer_than.back());
        curve.size.push_back(size);
        curve.finer_than.push_back(finer);
    };
    const double whole = cdf[cdf.size() - 1] - share_rounding;
    const double top = largest > 0.0 ? std::log(largest) : 0.0;
    const double rounding = 1e-9 * grid.spacing();  // in which a size lies on an edge
    Array<double> in_bins(grid.bins());             // mass at no exact size
    for (Index i = 0; i < grid.bins(); ++i) in_bins[i] = cdf[i] - (i > 0 ? cdf[i - 1] : 0.0);
    for (const PointMass& exact : points) in_bins[grid.bin_of(exact.psi)] -= exact.mass;
    auto point = points.begin();
    for (Index i = 0; i < grid.bins(); ++i) {
        const double low = grid.edge(i);
        const double edge = grid.edge(i + 1);
        // grains of the coarsest bin are spread up to the largest of them, not to the bin's edge
        const bool ends_inside =
            largest > 0.0 && cdf[i] >= whole && top > low + rounding && top <= edge + rounding;
        const double high = ends_inside ? std::min(top, edge) : edge;
        const double before = i > 0 ? cdf[i - 1] : 0.0;
        const double spread = in_bins[i];
        const auto first = point;
        while (point != points.end() && grid.bin_of(point->psi) == i) ++point;
        double exact = 0.0;  // mass of the finer exact sizes in the bin
        for (auto jump = first; jump != point; ++jump) {
            const double even = spread * std::min((jump->psi - low) / (high - low), 1.0);
            const bool alone = point - first == 1;
            const double below =
                before + exact +
                (alone ? std::max(even, spread - mass_above(grid, {in_bins.data(), grid.bins()}, jump->psi))
                       : even);
            exact += jump->mass;
            add(jump->size, below);
            add(jump->size, below + jump->mass);
            if (curve.finer_than.back() >= whole) return curve;
        }
        add(ends_inside ? largest : std::exp(edge), cdf[i]);
        if (cdf[i] >= whole) return curve;
    }
    return curve;
}

double Grading::percentile(double percent, bool extrapolate) const {
    require(percent >= 0.0 && percent <= 100.0, "percent", percent, "between 0 and 100");
    if (percent == 0.0) return smallest();
    const double share = percent / 100.0;
    const auto* curve = std::get_if<SieveCurve>(&law);
    if (curve != nullptr && share < curve->finer_than.front() - share_rounding && !extrapolate) {
        const std::string sieve = text(curve->size.front()) + (unit.empty() ? "" : " " + unit);
        throw ParameterError(percentile_fault(percent,
                                              "lies below the finest sieve, " + sieve + ", which " +
                                                  rounded(100.0 * curve->finer_than.front()) +
                                                  " % are finer than",
                                              Remedy::extrapolate));
    }
    return quantile(share);
}

CurvePoints Grading::points(Index count) const {
    require(count >= 2, "count", static_cast<double>(count), "at least 2");
    if (const auto* curve = std::get_if<SieveCurve>(&law))
        return {curve->size, curve->finer_than, curve->tail_slope};
    CurvePoints out;
    const auto add = [&out](double size, double finer_than) {
        out.size.push_back(size);
        out.finer_than.push_back(finer_than);
    };
    if (const auto* grains = std::get_if<PointMasses>(&law)) {
        double below = 0.0;
        for (std::size_t q = 0; q < grains->size.size(); ++q) {
            add(grains->size[q], below);
            below = grains->finer(grains->size[q]);
            add(grains->size[q], below);
        }
        return out;
    }
    const double finest = smallest() > 0.0 ? smallest() : percentile(1e-7);
    const double step = std::log(largest() / finest) / static_cast<double>(count - 1);
    for (Index q = 0; q + 1 < count; ++q) {
        const double size = finest * std::exp(step * static_cast<double>(q));
        add(size, finer(size));
    }
    add(largest(), 1.0);
    if (out.finer_than[0] > 0.0) out.tail_slope = std::log(out.finer_than[1] / out.finer_than[0]) / step;
    return out;
}

double percentile(const LogGrid& grid, VectorView<const double> cdf, double percent, bool extrapolate,
                  const std::vector<PointMass>& points, double largest) {
    require(percent >= 0.0 && percent <= 100.0, "percent", percent, "between 0 and 100");
    require_bins(cdf.size(), grid.bins(), entry("cdf"));
    require_rising(cdf);
    const double finer = percent / 100.0;
    const auto* bin =
        std::find_if(cdf.begin(), cdf.end(), [&](double f) { return f >= finer - share_rounding; });
    if (bin == cdf.end()) {
        const std::string all = rounded(100.0 * cdf[cdf.size() - 1]);
        throw ParameterError(percentile_fault(
            percent, "lies above the largest size: only " + all + " % are finer", Remedy::none));
    }
    if (bin == cdf.begin()) {
        const CurvePoints curve = curve_on_grid(grid, cdf, points, largest);
        if (extrapolate && finer > 0.0 && curve.tail_slope > 0.0) return curve.quantile(finer);
        throw ParameterError(percentile_fault(percent,
                                              "lies in the fines bin, which holds " +
                                                  rounded(100.0 * cdf[0]) + " % below a size of " +
                                                  rounded(std::exp(grid.edge(1))),
                                              extrapolate ? Remedy::lower_psi_min : Remedy::resolve_fines));
    }
    return curve_on_grid(grid, cdf, points, largest).quantile(finer);
}

}  // namespace comminute
