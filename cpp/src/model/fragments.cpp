// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/fragments.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "base/gauss.hpp"
#include "base/normal.hpp"
#include "base/point_curve.hpp"
#include "comminute/error.hpp"
#include "model/fragment_quantile.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void require_positive(const char* parameter, double value) {
    require(value > 0.0 && value < infinity, parameter, value, "greater than 0 and finite");
}

// A law is narrow in a bin that would take more panels than this, and is then integrated where it has its mass alone.
constexpr double most_panels = 16.0;
// The fine tail keeps all its digits down to this share; the coarse one ends at the rounding of 1.
constexpr double negligible_finer = 1e-300;
constexpr double negligible_coarser = 0x1p-53;

// Mean over the bin [lower, lower + h] in r of weight(u) times the law's density or cdf, u = (r - lower) / h, split
// where those have kinks; `coarser` is what f is where all the law's mass is finer. In u, not in r, since far down the tail r/h has no digits left for the weight.
template <class Law, class F, class Value = double>
Value mean_over_bin(const Law& law, const std::vector<double>& kinks, double lower, double h, const F& f,
                    const Value& zero = 0.0, double coarser = 0.0) {
    Value sum = zero;
    double begin = 0.0;
    auto kink = std::upper_bound(kinks.begin(), kinks.end(), lower);
    while (begin < 1.0) {
        const double next = kink != kinks.end() ? (*kink++ - lower) / h : 1.0;
        const double end = std::clamp(next, begin, 1.0);
        if (end == begin) continue;
        double from = begin;
        double to = end;
        if ((to - from) * h > most_panels * law.smooth_length()) {
            from = std::clamp((law.quantile(negligible_finer) - lower) / h, begin, end);
            to = std::clamp((law.quantile(1.0 - negligible_coarser) - lower) / h, begin, end);
            sum += Value(zero + (end - to) * coarser);
        }
        const int panels = static_cast<int>(std::ceil((to - from) * h / law.smooth_length()));
        if (panels > 0) sum += integrate(f, from, to, panels, zero);
        begin = end;
    }
    return sum;
}

// Density of a law as a function of r, for many r of one law.
template <class Law>
auto density_of(const Law& law) {
    return [&law](double r) { return law.pdf(r); };
}
auto density_of(const WeibullFragments& law) {
    const double rate = std::pow(law.scale, -law.shape);
    return [shape = law.shape, rate, whole = -std::expm1(-rate)](double r) {
        const double y = rate * std::exp(shape * r);
        return r > 0.0 ? 0.0 : shape * y * std::exp(-y) / whole;
    };
}

template <class Law>
std::vector<double> kinks_of(const Law& law) {
    if constexpr (requires { law.kinks(); }) return law.kinks();
    return {};
}

// Integrals of the density, since differences of the cdf lose digits where bins are narrow.
template <class Law>
FragmentPmf paper_pmf(const Law& law, double h, Index bins) {
    FragmentPmf pmf;
    pmf.mass = Array<double>(bins).vector();
    pmf.below = Array<double>(bins, 1.0).vector();
    const std::vector<double> kinks = kinks_of(law);
    const auto pdf = density_of(law);
    for (std::size_t m = 1; m < pmf.mass.size(); ++m) {
        const auto depth = static_cast<double>(m);
        const auto density = [&](double u) { return pdf((u - depth) * h); };
        pmf.mass[m] = h * mean_over_bin(law, kinks, -depth * h, h, density);
    }
    if (bins > 1) pmf.below.back() = law.cdf(static_cast<double>(2 - bins) * h);
    return pmf;
}

