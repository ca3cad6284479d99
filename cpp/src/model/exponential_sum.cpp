// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/powers.hpp"
#include "comminute/fragments.hpp"

namespace comminute {

using namespace detail;

namespace {

// The monomials lose digits to cancellation while they are made, not while they are used.
using Wide = long double;

constexpr std::size_t most_terms = 24;
constexpr double steepest_decay = 230.0;  // in a bin
constexpr double longest_rate =
    3.0;  // above it the terms of the sum cancel; the head then takes the steep part
constexpr double tail_rate = 2.0;

// cos(pi k / (2 n)) for k = 0 .. 4 n - 1, all that a Chebyshev transform of n points needs.
std::vector<Wide> quarter_waves(std::size_t n) {
    std::vector<Wide> cosine(4 * n, 0.0L);
    for (std::size_t k = 0; k < n; ++k) {
        const Wide value =
            std::cos(std::numbers::pi_v<Wide> * static_cast<Wide>(k) / static_cast<Wide>(2 * n));
        cosine[k] = value;
        cosine[2 * n - k] = -value;
        cosine[(2 * n + k) % (4 * n)] = -value;
        if (k > 0) cosine[4 * n - k] = value;
    }
    return cosine;
}

// Coefficients b_a of F(y) = (1 - exp(-rate y)) / (1 - exp(-rate)) = sum_a b_a y^(a+1): its derivative interpolated
// at the Chebyshev nodes of [0, 1], rewritten in monomials, integrated.
std::vector<double> weibull_polynomial(double rate, std::size_t terms) {
    const auto n = static_cast<Wide>(terms);
    const std::vector<Wide> cosine = quarter_waves(terms);
    std::vector<Wide> slope(terms);
    for (std::size_t q = 0; q < terms; ++q) {
        const Wide node = cosine[2 * q + 1];
        slope[q] = rate * std::exp(-rate * 0.5L * (1.0L + node)) / -std::expm1(-static_cast<Wide>(rate));
    }
    std::vector<Wide> sum(terms, 0.0L);
    std::vector<Wide> before(terms, 0.0L);
    std::vector<Wide> chebyshev(terms, 0.0L);  // T_c(2 y - 1) in powers of y
    chebyshev[0] = 1.0L;
    for (std::size_t c = 0; c < terms; ++c) {
        Wide weight = 0.0L;
        for (std::size_t q = 0; q < terms; ++q) {
            weight += slope[q] * cosine[c * (2 * q + 1) % (4 * terms)];
        }
        weight *= (c == 0 ? 1.0L : 2.0L) / n;
        for (std::size_t a = 0; a < terms; ++a) sum[a] += weight * chebyshev[a];
        std::vector<Wide> next(terms, 0.0L);
        const Wide factor = c == 0 ? 1.0L : 2.0L;
        for (std::size_t a = 0; a < terms; ++a) {
            next[a] = -factor * chebyshev[a] - (c == 0 ? 0.0L : before[a]);
            if (a > 0) next[a] += 2.0L * factor * chebyshev[a - 1];
        }
        before = std::exchange(chebyshev, std::move(next));
    }
    std::vector<double> integrated(terms);
    for (std::size_t a = 0; a < terms; ++a) {
        integrated[a] = static_cast<double>(sum[a] / static_cast<Wide>(a + 1));
    }
    return integrated;
}

// Contribution of a term b exp(rate r) of the cdf to f_m exp(rate m h), under either scheme.
double on_bins(double b, double rate, double h, Scheme scheme) {
    if (scheme == Scheme::paper) return b * std::expm1(rate * h);
    const double s = std::sinh(0.5 * rate * h);
    return b * 4.0 * s * s / (rate * h);
}

// Ends with the first error above `most`.
double largest_error(const ExponentialSum& sum, const FragmentPmf& pmf, double most) {
    const std::size_t bins = pmf.mass.size();
    const auto head = static_cast<std::size_t>(sum.head);
    std::vector<double> power(sum.decay.size() * bins);
    for (std::size_t a = 0; a < sum.decay.size(); ++a) {
        fill_powers(sum.decay[a], power.data() + a * bins, static_cast<Index>(bins - head));
    }
    double worst = 0.0;
    for (std::size_t m = head + 1; m < bins && worst <= most; ++m) {
        double value = 0.0;
        for (std::size_t a = 0; a < sum.decay.size(); ++a)
            value += sum.coefficient[a] * power[a * bins + m - head];
        worst = std::max(worst, std::abs(value - pmf.mass[m]));
    }
    return worst;
}

// Sees to it that all bins of the tail together get what the law says, so that the error of the sum moves mass but makes
// none. The slowest term takes what the others lack.
void close_balance(ExponentialSum& sum, const FragmentPmf& pmf) {
    const auto from = static_cast<std::size_t>(sum.head) + 1;
    if (from >= pmf.below.size()) return;
    Wide lack = pmf.below[from];
    for (std::size_t a = 0; a < sum.decay.size(); ++a) {
        lack -= sum.coefficient[a] / std::expm1(static_cast<Wide>(sum.decay[a]));
    }
    sum.coefficient[0] += static_cast<double>(lack * std::expm1(static_cast<Wide>(sum.decay[0])));
}

// Fills in the error; false where the sum is not good enough.
bool accurate(ExponentialSum& sum, const FragmentPmf& pmf) {
    // A law so steep is a bin or two, and its weights would be beyond what numbers hold.
    if (*std::max_element(sum.decay.begin(), sum.decay.end()) > steepest_decay) return false;
    const double largest = *std::max_element(pmf.mass.begin(), pmf.mass.end());
    const double leaves = pmf.below.size() > 1 ? pmf.below[1] : 1.0;
    const double most = std::min(2e-14 * largest, 1e-15 * leaves);
    close_balance(sum, pmf);
    const double worst = largest_error(sum, pmf, most);
    sum.error = worst / largest;
    return largest > 0.0 && worst <= most;
}

ExponentialSum sum_of(const PowerLawFragments& law, double h, const FragmentPmf& pmf, Scheme scheme) {
    ExponentialSum sum;
    sum.coefficient = {on_bins(1.0, law.exponent, h, scheme)};
    sum.decay = {law.exponent * h};
    return accurate(sum, pmf) ? sum : ExponentialSum{};
}

ExponentialSum sum_of(const WeibullFragments& law, double h, const FragmentPmf& pmf, Scheme scheme) {
    const double rate = std::pow(law.scale, -law.shape);
    ExponentialSum sum;
    if (rate > longest_rate) {
        const double head = std::ceil(std::log(rate / tail_rate) / (law.shape * h));
        if (!(head < static_cast<double>(pmf.mass.size()) - 1.0)) return {};
        sum.head = static_cast<Index>(head);
    }
    const double left = rate * std::exp(-law.shape * h * static_cast<double>(sum.head));
    const double share = std::expm1(-left) / std::expm1(-rate);
    for (std::size_t terms = 1; terms <= most_terms; ++terms) {
        const std::vector<double> polynomial = weibull_polynomial(left, terms);
        sum.coefficient.resize(terms);
        sum.decay.resize(terms);
        for (std::size_t a = 0; a < terms; ++a) {
            const double decay = law.shape * static_cast<double>(a + 1);
            sum.coefficient[a] = on_bins(share * polynomial[a], decay, h, scheme);
            sum.decay[a] = decay * h;
        }
        if (accurate(sum, pmf)) return sum;
    }
    return {};
}

template <class Law>
ExponentialSum sum_of(const Law&, double, const FragmentPmf&, Scheme) {
    return {};
}

}  // namespace

ExponentialSum exponential_sum(const FragmentLaw& law, double spacing, const FragmentPmf& pmf,
                               Scheme scheme) {
    return std::visit([&](const auto& l) { return sum_of(l, spacing, pmf, scheme); }, law);
}

}  // namespace comminute
