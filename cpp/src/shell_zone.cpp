// SPDX-License-Identifier: BSD-3-Clause
#include "shell_zone.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "gauss.hpp"

namespace comminute {

double zone_onset(const Material& material, double log_stress_ratio) {
    return std::log(material.reference_size) - material.weibull_modulus / 3.0 * log_stress_ratio;
}

// The zone covers the length clamp(1/2 - d - t + omega, 0, 1) of the smaller grain's cell, d = 0: twice
// min(omega, t + 1/2). With omega = root * s, s = sqrt(t - tip), that is a cubic in s between its kinks once t is
// replaced, so a 3-point Gauss rule a piece is exact.
double ShellZone::share(Index distance) const {
    const double begin = std::max(-0.5, tip);
    if (!(begin < 0.5)) return 0.0;
    if (std::isinf(steepness) || std::isinf(tip)) {
        return distance == 0 ? 1.0 - (begin + 0.5) * (begin + 0.5) : 0.5 - begin;
    }
    const auto d = static_cast<double>(distance);
    std::array<double, 6> kink{begin, 0.5, 0.5, 0.5, 0.5, 0.5};
    std::size_t found = 1;
    for (const double covered : {0.0, 1.0}) {
        const double c = d + tip + covered - 0.5;
        const double discriminant = 1.0 - 4.0 * c / steepness;
        if (discriminant < 0.0) continue;
        const double larger = 0.5 * steepness * (1.0 + std::sqrt(discriminant));
        for (const double width : {larger, c * steepness / larger}) {
            const double at = tip + std::max(width, 0.0) * std::max(width, 0.0) / steepness;
            if (at <= begin || at >= 0.5) continue;
            std::size_t place = found++;
            for (; kink[place - 1] > at; --place) kink[place] = kink[place - 1];
            kink[place] = at;
        }
    }

    const double root = std::sqrt(steepness);
    const auto covered_length = [&](double t, double s) {
        if (distance == 0) return 2.0 * std::min(root * s, t + 0.5);
        return std::clamp(0.5 - d - t + root * s, 0.0, 1.0);
    };
    double sum = 0.0;
    double s = std::sqrt(begin - tip);
    for (std::size_t p = 0; p < found; ++p) {
        const double s_end = std::sqrt(kink[p + 1] - tip);
        if (s_end > s) {
            const double width = (kink[p + 1] - kink[p]) / (s_end + s);  // s_end - s without cancellation
            for (const auto& [node, weight] : gauss_3_unit) {
                const double step = node * width;
                const double t = kink[p] + step * (2.0 * s + step);
                sum += weight * width * 2.0 * (s + step) * covered_length(t, s + step);
            }
        }
        s = s_end;
    }
    return std::clamp(sum, 0.0, 1.0);
}

// A cell at d >= 1 lies inside where d <= omega(t) - t - 1/2 for all t, one at d = 0 where 0 <= omega(t) - t - 1/2.
// omega(t) - t is concave, so its least value is at an end.
Index ShellZone::surely_whole(Index at_most) const {
    if (!(tip <= -0.5)) return 0;
    const double inner =
        std::min(std::sqrt(steepness * (-0.5 - tip)), std::sqrt(steepness * (0.5 - tip)) - 1.0);
    if (!(inner >= 0.0)) return 0;
    return static_cast<Index>(std::min(std::floor(inner), static_cast<double>(at_most))) + 1;
}

// It lies outside where d >= 1/2 - t + omega(t) for all t; that is less than 1 + omega(1/2).
Index ShellZone::surely_last(Index at_most) const {
    if (!(tip < 0.5)) return -1;
    const double widest = std::sqrt(steepness * (0.5 - tip));
    return static_cast<Index>(std::min(std::ceil(1.0 + widest), static_cast<double>(at_most)));
}

}  // namespace comminute