// f_m is the hat-weighted density around -m h: a bin of r gives to the two between which it lies. What ends beyond the
// last is the cdf averaged over one bin.
template <class Law>
FragmentPmf conservative_pmf(const Law& law, double h, Index bins) {
    FragmentPmf pmf;
    pmf.mass = Array<double>(bins).vector();
    pmf.below = Array<double>(bins, 1.0).vector();
    const std::vector<double> kinks = kinks_of(law);
    const auto pdf = density_of(law);
    for (std::size_t m = 0; m < pmf.mass.size(); ++m) {
        const auto next = static_cast<double>(m + 1);
        const auto hats = [&](double u) -> Eigen::Array2d {
            return pdf((u - next) * h) * Eigen::Array2d(u, 1.0 - u);
        };
        const Eigen::Array2d given =
            h * mean_over_bin(law, kinks, -next * h, h, hats, Eigen::Array2d(0.0, 0.0));
        pmf.mass[m] += given[0];
        if (m + 1 < pmf.mass.size()) pmf.mass[m + 1] = given[1];
    }
    if (bins > 1) {
        const auto depth = static_cast<double>(bins - 1);
        const auto cdf = [&](double u) { return law.cdf((u - depth) * h); };
        pmf.below.back() = mean_over_bin(law, kinks, -depth * h, h, cdf, 0.0, 1.0);
    }
    return pmf;
}

// Fills in `below` from its last entry. Quadratures miss the whole by a few roundings, of a steep law in wide bins by 1e-13. A crush that leaves its bin is
// one in a hundred there, and each of its hundred tries would lose that much.
FragmentPmf made_whole(FragmentPmf pmf) {
    long double further = pmf.below.back();
    for (std::size_t m = pmf.mass.size() - 1; m > 0; --m) {
        pmf.below[m] = static_cast<double>(further);
        further += pmf.mass[m - 1];
    }
    if (pmf.mass.size() == 1) return pmf;
    const auto whole = static_cast<double>(further);
    for (std::size_t m = 0; m < pmf.mass.size(); ++m) {
        pmf.mass[m] /= whole;
        if (m > 0) pmf.below[m] /= whole;
    }
    return pmf;
}

}  // namespace

double WeibullFragments::pdf(double r) const {
    return density_of(*this)(r);
}

double WeibullFragments::cdf(double r) const {
    if (r >= 0.0) return 1.0;
    const double rate = std::pow(scale, -shape);
    return std::expm1(-rate * std::exp(shape * r)) / std::expm1(-rate);
}

double WeibullFragments::quantile(double share) const {
    return WeibullQuantile(*this)(share);
}

double WeibullFragments::smooth_length() const {
    return 0.5 / shape;
}

void WeibullFragments::validate() const {
    require_positive("scale", scale);
    require_positive("shape", shape);
    const double rate = std::pow(scale, -shape);
    require(rate > 0.0 && rate < infinity, "scale", scale,
            "such that scale^-shape is neither 0 nor inf in double precision");
}

double PowerLawFragments::pdf(double r) const {
    return r > 0.0 ? 0.0 : exponent * std::exp(exponent * r);
}

double PowerLawFragments::cdf(double r) const {
    return r >= 0.0 ? 1.0 : std::exp(exponent * r);
}

double PowerLawFragments::quantile(double share) const {
    return std::log(share) / exponent;
}

double PowerLawFragments::smooth_length() const {
    return 1.0 / exponent;
}

void PowerLawFragments::validate() const {
    require_positive("exponent", exponent);
}

double LogNormalFragments::pdf(double r) const {
    if (r > 0.0) return 0.0;
    const double z = (r - mean_log) / sd_log;
    return std::exp(-0.5 * z * z) /
           (sd_log * std::sqrt(2.0 * std::numbers::pi) * normal_cdf(-mean_log / sd_log));
}

double LogNormalFragments::cdf(double r) const {
    if (r >= 0.0) return 1.0;
    return normal_cdf((r - mean_log) / sd_log) / normal_cdf(-mean_log / sd_log);
}

double LogNormalFragments::quantile(double share) const {
    return std::min(mean_log + sd_log * normal_quantile(share * normal_cdf(-mean_log / sd_log)), 0.0);
}

