// SPDX-License-Identifier: BSD-3-Clause
// The crush zone of grains whose strength is scattered (docs/theory/three_cells.md, section 6).
#include "resolved/scattered_zone.hpp"

#include <algorithm>
#include <cmath>

namespace comminute::detail {

namespace {

constexpr double narrow = 0.1;  // range of contrasts within which three points give the mean

}  // namespace

double hazard_of(double share) {
    return share < 1.0 ? std::min(-std::log1p(-share), most_hazard) : most_hazard;
}

// Integrals over the contrast are tabulated where the share falls from 1 to 0, and are read by cubic pieces that have the
// integrand as their slope.
ScatteredZone::ScatteredZone(double log_hazard) : log_hazard_(log_hazard) {
    if (log_hazard_ <= least_log_hazard) return;
    certain_ = std::sqrt(2.0 * std::max(log_hazard_ - std::log(most_hazard), 0.0));
    const double end = std::sqrt(2.0 * (log_hazard_ - least_log_hazard));
    spacing_ = (end - certain_) / static_cast<double>(knots - 1);
    double crushed = certain_;
    double borne = 0.0;
    for (Index k = 0; k < knots; ++k) {
        const auto i = static_cast<std::size_t>(k);
        const double here = hazard(certain_ + spacing_ * static_cast<double>(k));
        share_[i] = -std::expm1(-here);
        borne_[i] = here * std::exp(-here);
        if (k > 0) {
            const double between = hazard(certain_ + spacing_ * (static_cast<double>(k) - 0.5));
            crushed += spacing_ / 6.0 * (share_[i - 1] - 4.0 * std::expm1(-between) + share_[i]);
            borne += spacing_ / 6.0 * (borne_[i - 1] + 4.0 * between * std::exp(-between) + borne_[i]);
        }
        share_integral_[i] = crushed;
        borne_integral_[i] = borne;
    }
}

double ScatteredZone::hazard(double contrast) const {
    return std::exp(log_hazard_ - 0.5 * contrast * contrast);
}

double ScatteredZone::at(double contrast) const {
    return -std::expm1(-hazard(contrast));
}

double ScatteredZone::integral(double contrast, const Table& values, const Table& slopes) const {
    const double reach = std::abs(contrast);
    double found = slopes.front() * reach;
    if (reach > certain_) {
        const double place = std::min((reach - certain_) / spacing_, static_cast<double>(knots - 1));
        const auto k = static_cast<std::size_t>(std::min(static_cast<Index>(place), knots - 2));
        const double t = place - static_cast<double>(k);
        const double rise = values[k + 1] - values[k];
        const double before = slopes[k] * spacing_ - rise;
        const double after = rise - slopes[k + 1] * spacing_;
        found = values[k] + t * (rise + (1.0 - t) * (before * (1.0 - t) + after * t));
    }
    return std::copysign(found, contrast);
}

double ScatteredZone::mean(double lower, double upper) const {
    if (spacing_ == 0.0) return 0.0;
    if (upper - lower < narrow) return (at(lower) + 4.0 * at(0.5 * (lower + upper)) + at(upper)) / 6.0;
    const double crushed =
        integral(upper, share_integral_, share_) - integral(lower, share_integral_, share_);
    return std::clamp(crushed / (upper - lower), 0.0, 1.0);
}

// No more than the hazard of the mean share, by Gibbs' inequality.
double ScatteredZone::endured(double lower, double upper, double share) const {
    const double most = hazard_of(share);
    if (spacing_ == 0.0 || upper - lower < narrow || share >= 1.0) return most;
    const double borne = integral(upper, borne_integral_, borne_) - integral(lower, borne_integral_, borne_);
    return std::clamp(borne / ((upper - lower) * (1.0 - share)), 0.0, most);
}

}  // namespace comminute::detail
