// SPDX-License-Identifier: BSD-3-Clause
#include "gradings/sampling.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <vector>

#include "base/normal.hpp"

namespace comminute::detail {
namespace {

// A curve that is linear in ln x between points, and a power law below the first.
double point_quantile(const std::vector<double>& x, const std::vector<double>& finer, double tail_slope,
                      double p) {
    if (p < finer.front()) return std::log(x.front()) + std::log(p / finer.front()) / tail_slope;
    const auto above = std::clamp<std::ptrdiff_t>(
        std::upper_bound(finer.begin(), finer.end(), p) - finer.begin(), 1, std::ssize(finer) - 1);
    const auto q = static_cast<std::size_t>(above);
    const double fraction = (p - finer[q - 1]) / (finer[q] - finer[q - 1]);
    return std::log(x[q - 1]) + std::min(fraction, 1.0) * std::log(x[q] / x[q - 1]);
}

double quantile(const LogNormalFragments& law, double p) {
    return std::min(law.mean_log + law.sd_log * normal_quantile(p * normal_cdf(-law.mean_log / law.sd_log)),
                    0.0);
}

double quantile(const TabulatedFragments& law, double p) {
    return std::min(point_quantile(law.x, law.finer, law.tail_slope(), p), 0.0);
}

double quantile(const PointMasses& law, double p) {
    double below = 0.0;
    for (std::size_t q = 0; q + 1 < law.size.size(); ++q) {
        below += law.share[q];
        if (p < below) return law.size[q];
    }
    return law.size.back();
}

double quantile(const PowerLawGrading& law, double p) {
    const double exponent = 3.0 - law.fractal_dimension;
    if (law.smallest == 0.0) return law.largest * std::pow(p, 1.0 / exponent);
    // by the growth of s^exponent over the range, from the end where it is smaller than 1
    const double growth = exponent * std::log(law.largest / law.smallest);
    if (std::abs(growth) < 1e-12) return law.smallest * std::pow(law.largest / law.smallest, p);
    return growth > 0.0 ? law.largest * std::exp(std::log1p((1.0 - p) * std::expm1(-growth)) / exponent)
                        : law.smallest * std::exp(std::log1p(p * std::expm1(growth)) / exponent);
}

double quantile(const LogNormalGrading& law, double p) {
    const double kept = normal_cdf(std::log(law.largest / law.median) / law.sd_log);
    return std::min(law.median * std::exp(law.sd_log * normal_quantile(p * kept)), law.largest);
}

double quantile(const RosinRammlerGrading& law, double p) {
    const double kept = std::expm1(-std::pow(law.largest / law.d63, law.exponent));
    return std::min(law.d63 * std::pow(-std::log1p(p * kept), 1.0 / law.exponent), law.largest);
}

double quantile(const SieveCurve& law, double p) {
    return std::min(std::exp(point_quantile(law.size, law.finer_than, law.tail_slope, p)), law.size.back());
}

}  // namespace

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

FragmentSampler::FragmentSampler(const FragmentLaw& law) : law_(law) {
    if (const auto* weibull = std::get_if<WeibullFragments>(&law)) {
        kind_ = Kind::weibull;
        rate_ = std::pow(weibull->scale, -weibull->shape);
        scale_ = std::expm1(-rate_);
        shape_ = weibull->shape;
    } else if (const auto* power = std::get_if<PowerLawFragments>(&law)) {
        kind_ = Kind::power;
        shape_ = power->exponent;
    }
}

double FragmentSampler::general(double p) const {
    if (const auto* lognormal = std::get_if<LogNormalFragments>(&law_)) return quantile(*lognormal, p);
    return quantile(std::get<TabulatedFragments>(law_), p);
}

double size_quantile(const GradingLaw& law, double p) {
    return std::visit([p](const auto& l) { return quantile(l, p); }, law);
}

}  // namespace comminute::detail
