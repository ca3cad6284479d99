// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "comminute/error.hpp"
#include "comminute/grading.hpp"

namespace comminute {
namespace {

constexpr double rounding = 1e-12;  // a curve is a sum: its plateaus and its 1 are good to this

double first_at_least(const PointMasses& law, double share) {
    double sum = 0.0;
    for (std::size_t q = 0; q + 1 < law.size.size(); ++q) {
        sum += law.share[q];
        if (sum >= share - rounding) return law.size[q];
    }
    return law.size.back();
}

double first_at_least(const SieveCurve& law, double share) {
    const auto above =
        static_cast<std::size_t>(std::find_if(law.finer_than.begin(), law.finer_than.end(),
                                              [share](double finer) { return finer >= share - rounding; }) -
                                 law.finer_than.begin());
    if (above == 0) {
        const double finest = law.finer_than.front();
        return finest > 0.0 ? law.size.front() * std::pow(share / finest, 1.0 / law.tail_slope)
                            : law.size.front();
    }
    const double below = law.finer_than[above - 1];
    const double fraction = std::clamp((share - below) / (law.finer_than[above] - below), 0.0, 1.0);
    return fraction == 1.0 ? law.size[above]
                           : law.size[above - 1] * std::pow(law.size[above] / law.size[above - 1], fraction);
}

double first_at_least(const PowerLawGrading& law, double share) {
    const double power = 3.0 - law.fractal_dimension;
    if (law.smallest == 0.0) return law.largest * std::pow(share, 1.0 / power);
    const double range = std::log(law.largest / law.smallest);
    // F = (e^{a x} - 1) / (e^a - 1), a = power * range, solved for x from whichever end loses no digits
    const double a = power * range;
    if (std::abs(a) < 1e-12) return law.smallest * std::exp(range * share);
    if (a > 0.0) return law.largest * std::exp(std::log(std::exp(-a) - share * std::expm1(-a)) / power);
    return law.smallest * std::exp(std::log1p(share * std::expm1(a)) / power);
}

/// Bisection in ln d for the laws of no closed inverse.
template <class Law>
double first_at_least(const Law& law, double share) {
    if (share >= 1.0) return law.largest;
    double high = std::log(law.largest);
    double low = high - 1.0;
    while (law.finer(std::exp(low)) >= share) low -= 2.0 * (high - low);
    for (int halving = 0; halving < 80; ++halving) {
        const double middle = 0.5 * (low + high);
        (law.finer(std::exp(middle)) >= share ? high : low) = middle;
    }
    return std::exp(high);
}

/// Where in bin i the cdf reaches `finer`: linear between its jumps.
double inside_bin(const LogGrid& grid, Index i, double below, double above, double finer,
                  const std::vector<PointMass>& points) {
    double spread = above - below;
    for (const PointMass& point : points) {
        if (grid.bin_of(point.psi) == i) spread -= point.mass;
    }
    const double slope = std::max(spread, 0.0) / grid.spacing();
    double psi = grid.edge(i);
    double reached = below;
    const auto rise_to = [&](double end) {
        const double risen = slope * (end - psi);
        if (reached + risen >= finer && risen > 0.0) return true;
        reached += risen;
        psi = end;
        return false;
    };
    for (const PointMass& point : points) {
        if (grid.bin_of(point.psi) != i) continue;
        if (rise_to(point.psi)) break;
        reached += point.mass;
        if (reached >= finer - rounding) return point.psi;
    }
    return slope > 0.0 ? std::min(psi + std::max(finer - reached, 0.0) / slope, grid.edge(i + 1))
                       : grid.edge(i + 1);
}

}  // namespace

double Grading::percentile(double percent, bool extrapolate) const {
    require(percent >= 0.0 && percent <= 100.0, "percent", percent, "between 0 and 100");
    if (percent == 0.0) return smallest();
    const double share = percent / 100.0;
    const auto* curve = std::get_if<SieveCurve>(&law);
    if (curve != nullptr && share < curve->finer_than.front() - rounding && !extrapolate) {
        throw ParameterError(
            "D" + text(percent) + " lies below the finest sieve, " + text(curve->size.front()) +
            (unit.empty() ? "" : " " + unit) + ", which " + text(100.0 * curve->finer_than.front()) +
            " % are finer than; add finer sieves, or pass extrapolate = true to follow the tail");
    }
    return std::visit([share](const auto& l) { return first_at_least(l, share); }, law);
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
                  const std::vector<PointMass>& points) {
    require(percent >= 0.0 && percent <= 100.0, "percent", percent, "between 0 and 100");
    if (cdf.size() != grid.bins()) {
        throw ShapeError("cdf has " + std::to_string(cdf.size()) + " entries; the grid has " +
                         std::to_string(grid.bins()) + " bins");
    }
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
        if (extrapolate && finer > 0.0 && slope > 0.0 && std::isfinite(slope)) {
            return std::exp(grid.edge(1) + std::log(finer / cdf[0]) / slope);
        }
        throw ParameterError(name + " lies in the fines bin, which holds " + text(100.0 * cdf[0]) +
                             " % below a size of " + text(std::exp(grid.edge(1))) +
                             "; lower psi_min to resolve it, or pass extrapolate = true");
    }
    return std::exp(inside_bin(grid, i, cdf[i - 1], *bin, finer, points));
}

}  // namespace comminute
