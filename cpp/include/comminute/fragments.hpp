// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <variant>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/scheme.hpp"
#include "comminute/view.hpp"

namespace comminute {

/// Weibull law of the size-reduction factor X, truncated to (0, 1] (Eq. 3); the default is Eq. 4.
///
/// All fragment laws speak of R = ln X <= 0, the log reduction; a packet of log size psi goes to psi + R. `quantile` is the
/// inverse of `cdf`: the first R at which it reaches a share in (0, 1).
///
/// @code{.cpp}
/// comminute::WeibullFragments law;  // scale 1, shape 1
/// CHECK(law.pdf(0.0) == doctest::Approx(std::exp(-1.0) / (1.0 - std::exp(-1.0))));
/// CHECK(law.cdf(0.0) == 1.0);
/// CHECK(law.cdf(law.quantile(0.25)) == doctest::Approx(0.25));
/// @endcode
struct COMMINUTE_API WeibullFragments {
    double scale = 1.0;  ///< lambda > 0
    double shape = 1.0;  ///< kappa > 0

    double pdf(double r) const;
    double cdf(double r) const;
    double quantile(double share) const;
    /// A length in r over which the density is smooth: quadratures take panels no longer than this.
    double smooth_length() const;
    void validate() const;
    friend bool operator==(const WeibullFragments& a, const WeibullFragments& b) {
        return a.scale == b.scale && a.shape == b.shape;
    }
};

/// Power law in X: P[X <= x] = x^exponent on (0, 1]; exponent 1 is uniform X.
///
/// @code{.cpp}
/// CHECK(comminute::PowerLawFragments{}.cdf(std::log(0.25)) == doctest::Approx(0.25));
/// @endcode
struct COMMINUTE_API PowerLawFragments {
    double exponent = 1.0;  ///< > 0

    double pdf(double r) const;
    double cdf(double r) const;
    double quantile(double share) const;
    double smooth_length() const;
    void validate() const;
    friend bool operator==(const PowerLawFragments& a, const PowerLawFragments& b) {
        return a.exponent == b.exponent;
    }
};

/// Lognormal law of X cut off at X = 1: R = ln X is normal, restricted to R <= 0.
///
/// @code{.cpp}
/// comminute::LogNormalFragments law{-1.0, 0.5};
/// CHECK(law.cdf(-1.0) == doctest::Approx(0.5 / (0.5 * std::erfc(-2.0 / std::sqrt(2.0)))));
/// @endcode
struct COMMINUTE_API LogNormalFragments {
    double mean_log = -1.0;  ///< mean of ln X before the cut, finite, at most 30 sd_log
    double sd_log = 1.0;     ///< its standard deviation, > 0

    double pdf(double r) const;
    double cdf(double r) const;
    double quantile(double share) const;
    double smooth_length() const;
    void validate() const;
    friend bool operator==(const LogNormalFragments& a, const LogNormalFragments& b) {
        return a.mean_log == b.mean_log && a.sd_log == b.sd_log;
    }
};

/// A measured law: P[X <= x] at given points, linear in ln x between them. Below the first point it continues as the
/// power law through the first two, or is 0 where the first share is 0.
///
/// @code{.cpp}
/// comminute::TabulatedFragments law{{0.25, 0.5, 1.0}, {0.0, 0.4, 1.0}};
/// CHECK(law.cdf(std::log(0.5)) == doctest::Approx(0.4));
/// CHECK(law.pdf(std::log(0.6)) == doctest::Approx(0.6 / std::log(2.0)));
/// @endcode
struct COMMINUTE_API TabulatedFragments {
    std::vector<double> x;      ///< two or more, rising, in (0, 1], the last 1
    std::vector<double> finer;  ///< P[X <= x], in [0, 1], never falling, the last 1

    double pdf(double r) const;
    double cdf(double r) const;
    double quantile(double share) const;
    double smooth_length() const;
    /// Places in r at which the density jumps; quadratures must not step over these.
    std::vector<double> kinks() const;
    /// Exponent of the power law below the first point; 0 where there is none.
    double tail_slope() const;
    void validate() const;
    friend bool operator==(const TabulatedFragments& a, const TabulatedFragments& b) {
        return a.x == b.x && a.finer == b.finer;
    }
};

using FragmentLaw = std::variant<WeibullFragments, PowerLawFragments, LogNormalFragments, TabulatedFragments>;

/// One crush on the grid: the share of the mass that moves down by m bins.
struct FragmentPmf {
    std::vector<double> mass;   ///< (N) f_m, m = 0 .. N-1; f_0 = 0 under the paper's scheme
    std::vector<double> below;  ///< (N) sum of f_t over t >= m: from bin m, what ends in the fines bin
};

/// A law of R = ln X on a grid, as a pmf in bins.
///
/// @param spacing  bin width h > 0
/// @param bins     N >= 1
/// @param scheme   Scheme::conservative: finite volumes. Scheme::paper: f_m = P[-m h < R <= -(m-1) h]
/// @throws ParameterError for a law or a size outside its range
///
/// @code{.cpp}
/// auto f = comminute::fragment_pmf(comminute::PowerLawFragments{}, std::log(2.0), 8,
///                                  comminute::Scheme::paper);
/// CHECK(f.mass[0] == 0.0);
/// CHECK(f.mass[1] == doctest::Approx(0.5));   // uniform X: half of the fragments within one halving
/// CHECK(f.below[2] == doctest::Approx(0.5));
/// @endcode
COMMINUTE_API FragmentPmf fragment_pmf(const FragmentLaw& law, double spacing, Index bins,
                                       Scheme scheme = Scheme::conservative);

/// The tail of a fragment pmf as a sum of exponentials: f_m = sum_a coefficient[a] exp(-decay[a] (m - head)) for m > head
/// >= 0.
///
/// A convolution with such a tail is one running sum a term. A Weibull cdf is an entire function of X^kappa and has a
/// short accurate sum; one of a fine scale (scale^-shape > 3) has it for the tail only. A power law is a single term.
struct ExponentialSum {
    Index head = 0;                   ///< the first `head` reductions are not in the sum
    std::vector<double> coefficient;  ///< (K), the slowest decay first; empty: this law has no accurate sum
    std::vector<double> decay;        ///< (K) > 0, in a bin
    double error = 0.0;               ///< largest |sum - f_m| over the tail, as a share of the largest f_m
};

/// The shortest sum that meets `pmf` to 2e-14 of its largest entry and to 1e-15 of all that leaves a bin, checked against
/// every entry.
/// @param pmf  fragment_pmf of the same law, spacing and scheme
///
/// @code{.cpp}
/// const double h = 0.01;
/// auto f = comminute::fragment_pmf(comminute::WeibullFragments{}, h, 700);
/// auto sum = comminute::exponential_sum(comminute::WeibullFragments{}, h, f);
/// CHECK(sum.coefficient.size() <= 14);
/// CHECK(sum.error < 2e-14);
/// @endcode
COMMINUTE_API ExponentialSum exponential_sum(const FragmentLaw& law, double spacing, const FragmentPmf& pmf,
                                             Scheme scheme = Scheme::conservative);

}  // namespace comminute
