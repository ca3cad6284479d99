// SPDX-License-Identifier: BSD-3-Clause
// Monotone cubic interpolation of many columns over one rising abscissa (docs/theory/response_tables.md).
#include "points/monotone_cubic.hpp"

#include <algorithm>
#include <cmath>

namespace comminute::detail {

namespace {

// Slope at the end of a curve by the parabola through its three points, kept between 0 and three times the secant.
double end_slope(double near, double far, double secant, double next) {
    if (near <= 0.0 || secant == 0.0) return 0.0;
    if (far <= 0.0) return secant;
    const double slope = ((2.0 * near + far) * secant - near * next) / (near + far);
    if (slope * secant <= 0.0) return 0.0;
    return std::abs(slope) > 3.0 * std::abs(secant) ? 3.0 * secant : slope;
}

}  // namespace

std::vector<double> monotone_slopes(const std::vector<double>& at, const std::vector<double>& values) {
    const std::size_t count = at.size();
    std::vector<double> slopes(count, 0.0);
    const auto width = [&](std::size_t k) { return at[k + 1] - at[k]; };
    const auto smooth = [&](std::size_t k) { return k + 1 < count && width(k) > jump_width; };
    const auto secant = [&](std::size_t k) { return (values[k + 1] - values[k]) / width(k); };
    for (std::size_t k = 0; k < count; ++k) {
        const bool left = k > 0 && smooth(k - 1);
        const bool right = smooth(k);
        if (left && right) {
            const double one = secant(k - 1);
            const double other = secant(k);
            if (one * other <= 0.0) continue;
            const double a = width(k) + 2.0 * width(k - 1);
            const double b = 2.0 * width(k) + width(k - 1);
            slopes[k] = (a + b) / (b / one + a / other);
        } else if (right) {
            const bool further = smooth(k + 1);
            slopes[k] =
                end_slope(width(k), further ? width(k + 1) : 0.0, secant(k), further ? secant(k + 1) : 0.0);
        } else if (left) {
            const bool further = k > 1 && smooth(k - 2);
            slopes[k] = end_slope(width(k - 1), further ? width(k - 2) : 0.0, secant(k - 1),
                                  further ? secant(k - 2) : 0.0);
        }
    }
    return slopes;
}

Interval interval_of(const std::vector<double>& at, double place) {
    const auto next = std::upper_bound(at.begin() + 1, at.end() - 1, place);
    const auto k = static_cast<std::size_t>(next - at.begin() - 1);
    return {static_cast<Index>(k), std::clamp((place - at[k]) / (at[k + 1] - at[k]), 0.0, 1.0)};
}

}  // namespace comminute::detail
