// SPDX-License-Identifier: BSD-3-Clause
// Integrals over half-filled cells in the root of the distance from the tip, where they are polynomials
// (docs/theory/one_sweep.md, section 3).
#include "zones/cut_shares.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace comminute::detail {
namespace {

/// Lower end of the zone at the place tip + u^2, x - W, as a polynomial of u.
struct LowerEnd {
    double tip;
    double root;  // of the steepness

    double at(double u) const { return tip + u * (u - root); }
    /// Both u at which the lower end passes a place; NaN where it never does.
    std::array<double, 2> passes(double place) const {
        const double apart = std::sqrt(0.25 * root * root - (tip - place));
        return {0.5 * root - apart, 0.5 * root + apart};
    }
};

/// Integral of `length` over u from `begin` to `end`, weighted with dx = 2 u du. A piece between kinks is a cubic, for
/// which Simpson's rule is exact.
template <std::size_t kinks, class Length>
double integral(double begin, double end, std::array<double, kinks> at, const Length& length) {
    for (double& kink : at) kink = kink > begin && kink < end ? kink : end;
    std::sort(at.begin(), at.end());
    const auto piece = [&](double from, double to) {
        const double middle = 0.5 * (from + to);
        const auto weighted = [&](double u) { return 2.0 * u * length(u); };
        return (to - from) / 6.0 * (weighted(from) + 4.0 * weighted(middle) + weighted(to));
    };
    double sum = 0.0;
    for (const double kink : at) {
        sum += piece(begin, kink);
        begin = kink;
    }
    return sum + piece(begin, end);
}

}  // namespace

double cut_share(const CutShell& cut, Index distance) {
    const double low = static_cast<double>(cut.shell) - 0.5;
    const double width = cut.top - low;
    const double above_tip = std::clamp(cut.top - cut.tip, 0.0, width) / width;
    if (above_tip == 0.0 || cut.steepness == 0.0) return 0.0;
    if (std::isinf(cut.tip)) return 1.0;
    if (std::isinf(cut.steepness)) return distance == 0 ? above_tip * (2.0 - above_tip) : above_tip;
    const LowerEnd lower{cut.tip, std::sqrt(cut.steepness)};
    const double begin = std::sqrt(std::max(low - cut.tip, 0.0));
    const double end = std::sqrt(cut.top - cut.tip);
    if (distance == 0) {
        const auto within = [&](double u) { return std::min(lower.root * u, cut.tip + u * u - low); };
        return std::clamp(2.0 * integral(begin, end, lower.passes(low), within) / (width * width), 0.0, 1.0);
    }
    const auto partner = static_cast<double>(cut.shell - distance);
    const auto [a, b] = lower.passes(partner + 0.5);
    const auto [c, d] = lower.passes(partner - 0.5);
    const auto covered = [&](double u) { return std::clamp(partner + 0.5 - lower.at(u), 0.0, 1.0); };
    return std::clamp(integral(begin, end, std::array{a, b, c, d}, covered) / width, 0.0, 1.0);
}

}  // namespace comminute::detail
