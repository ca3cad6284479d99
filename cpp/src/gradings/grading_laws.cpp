// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/normal.hpp"
#include "base/point_curve.hpp"
#include "comminute/grading.hpp"

namespace comminute {

using namespace detail;

namespace {

// x -> (e^{a x} - 1) / (e^{a} - 1) without cancellation, x in [0, 1]; a = 0 gives x.
double exponential_ramp(double a, double x) {
    if (std::abs(a) < 1e-12) return x;
    // for a > 0 both terms are written with decaying exponentials, which cannot overflow
    return a > 0.0 ? std::exp(a * (x - 1.0)) * std::expm1(-a * x) / std::expm1(-a)
                   : std::expm1(a * x) / std::expm1(a);
}

// Size at which a curve that is linear in ln d between points reaches a share; below the first along the tail.
double curve_quantile(const std::vector<double>& size, const std::vector<double>& finer, double tail_slope,
                      double share) {
    const auto [upper, fraction] = first_at_least(finer, share);
    if (upper == 0) {
        if (!(tail_slope > 0.0) || share >= finer[0]) return size[0];
        return size[0] * std::pow(share / finer[0], 1.0 / tail_slope);
    }
    const double* const above = size.data() + upper;
    return fraction == 1.0 ? above[0] : above[-1] * std::pow(above[0] / above[-1], fraction);
}

}  // namespace

double PointMasses::finer(double size_at) const {
    double sum = 0.0;
    for (std::size_t q = 0; q < size.size() && size[q] <= size_at; ++q) sum += share[q];
    return size_at >= size.back() ? 1.0 : sum;
}

double PointMasses::quantile(double share_finer) const {
    double below = 0.0;
    for (std::size_t q = 0; q + 1 < size.size(); ++q) {
        below += share[q];
        if (below >= share_finer - share_rounding) return size[q];
    }
    return size.back();
}

double PowerLawGrading::finer(double size_at) const {
    if (size_at <= smallest) return 0.0;
    if (size_at >= largest) return 1.0;
    if (smallest == 0.0) return std::pow(size_at / largest, 3.0 - fractal_dimension);
    const double range = std::log(largest / smallest);
    return exponential_ramp((3.0 - fractal_dimension) * range, std::log(size_at / smallest) / range);
}

double PowerLawGrading::quantile(double share_finer) const {
    const double power = 3.0 - fractal_dimension;
    if (smallest == 0.0) return largest * std::pow(share_finer, 1.0 / power);
    const double range = std::log(largest / smallest);
    // F = (e^{a x} - 1) / (e^a - 1), a = power * range, solved for x from whichever end loses no digits
    const double a = power * range;
    if (std::abs(a) < 1e-12) return smallest * std::exp(range * share_finer);
    if (a > 0.0) return largest * std::exp(std::log(std::exp(-a) - share_finer * std::expm1(-a)) / power);
    return smallest * std::exp(std::log1p(share_finer * std::expm1(a)) / power);
}

double LogNormalGrading::finer(double size_at) const {
    if (size_at >= largest) return 1.0;
    return normal_cdf(std::log(size_at / median) / sd_log) / normal_cdf(std::log(largest / median) / sd_log);
}

double LogNormalGrading::quantile(double share_finer) const {
    if (share_finer >= 1.0) return largest;
    const double kept = normal_cdf(std::log(largest / median) / sd_log);
    return std::min(median * std::exp(sd_log * normal_quantile(share_finer * kept)), largest);
}

double RosinRammlerGrading::finer(double size_at) const {
    if (size_at >= largest) return 1.0;
    return std::expm1(-std::pow(size_at / d63, exponent)) / std::expm1(-std::pow(largest / d63, exponent));
}

double RosinRammlerGrading::quantile(double share_finer) const {
    if (share_finer >= 1.0) return largest;
    const double kept = std::expm1(-std::pow(largest / d63, exponent));
    return std::min(d63 * std::pow(-std::log1p(share_finer * kept), 1.0 / exponent), largest);
}

double SieveCurve::finer(double size_at) const {
    if (size_at >= size.back()) return 1.0;
    if (size_at < size.front()) {
        return finer_than.front() > 0.0 ? finer_than.front() * std::pow(size_at / size.front(), tail_slope)
                                        : 0.0;
    }
    const auto above =
        static_cast<std::size_t>(std::upper_bound(size.begin(), size.end(), size_at) - size.begin());
    const double fraction = std::log(size_at / size[above - 1]) / std::log(size[above] / size[above - 1]);
    return finer_than[above - 1] + fraction * (finer_than[above] - finer_than[above - 1]);
}

double SieveCurve::quantile(double share_finer) const {
    return curve_quantile(size, finer_than, tail_slope, share_finer);
}

double CurvePoints::quantile(double share) const {
    return curve_quantile(size, finer_than, tail_slope, share);
}

}  // namespace comminute
