// SPDX-License-Identifier: BSD-3-Clause
#include "base/normal.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace comminute::detail {

// ln Phi is concave, so Newton's method on ln Phi(z) = ln p climbs to the root from any point below it, and
// Phi(z) <= exp(-z^2 / 2) / 2 for z <= 0 gives one.
double normal_quantile(double p) {
    if (p > 0.5) return -normal_quantile(1.0 - p);
    double z = -std::sqrt(-2.0 * std::log(2.0 * p));
    for (int turn = 0; turn < 50; ++turn) {
        const double cdf = normal_cdf(z);
        const double density = std::exp(-0.5 * z * z) / std::sqrt(2.0 * std::numbers::pi);
        const double step = cdf / density * std::log(p / cdf);
        z += step;
        if (!(step > 4.0 * std::numeric_limits<double>::epsilon() * std::abs(z))) break;
    }
    return z;
}

}  // namespace comminute::detail
