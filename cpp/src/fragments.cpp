// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/fragments.hpp"

#include <cmath>
#include <limits>

#include "comminute/error.hpp"
#include "gauss.hpp"

namespace comminute {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

void require_positive(const char* parameter, double value) {
    require(value > 0.0 && value < infinity, parameter, value, "greater than 0 and finite");
}

FragmentPmf paper_pmf(const FragmentLaw& law, double h, Index bins) {
    FragmentPmf pmf;
    pmf.mass.assign(static_cast<std::size_t>(bins), 0.0);
    pmf.below.assign(static_cast<std::size_t>(bins), 1.0);
    const auto cdf = [&](double r) { return std::visit([r](const auto& l) { return l.cdf(r); }, law); };
    for (std::size_t m = 1; m < pmf.mass.size(); ++m) {
        const double above = cdf(-static_cast<double>(m - 1) * h);
        pmf.below[m] = above;
        pmf.mass[m] = above - cdf(-static_cast<double>(m) * h);
    }
    return pmf;
}

// f_m is the hat-weighted density around -m h; what lies at m or beyond is the cdf averaged over one bin.
FragmentPmf conservative_pmf(const FragmentLaw& law, double h, Index bins) {
    FragmentPmf pmf;
    pmf.mass.assign(static_cast<std::size_t>(bins), 0.0);
    pmf.below.assign(static_cast<std::size_t>(bins), 1.0);
    std::visit(
        [&](const auto& l) {
            const int panels = static_cast<int>(std::ceil(h / l.smooth_length()));
            const auto below_u = [&](double depth) {
                return [&l, h, depth](double u) { return l.cdf(-(depth + u) * h); };
            };
            for (std::size_t m = 0; m < pmf.mass.size(); ++m) {
                const auto depth = static_cast<double>(m);
                const auto lower = [&](double u) { return (1.0 - u) * l.pdf(-(depth + u) * h); };
                const auto upper = [&](double u) { return u * l.pdf(-(depth - 1.0 + u) * h); };
                pmf.mass[m] = h * integrate(lower, 0.0, 1.0, panels);
                if (m == 0) continue;
                pmf.mass[m] += h * integrate(upper, 0.0, 1.0, panels);
                pmf.below[m] = integrate(below_u(depth - 1.0), 0.0, 1.0, panels);
            }
        },
        law);
    return pmf;
}

}  // namespace

double WeibullFragments::pdf(double r) const {
    if (r > 0.0) return 0.0;
    const double rate = std::pow(scale, -shape);
    const double y = rate * std::exp(shape * r);
    return shape * y * std::exp(-y) / -std::expm1(-rate);
}

double WeibullFragments::cdf(double r) const {
    if (r >= 0.0) return 1.0;
    const double rate = std::pow(scale, -shape);
    return std::expm1(-rate * std::exp(shape * r)) / std::expm1(-rate);
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

double PowerLawFragments::smooth_length() const {
    return 1.0 / exponent;
}

void PowerLawFragments::validate() const {
    require_positive("exponent", exponent);
}

FragmentPmf fragment_pmf(const FragmentLaw& law, double spacing, Index bins, FragmentRule rule) {
    std::visit([](const auto& l) { l.validate(); }, law);
    require_positive("spacing", spacing);
    require(bins >= 1, "bins", static_cast<double>(bins), "at least 1");
    return rule == FragmentRule::paper ? paper_pmf(law, spacing, bins) : conservative_pmf(law, spacing, bins);
}

}  // namespace comminute
