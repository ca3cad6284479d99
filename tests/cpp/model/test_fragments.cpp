// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <array>

#include "support/helpers.hpp"

using comminute::fragment_pmf;
using comminute::FragmentLaw;
using comminute::FragmentPmf;
using comminute::LogNormalFragments;
using comminute::ParameterError;
using comminute::PowerLawFragments;
using comminute::Scheme;
using comminute::TabulatedFragments;
using comminute::WeibullFragments;
using helpers::at;
using helpers::Index;

namespace {

// Eq. 3 as printed: the density of X itself.
double weibull_density_of_x(double x, double scale, double shape) {
    return shape / scale * std::pow(x / scale, shape - 1.0) * std::exp(-std::pow(x / scale, shape)) /
           (1.0 - std::exp(-std::pow(scale, -shape)));
}

struct Case {
    Case(FragmentLaw the_law, double the_rate, std::function<double(double)> the_density)
        : law(std::move(the_law)), rate(the_rate), density(std::move(the_density)) {}
    FragmentLaw law;
    double rate;  // the density of r decays at least like e^{rate r}, and varies over lengths of 1 / rate
    std::function<double(double)> density;
};

Case normal_law(double mean, double sd, double rate) {
    const auto bell = [=](double r) { return std::exp(-0.5 * std::pow((r - mean) / sd, 2)); };
    const double whole = helpers::simpson(bell, -45.0 / rate, 0.0, 22500);
    return {LogNormalFragments{mean, sd}, rate, [=](double r) { return bell(r) / whole; }};
}

// Density of r = ln x from that of x, for laws from nearly constant to a hundredfold reduction.
std::vector<Case> extreme_laws() {
    std::vector<Case> cases;
    for (const double scale : {0.1, 0.3, 1.0, 10.0}) {
        for (const double shape : {0.5, 1.0, 2.5, 4.0}) {
            cases.emplace_back(WeibullFragments{scale, shape}, shape, [=](double r) {
                return std::exp(r) * weibull_density_of_x(std::exp(r), scale, shape);
            });
        }
    }
    for (const double a : {0.2, 1.0, 7.0, 50.0}) {
        cases.emplace_back(PowerLawFragments{a}, a,
                           [=](double r) { return std::exp(r) * a * std::pow(std::exp(r), a - 1.0); });
    }
    cases.push_back(normal_law(-1.0, 1.0, 3.0));
    cases.push_back(normal_law(-3.0, 0.2, 9.0));
    cases.push_back(normal_law(0.5, 0.7, 5.0));
    return cases;
}

double pdf(const FragmentLaw& law, double r) {
    return std::visit([r](const auto& l) { return l.pdf(r); }, law);
}

double cdf(const FragmentLaw& law, double r) {
    return std::visit([r](const auto& l) { return l.cdf(r); }, law);
}

// Mean of a table's cdf over [from, to] in r: trapezoids between its points, an exponential below the first.
double mean_of_table_cdf(const TabulatedFragments& table, double from, double to) {
    const double first = std::log(table.x[0]);
    double sum = 0.0;
    if (from < first && table.finer[0] > 0.0) {
        const double slope = std::log(table.finer[1] / table.finer[0]) / (std::log(table.x[1]) - first);
        sum += table.finer[0] / slope *
               (std::exp(slope * (std::min(to, first) - first)) - std::exp(slope * (from - first)));
    }
    for (std::size_t q = 1; q < table.x.size(); ++q) {
        const double left = std::log(table.x[q - 1]);
        const double right = std::log(table.x[q]);
        const double a = std::max(from, left);
        const double b = std::min(to, right);
        if (!(b > a)) continue;
        const double middle = (0.5 * (a + b) - left) / (right - left);
        sum += (b - a) * (table.finer[q - 1] + middle * (table.finer[q] - table.finer[q - 1]));
    }
    return sum / (to - from);
}

std::vector<TabulatedFragments> tables() {
    return {{{0.1, 0.23, 0.6, 1.0}, {0.05, 0.3, 0.35, 1.0}},
            {{0.25, 0.3, 0.9, 1.0}, {0.0, 0.8, 0.8, 1.0}},
            {{0.001, 1.0}, {0.3, 1.0}}};
}

// E[(-R)^q] for the truncated exponential, by the series of (1 - e^{-y}) / y: q! sum (-1)^{k+1} / (k! k^q).
double exact_moment(int q) {
    long double sum = 0.0L;
    long double inverse_factorial = 1.0L;
    for (int k = 1; k < 30; ++k) {
        inverse_factorial /= k;
        sum += (k % 2 == 1 ? 1.0L : -1.0L) * inverse_factorial / std::pow(static_cast<long double>(k), q);
    }
    return static_cast<double>(std::tgamma(static_cast<long double>(q + 1)) * sum / (1.0L - std::exp(-1.0L)));
}

// Both pmfs against Simpson's rule on the density, at steps of 1e-3 / rate or finer.
double worst_share(const Case& c, double h) {
    const Index bins = 24;
    const FragmentPmf own = fragment_pmf(c.law, h, bins, Scheme::conservative);
    const FragmentPmf paper = fragment_pmf(c.law, h, bins, Scheme::paper);
    const int pairs = 100 + static_cast<int>(std::ceil(500.0 * h * c.rate));
    double largest = 0.0;
    double worst = 0.0;
    for (Index m = 0; m < bins; ++m) {
        const auto depth = static_cast<double>(m);
        const auto hat = [&](double r) { return c.density(r) * (1.0 - std::abs(r / h + depth)); };
        double shared = helpers::simpson(hat, -(depth + 1.0) * h, -depth * h, pairs);
        if (m > 0) shared += helpers::simpson(hat, -depth * h, -(depth - 1.0) * h, pairs);
        const double moved =
            m == 0 ? 0.0 : helpers::simpson(c.density, -depth * h, -(depth - 1.0) * h, pairs);
        worst = std::max({worst, std::abs(own.mass[at(m)] - shared), std::abs(paper.mass[at(m)] - moved)});
        largest = std::max({largest, shared, moved});
    }
    return worst - 1e-15 > 0.0 ? (worst - 1e-15) / largest : 0.0;  // 1e-15: a difference of two cdf
}

struct Moments {
    double mean;
    double variance;
    double third;  // central
};

Moments moments_of(const FragmentPmf& pmf, double h) {
    std::array<long double, 4> raw{};
    for (std::size_t m = 0; m < pmf.mass.size(); ++m) {
        const long double r = -static_cast<long double>(m) * h;
        long double power = pmf.mass[m];
        for (long double& sum : raw) {
            sum += power;
            power *= r;
        }
    }
    const long double mean = raw[1];
    return {static_cast<double>(mean), static_cast<double>(raw[2] - mean * mean),
            static_cast<double>(raw[3] - 3.0L * mean * raw[2] + 2.0L * mean * mean * mean)};
}

}  // namespace

