// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "comminute/fragments.hpp"
#include "comminute/grading.hpp"

namespace comminute::detail {

/// Draws R = ln X of a fragment law by inverting its cdf, without rejection: one number in, one out.
class FragmentSampler {
  public:
    explicit FragmentSampler(const FragmentLaw& law);

    /// R with P[ln X <= R] = p, p in (0, 1); never above 0.
    double operator()(double p) const {
        if (kind_ == Kind::weibull) return std::min(std::log(-std::log1p(p * scale_) / rate_) / shape_, 0.0);
        if (kind_ == Kind::power) return std::log(p) / shape_;
        return general(p);
    }

  private:
    enum class Kind { weibull, power, other };
    double general(double p) const;

    FragmentLaw law_;
    Kind kind_ = Kind::other;
    double scale_ = 0.0;  // Weibull: e^{-Lambda} - 1
    double rate_ = 0.0;   // Weibull: Lambda
    double shape_ = 1.0;  // Weibull's, or the power law's exponent
};

/// Size that a share p in (0, 1) of the mass is finer than: the inverse of Grading::finer, exact on point masses.
double size_quantile(const GradingLaw& law, double p);

/// z with Phi(z) = p, p in (0, 1), to rounding also far down the tail.
double normal_quantile(double p);

}  // namespace comminute::detail
