// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>

#include "comminute/fragments.hpp"

namespace comminute::detail {

/// The inverse of a Weibull law's cdf, with what the law alone decides worked out once.
class WeibullQuantile {
  public:
    explicit WeibullQuantile(const WeibullFragments& law)
        : rate_(std::pow(law.scale, -law.shape)), shape_(law.shape), kept_(std::expm1(-rate_)) {}
    double operator()(double share) const {
        return std::min(std::log(-std::log1p(share * kept_) / rate_) / shape_, 0.0);
    }

  private:
    double rate_;  // Lambda
    double shape_;
    double kept_;  // e^{-Lambda} - 1
};

/// Draws R = ln X of any fragment law by inverting its cdf, without rejection: one number in, one out.
class FragmentQuantile {
  public:
    explicit FragmentQuantile(const FragmentLaw& law) : law_(law), weibull_(WeibullFragments{}) {
        if (const auto* weibull = std::get_if<WeibullFragments>(&law)) weibull_ = WeibullQuantile(*weibull);
    }

    /// R with P[ln X <= R] = share, share in (0, 1); never above 0.
    double operator()(double share) const {
        if (std::holds_alternative<WeibullFragments>(law_)) return weibull_(share);
        if (const auto* power = std::get_if<PowerLawFragments>(&law_))
            return std::log(share) / power->exponent;
        return std::visit([share](const auto& law) { return law.quantile(share); }, law_);
    }

  private:
    FragmentLaw law_;
    WeibullQuantile weibull_;
};

}  // namespace comminute::detail