double LogNormalFragments::smooth_length() const {
    // cut off far below its mean the law is all flank, as steep as exp(r mean_log / sd_log^2)
    return sd_log / std::max(1.0, mean_log / sd_log);
}

void LogNormalFragments::validate() const {
    require_positive("sd_log", sd_log);
    require(std::isfinite(mean_log) && mean_log <= 30.0 * sd_log, "mean_log", mean_log,
            "finite and at most 30 sd_log: nearly all of the law would lie above X = 1");
}

double TabulatedFragments::tail_slope() const {
    return finer[0] > 0.0 ? std::log(finer[1] / finer[0]) / std::log(x[1] / x[0]) : 0.0;
}

double TabulatedFragments::pdf(double r) const {
    if (r > 0.0) return 0.0;
    const double at = std::exp(r);
    if (at < x[0]) return tail_slope() * cdf(r);
    const auto above = std::min(
        static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin()), x.size() - 1);
    return (finer[above] - finer[above - 1]) / std::log(x[above] / x[above - 1]);
}

double TabulatedFragments::cdf(double r) const {
    if (r >= 0.0) return 1.0;
    const double at = std::exp(r);
    if (at < x[0]) return finer[0] > 0.0 ? finer[0] * std::exp(tail_slope() * (r - std::log(x[0]))) : 0.0;
    const auto above = std::min(
        static_cast<std::size_t>(std::upper_bound(x.begin(), x.end(), at) - x.begin()), x.size() - 1);
    return finer[above - 1] + (finer[above] - finer[above - 1]) * (r - std::log(x[above - 1])) /
                                  std::log(x[above] / x[above - 1]);
}

double TabulatedFragments::quantile(double share) const {
    const auto [upper, fraction] = first_at_least(finer, share);
    if (upper == 0) {
        const double first = std::log(x[0]);
        return share < finer[0] ? first + std::log(share / finer[0]) / tail_slope() : first;
    }
    const double* const above = x.data() + upper;
    return std::min(std::log(above[-1]) + fraction * std::log(above[0] / above[-1]), 0.0);
}

double TabulatedFragments::smooth_length() const {
    return tail_slope() > 0.0 ? 1.0 / tail_slope() : 1.0;
}

std::vector<double> TabulatedFragments::kinks() const {
    std::vector<double> at;
    for (const double point : x) at.push_back(std::log(point));
    return at;
}

void TabulatedFragments::validate() const {
    require_entries(static_cast<Index>(finer.size()), static_cast<Index>(x.size()), entry("finer"),
                    "it must have one share for each of the " + std::to_string(x.size()) + " x");
    require(x.size() >= 2, "the number of points", static_cast<double>(x.size()), "at least 2");
    for (std::size_t q = 0; q < x.size(); ++q) {
        require(x[q] > (q == 0 ? 0.0 : x[q - 1]), "x", x[q], "rising and greater than 0");
        require(finer[q] >= (q == 0 ? 0.0 : finer[q - 1]), "finer", finer[q], "at least 0 and never falling");
    }
    require(x.back() == 1.0, "the last x", x.back(), "1");
    require(finer.back() == 1.0, "the last finer", finer.back(), "1");
    require(finer[0] == 0.0 || finer[1] > finer[0], "finer", finer[0],
            "0 at the first x, or rising to the second: no tail can be read from a flat start");
}

FragmentPmf fragment_pmf(const FragmentLaw& law, double spacing, Index bins, Scheme scheme) {
    std::visit([](const auto& l) { l.validate(); }, law);
    require_positive("spacing", spacing);
    require(bins >= 1, "bins", static_cast<double>(bins), "at least 1");
    return made_whole(std::visit(
        [&](const auto& l) {
            return scheme == Scheme::paper ? paper_pmf(l, spacing, bins) : conservative_pmf(l, spacing, bins);
        },
        law));
}

}  // namespace comminute