TEST_CASE("densities and distribution functions of the fragment laws follow Eq. 3") {
    for (const Case& c : extreme_laws()) {
        const double far = -45.0 / c.rate;  // what lies below weighs e^-45
        for (const double part : {0.0, 0.003, 0.02, 0.1, 0.3, 0.6}) {
            const double r = part * far;
            const double density = c.density(r);
            CHECK(pdf(c.law, r) == doctest::Approx(density).epsilon(1e-12));
            // Simpson's error at steps of 1e-3 / rate is below 1e-12
            CHECK(std::abs(cdf(c.law, r) - helpers::simpson(c.density, far, r, 22500)) < 2e-12);
        }
        CHECK(cdf(c.law, 0.0) == 1.0);
        CHECK(cdf(c.law, 1.0) == 1.0);
        CHECK(pdf(c.law, 1e-9) == 0.0);
        CHECK(cdf(c.law, -helpers::infinity) == 0.0);
    }
}

TEST_CASE("the default law is the truncated exponential of Eq. 4") {
    for (const double r : {-8.0, -2.0, -0.5, -0.01, 0.0}) {
        const double density = std::exp(r - std::exp(r)) / (1.0 - std::exp(-1.0));
        CHECK(WeibullFragments{}.pdf(r) == doctest::Approx(density).epsilon(1e-14));
    }
}

