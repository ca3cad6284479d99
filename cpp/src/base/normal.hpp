// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numbers>

namespace comminute::detail {

/// Standard normal cdf, to rounding also far down the lower tail.
inline double normal_cdf(double z) {
    return 0.5 * std::erfc(-z / std::numbers::sqrt2);
}

/// z with Phi(z) = p, p in (0, 1), to rounding also far down the tail.
double normal_quantile(double p);

}  // namespace comminute::detail
