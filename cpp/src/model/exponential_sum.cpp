// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "base/double_double.hpp"
#include "base/powers.hpp"
#include "comminute/fragments.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr std::size_t most_terms = 24;
constexpr double steepest_decay = 230.0;  // in a bin
constexpr double longest_rate = 3.0;  // above it the sum's terms cancel; the head then takes the steep part
constexpr double tail_rate = 2.0;
constexpr double beyond_repair = 1e3;  // of the error allowed, which no closing of the balance makes up for

// Modified Bessel function I_c of the first kind, by its power series, whose terms are all positive.
double bessel(std::size_t c, double z) {
    double term = 1.0;
    for (std::size_t k = 1; k <= c; ++k) term *= 0.5 * z / static_cast<double>(k);
    double sum = 0.0;
    for (std::size_t k = 1; sum + term != sum; ++k) {
        sum += term;
        term *= 0.25 * z * z / static_cast<double>(k * (k + c));
    }
    return sum;
}

// Coefficients b_a of F(y) = (1 - exp(-rate y)) / (1 - exp(-rate)) = sum_a b_a y^(a+1), from the Chebyshev series of the
// derivative on [0, 1],
//   exp(-rate y) = exp(-rate/2) (I_0 + 2 sum_c (-1)^c I_c T_c(2 y - 1)), all I_c at rate/2,
// cut off after `terms` terms, rewritten in powers of y and integrated. The power y^a has the sign (-1)^(c - a) in
// T_c(2 y - 1), so that all terms of a coefficient have one sign and nothing cancels.
std::vector<double> weibull_polynomial(double rate, std::size_t terms) {
    std::vector<double> sum(terms, 0.0);
    for (std::size_t c = 0; c < terms; ++c) {
        const double weight = (c == 0 ? 1.0 : 2.0) * bessel(c, 0.5 * rate);
        double power = 1.0;  // size of the coefficient of y^a in T_c(2 y - 1)
        for (std::size_t a = 0; a <= c; ++a) {
            sum[a] += weight * power;
            power *=
                4.0 * static_cast<double>((c + a) * (c - a)) / static_cast<double>((2 * a + 1) * (2 * a + 2));
        }
    }
    const double slope = rate * std::exp(-0.5 * rate) / -std::expm1(-rate);
    for (std::size_t a = 0; a < terms; ++a) {
        sum[a] *= (a % 2 == 0 ? slope : -slope) / static_cast<double>(a + 1);
    }
    return sum;
}

// Factor of exp(-rate m h) that a term b exp(rate r) of the cdf gives to f_m, under either scheme; r is the log of size
// over parent size.
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

// Lets all bins of the tail together get what the law says, so that the error of the sum moves mass but makes none. The
// slowest term takes what the others lack, which is of the size of a double's rounding and so is found with more digits.
void close_balance(ExponentialSum& sum, const FragmentPmf& pmf) {
    const auto from = static_cast<std::size_t>(sum.head) + 1;
    if (from >= pmf.below.size()) return;
    DoubleDouble lack{pmf.below[from]};
    for (std::size_t a = 0; a < sum.decay.size(); ++a) {
        lack = lack + DoubleDouble{-sum.coefficient[a]} / exact_expm1(sum.decay[a]);
    }
    sum.coefficient[0] += lack.high * std::expm1(sum.decay[0]);
}

// Error in the first bin of the tail, which tells at once that terms are lacking.
double first_error(const ExponentialSum& sum, const FragmentPmf& pmf) {
    const auto first = static_cast<std::size_t>(sum.head) + 1;
    if (first >= pmf.mass.size()) return 0.0;
    double value = 0.0;
    for (std::size_t a = 0; a < sum.decay.size(); ++a) value += sum.coefficient[a] * std::exp(-sum.decay[a]);
    return std::abs(value - pmf.mass[first]);
}

// Fills in the error; false where the sum is not good enough.
bool accurate(ExponentialSum& sum, const FragmentPmf& pmf) {
    // A law so steep is a bin or two, and its weights would be beyond what numbers hold.
    if (*std::max_element(sum.decay.begin(), sum.decay.end()) > steepest_decay) return false;
    const double largest = *std::max_element(pmf.mass.begin(), pmf.mass.end());
    const double leaves = pmf.below.size() > 1 ? pmf.below[1] : 1.0;
    const double most = std::min(2e-14 * largest, 1e-15 * leaves);
    if (first_error(sum, pmf) > beyond_repair * most) return false;
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