TEST_CASE("the conservative pmf has the exact mean, and variance and skewness to second order") {
    const Moments exact{
        -exact_moment(1), exact_moment(2) - std::pow(exact_moment(1), 2),
        -exact_moment(3) + 3.0 * exact_moment(1) * exact_moment(2) - 2.0 * std::pow(exact_moment(1), 3)};
    CHECK(std::abs(exact.mean - -1.2602020108) < 1e-10);
    CHECK(std::abs(exact.variance - 1.2316466670) < 1e-10);
    CHECK(std::abs(exact.third / std::pow(exact.variance, 1.5) - -1.6782) < 1e-4);

    std::array<double, 3> variance_error{};
    std::array<double, 3> skewness_error{};
    std::array<double, 3> spacing{0.2, 0.1, 0.05};
    for (std::size_t level = 0; level < 3; ++level) {
        const double h = spacing[level];
        const auto bins = static_cast<Index>(45.0 / h);  // e^-45 is cut off
        const Moments m = moments_of(fragment_pmf(WeibullFragments{}, h, bins, Scheme::conservative), h);
        CHECK(std::abs(m.mean - exact.mean) < 2e-14);
        variance_error[level] = m.variance - exact.variance;
        skewness_error[level] =
            m.third / std::pow(m.variance, 1.5) - exact.third / std::pow(exact.variance, 1.5);
    }
    for (std::size_t level = 0; level < 2; ++level) {
        // depositing on two bins adds h^2 theta (1 - theta), theta uniform: h^2 / 6 at leading order
        CHECK(variance_error[level] == doctest::Approx(spacing[level] * spacing[level] / 6.0).epsilon(0.01));
        CHECK(variance_error[level] / variance_error[level + 1] == doctest::Approx(4.0).epsilon(0.01));
        CHECK(skewness_error[level] / skewness_error[level + 1] == doctest::Approx(4.0).epsilon(0.01));
    }
}

TEST_CASE("the paper's scheme moves mass half a bin too far with each crush") {
    for (const double h : {0.2, 0.05, 0.01}) {
        const auto bins = static_cast<Index>(45.0 / h);
        const Moments m = moments_of(fragment_pmf(WeibullFragments{}, h, bins, Scheme::paper), h);
        const double excess = -exact_moment(1) - m.mean;
        // Euler-Maclaurin: the next term is h^2 f(0) / 12, f(0) = 1 / (e - 1); the one after it O(h^4)
        const double next = h * h / 12.0 / (std::exp(1.0) - 1.0);
        CHECK(std::abs(excess - 0.5 * h - next) < 1e-2 * next);
    }
}

TEST_CASE("one crush under a power law has the closed form") {
    for (const double a : {0.2, 1.0, 7.0, 50.0}) {
        for (const double h : {0.001, 0.1, 1.0}) {
            const FragmentPmf own = fragment_pmf(PowerLawFragments{a}, h, 40, Scheme::conservative);
            const FragmentPmf paper = fragment_pmf(PowerLawFragments{a}, h, 40, Scheme::paper);
            const double bin = a * h;
            CHECK(own.mass[0] == doctest::Approx(1.0 + std::expm1(-bin) / bin).epsilon(1e-11));
            for (Index m = 1; m < 40; ++m) {
                const double depth = static_cast<double>(m);
                const double hat =
                    std::pow(2.0 * std::sinh(0.5 * bin) * std::exp(-0.5 * bin * depth), 2) / bin;
                REQUIRE(std::abs(own.mass[at(m)] - hat) <= 1e-12 * hat + 1e-300);
                REQUIRE(std::abs(paper.mass[at(m)] - std::exp(-bin * depth) * std::expm1(bin)) < 1e-15);
            }
        }
    }
}

TEST_CASE("both pmfs are the integrals that define them, for extreme laws and spacings") {
    for (const Case& c : extreme_laws()) {
        for (const double h : {0.001, 0.05, 1.0}) CHECK(worst_share(c, h) < 1e-12);
    }
}

TEST_CASE("the same for a normal law cut off twenty standard deviations below its mean") {
    const Case steep = normal_law(2.0, 0.1, 200.0);
    for (const double h : {0.001, 0.05, 1.0}) CHECK(worst_share(steep, h) < 1e-12);
}

