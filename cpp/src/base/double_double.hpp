// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

namespace comminute::detail {

/// A number as the sum of two doubles, the second at most half a unit in the last place of the first: 31 digits, on any
/// machine, for the few places where a double's 16 do not do.
struct DoubleDouble {
    double high = 0.0;
    double low = 0.0;
};

/// Exact sum of two doubles.
inline DoubleDouble exact_sum(double a, double b) {
    const double high = a + b;
    const double from_b = high - a;
    return {high, (a - (high - from_b)) + (b - from_b)};
}

inline DoubleDouble operator+(DoubleDouble a, double b) {
    const DoubleDouble sum = exact_sum(a.high, b);
    return exact_sum(sum.high, sum.low + a.low);
}
inline DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
    return a + b.high + b.low;
}
inline DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
    const double high = a.high * b.high;
    return exact_sum(high, std::fma(a.high, b.high, -high) + (a.high * b.low + a.low * b.high));
}
inline DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
    const double high = a.high / b.high;
    const double rest = std::fma(-high, b.high, a.high) + (a.low - high * b.low);
    return exact_sum(high, rest / b.high);
}

/// exp(x) - 1 for x >= 0: a Taylor series at x / 2^k < 1/16, and expm1(2 y) = expm1(y) (expm1(y) + 2).
inline DoubleDouble exact_expm1(double x) {
    int halvings = 0;
    while (x >= 0.0625) {
        x *= 0.5;
        ++halvings;
    }
    DoubleDouble series{1.0, 0.0};
    for (int n = 18; n > 1; --n) {
        series = series * DoubleDouble{x} / DoubleDouble{static_cast<double>(n)} + 1.0;
    }
    DoubleDouble found = series * DoubleDouble{x};
    for (; halvings > 0; --halvings) found = found * (found + 2.0);
    return found;
}

}  // namespace comminute::detail