TEST_CASE("a measured law follows its table, and its pmfs are differences of the table's cdf") {
    for (const TabulatedFragments& table : tables()) {
        for (std::size_t q = 0; q < table.x.size(); ++q) {
            CHECK(std::abs(table.cdf(std::log(table.x[q])) - table.finer[q]) < 1e-15);
        }
        for (const double r : {-12.0, -2.0, -1.3, -0.7, -0.05}) {
            // over so short a stretch the cdf is linear to 1e-12; rounding is magnified by 1 / 2e-6
            CHECK(table.cdf(r) ==
                  doctest::Approx(mean_of_table_cdf(table, r - 1e-6, r + 1e-6)).epsilon(1e-8));
            CHECK(table.pdf(r) ==
                  doctest::Approx((table.cdf(r + 1e-6) - table.cdf(r - 1e-6)) / 2e-6).epsilon(1e-8));
        }
        for (const double h : {0.003, 0.05, 0.4}) {
            const FragmentPmf own = fragment_pmf(table, h, 60, Scheme::conservative);
            const FragmentPmf paper = fragment_pmf(table, h, 60, Scheme::paper);
            for (Index m = 0; m < 60; ++m) {
                const double top = -static_cast<double>(m) * h;
                const double here = mean_of_table_cdf(table, top - h, top);
                const double above = m == 0 ? 1.0 : mean_of_table_cdf(table, top, top + h);
                REQUIRE(std::abs(own.mass[at(m)] - (above - here)) < 2e-15);
                REQUIRE(std::abs(own.below[at(m)] - above) < 2e-15);
                if (m > 0)
                    REQUIRE(std::abs(paper.mass[at(m)] - (table.cdf(top + h) - table.cdf(top))) < 1e-15);
            }
        }
    }
}

TEST_CASE("no share of a pmf is negative or lost") {
    std::vector<FragmentLaw> laws;
    for (const Case& c : extreme_laws()) laws.push_back(c.law);
    for (const TabulatedFragments& table : tables()) laws.emplace_back(table);
    for (const FragmentLaw& law : laws) {
        for (const double h : {0.001, 0.02, 0.3, 1.0}) {
            for (const Scheme scheme : {Scheme::paper, Scheme::conservative}) {
                const Index bins = h < 0.01 ? 2000 : 300;
                const FragmentPmf pmf = fragment_pmf(law, h, bins, scheme);
                REQUIRE(pmf.mass.size() == at(bins));
                REQUIRE(pmf.below.size() == at(bins));
                REQUIRE(helpers::smallest_entry(pmf.mass) >= 0.0);
                REQUIRE(helpers::smallest_entry(pmf.below) >= 0.0);
                REQUIRE(pmf.below[0] == 1.0);
                if (scheme == Scheme::paper) REQUIRE(pmf.mass[0] == 0.0);
                long double landed = 0.0L;
                double worst = 0.0;
                for (std::size_t m = 0; m < pmf.mass.size(); ++m) {
                    worst = std::max(worst, std::abs(static_cast<double>(landed - 1.0L) + pmf.below[m]));
                    landed += pmf.mass[m];
                }
                REQUIRE(worst < 4e-15);  // each share is good to 4e-16 of the largest
            }
        }
    }
}

TEST_CASE("laws and sizes outside their range are refused with name, value and rule") {
    using helpers::infinity;
    const auto pmf = [](const FragmentLaw& law, double h = 0.1, Index bins = 8) {
        return fragment_pmf(law, h, bins, Scheme::conservative);
    };
    CHECK_REFUSED(pmf(WeibullFragments{0.0, 1.0}), "scale is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(pmf(WeibullFragments{-1.0, 1.0}), "scale is -1; it must be greater than 0 and finite");
    CHECK_REFUSED(pmf(WeibullFragments{1.0, helpers::not_a_number}),
                  "shape is nan; it must be greater than 0 and finite");
    CHECK_REFUSED(pmf(WeibullFragments{1.0, infinity}), "shape is inf; it must be greater than 0 and finite");
    CHECK_REFUSED(
        pmf(WeibullFragments{1e-100, 4.0}),
        "scale is 1e-100; it must be such that scale^-shape is neither 0 nor inf in double precision");
    CHECK_REFUSED(pmf(PowerLawFragments{0.0}), "exponent is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(pmf(PowerLawFragments{}, 0.0), "spacing is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(pmf(PowerLawFragments{}, helpers::not_a_number),
                  "spacing is nan; it must be greater than 0 and finite");
    CHECK_REFUSED(pmf(PowerLawFragments{}, 0.1, 0), "bins is 0; it must be at least 1");
    CHECK_NOTHROW(pmf(PowerLawFragments{}, 0.1, 1));
    CHECK_REFUSED(pmf(LogNormalFragments{-1.0, 0.0}), "sd_log is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(pmf(LogNormalFragments{4.0, 0.1}),
                  "mean_log is 4; it must be finite and at most 30 sd_log: nearly all of the law would lie "
                  "above X = 1");
    CHECK_REFUSED(
        pmf(LogNormalFragments{helpers::not_a_number, 0.1}),
        "mean_log is nan; it must be finite and at most 30 sd_log: nearly all of the law would lie above "
        "X = 1");
    CHECK_THROWS_WITH_AS(pmf(TabulatedFragments{{0.5, 1.0}, {1.0}}),
                         "finer has 1 entries; it must have one share for each of the 2 x",
                         comminute::ShapeError);
    CHECK_REFUSED(pmf(TabulatedFragments{{1.0}, {1.0}}), "the number of points is 1; it must be at least 2");
    CHECK_REFUSED(pmf(TabulatedFragments{{0.5, 0.5, 1.0}, {0.0, 0.5, 1.0}}),
                  "x is 0.5; it must be rising and greater than 0");
    CHECK_REFUSED(pmf(TabulatedFragments{{0.0, 1.0}, {0.0, 1.0}}),
                  "x is 0; it must be rising and greater than 0");
    CHECK_REFUSED(pmf(TabulatedFragments{{0.2, 0.5, 1.0}, {0.2, 0.1, 1.0}}),
                  "finer is 0.1; it must be at least 0 and never falling");
    CHECK_REFUSED(pmf(TabulatedFragments{{0.2, 0.9}, {0.0, 1.0}}), "the last x is 0.9; it must be 1");
    CHECK_REFUSED(pmf(TabulatedFragments{{0.2, 1.0}, {0.0, 0.9}}), "the last finer is 0.9; it must be 1");
    CHECK_REFUSED(
        pmf(TabulatedFragments{{0.2, 0.5, 1.0}, {0.1, 0.1, 1.0}}),
        "finer is 0.1; it must be 0 at the first x, or rising to the second: no tail can be read from a "
        "flat start");
}

TEST_CASE("a law too steep for the grid has no sum") {
    for (const Scheme scheme : {Scheme::paper, Scheme::conservative}) {
        for (const double exponent : {300.0, 690.0, 1e5}) {
            const comminute::PowerLawFragments law{exponent};
            const auto pmf = comminute::fragment_pmf(law, 1.0, 50, scheme);
            CHECK(comminute::exponential_sum(law, 1.0, pmf, scheme).coefficient.empty());
        }
    }
}

TEST_CASE("a law's inverse finds every share of its cdf again") {
    const FragmentLaw laws[] = {WeibullFragments{},
                                WeibullFragments{0.3, 2.0},
                                WeibullFragments{3.0, 0.7},
                                PowerLawFragments{0.5},
                                PowerLawFragments{3.0},
                                LogNormalFragments{},
                                LogNormalFragments{0.5, 0.4},
                                TabulatedFragments{{0.25, 0.5, 1.0}, {0.0, 0.4, 1.0}},
                                TabulatedFragments{{0.1, 0.5, 1.0}, {0.05, 0.4, 1.0}}};
    for (const FragmentLaw& any : laws) {
        std::visit(
            [](const auto& law) {
                for (const double share : {1e-9, 1e-4, 0.01, 0.2, 0.5, 0.8, 0.999}) {
                    const double r = law.quantile(share);
                    CAPTURE(share);
                    CHECK(r <= 0.0);
                    CHECK(std::abs(law.cdf(r) - share) < 2e-12 + 1e-12 * share);
                }
            },
            any);
    }
    const TabulatedFragments flat{{0.25, 0.5, 0.75, 1.0}, {0.1, 0.4, 0.4, 1.0}};
    CHECK(flat.quantile(0.4) == std::log(0.5));  // the lower end of a plateau
    CHECK(flat.quantile(0.4 + 1e-9) > std::log(0.75));
}
