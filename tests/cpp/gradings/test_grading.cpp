// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include "support/helpers.hpp"

using comminute::fitting_grid;
using comminute::gap_graded;
using comminute::Grading;
using comminute::GridOptions;
using comminute::LogGrid;
using comminute::Material;
using comminute::monodisperse;
using comminute::ParameterError;
using comminute::percentile;
using comminute::PointMasses;
using comminute::power_law;
using comminute::ShapeError;
using comminute::sieve_grading;
using comminute::SieveOptions;
using helpers::at;
using helpers::Index;
using helpers::infinity;
using helpers::not_a_number;

namespace {

using Numbers = std::vector<double>;

template <class Last, class = decltype(fitting_grid(std::declval<const Grading&>(), Material{}, 1.0,
                                                    std::declval<Last>()))>
constexpr bool takes(int) {
    return true;
}
template <class Last>
constexpr bool takes(long) {
    return false;
}
// A number of bins is no bin width.
static_assert(takes<double>(0) && takes<GridOptions>(0) && !takes<int>(0));

// Mass by N(> s) ~ s^-alpha: dF ~ s^3 s^(-alpha - 1) ds, integrated over ln s.
double power_law_by_integration(double alpha, double smallest, double largest, double size) {
    const auto mass = [&](double psi) { return std::exp((3.0 - alpha) * psi); };
    return helpers::simpson(mass, std::log(smallest), std::log(size), 4000) /
           helpers::simpson(mass, std::log(smallest), std::log(largest), 4000);
}

Numbers cdf_of(const Grading& grading, const LogGrid& grid) {
    Numbers cdf = grading.on_grid(grid);
    for (std::size_t i = 1; i < cdf.size(); ++i) cdf[i] += cdf[i - 1];
    return cdf;
}

}  // namespace

TEST_CASE("point gradings are steps at their sizes") {
    const Grading one = monodisperse(2.0);
    CHECK(one.finer(std::nextafter(2.0, 0.0)) == 0.0);
    CHECK(one.finer(2.0) == 1.0);
    CHECK(one.largest() == 2.0);
    CHECK(one.smallest() == 2.0);
    const Grading gap = gap_graded(2.0, 0.1, 0.3);
    CHECK(gap.finer(0.0999) == 0.0);
    CHECK(gap.finer(0.1) == 0.7);
    CHECK(gap.finer(1.999) == 0.7);
    CHECK(gap.finer(2.0) == 1.0);
    CHECK(gap.largest() == 2.0);
    CHECK(gap.smallest() == 0.1);
    CHECK(gap.smallest(0.69) == 0.1);
    CHECK(gap.smallest(0.71) == 2.0);
    const Grading ten{PointMasses{{1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, Numbers(10, 0.1)}, "", {}};
    CHECK(ten.finer(10.0) == 1.0);  // though ten times 0.1 adds up to less
    CHECK(gap_graded(2.0, 0.1, 0.0) == monodisperse(0.1));
    CHECK(gap_graded(2.0, 0.1, 1.0) == monodisperse(2.0));
    CHECK(gap_graded(2.0, 0.1) == gap_graded(2.0, 0.1, 0.5));
    CHECK_FALSE(gap_graded(2.0, 0.1) == gap_graded(2.0, 0.1, 0.4));
}

TEST_CASE("a power law holds its mass by the cube of the size") {
    for (const double alpha : {-1.0, 0.0, 2.0, 2.5, 2.999, 3.0, 3.0 + 1e-13, 3.5, 6.0}) {
        const Grading grading = power_law(alpha, 1e-3, 2.0);
        for (const double size : {1.5e-3, 0.01, 0.1, 1.0, 1.99}) {
            // Simpson's error at these steps is below 1e-12
            CHECK(std::abs(grading.finer(size) - power_law_by_integration(alpha, 1e-3, 2.0, size)) < 1e-11);
        }
        CHECK(grading.finer(1e-3) == 0.0);
        CHECK(grading.finer(1e-9) == 0.0);
        CHECK(grading.finer(2.0) == 1.0);
        CHECK(grading.finer(infinity) == 1.0);
        CHECK(grading.largest() == 2.0);
        CHECK(grading.smallest() == 1e-3);
        for (const double tail : {1e-6, 0.01, 0.5}) {
            CHECK(power_law_by_integration(alpha, 1e-3, 2.0, grading.smallest(tail)) ==
                  doctest::Approx(tail).epsilon(1e-9));
        }
    }
    CHECK(power_law(2.0, 0.5, 1.5).finer(0.75) == doctest::Approx(0.25).epsilon(1e-15));  // uniform in s
    CHECK(power_law(400.0, 1e-3, 1.0).finer(0.5) == 1.0);  // extremes neither overflow nor divide by zero
    CHECK(power_law(-400.0, 1e-3, 1.0).finer(0.5) == doctest::Approx(std::pow(0.5, 403.0)).epsilon(1e-11));
}

TEST_CASE("the named gradings follow their formulas, cut off at the largest size") {
    for (const double size : {0.3, 0.77, 1.2, 1.99}) {
        CHECK(comminute::uniform_size(0.2, 2.0).finer(size) ==
              doctest::Approx((size - 0.2) / 1.8).epsilon(1e-14));
        CHECK(comminute::log_uniform(0.2, 2.0).finer(size) ==
              doctest::Approx(std::log(size / 0.2) / std::log(10.0)).epsilon(1e-14));
        CHECK(comminute::fuller(2.0).finer(size) == doctest::Approx(std::sqrt(size / 2.0)).epsilon(1e-14));
        CHECK(comminute::fuller(2.0, 0.3).finer(size) ==
              doctest::Approx(std::pow(size / 2.0, 0.3)).epsilon(1e-14));
        const auto bell = [](double psi) {
            return std::exp(-0.5 * std::pow((psi - std::log(0.8)) / 0.6, 2));
        };
        const double cut = helpers::simpson(bell, -7.0, std::log(2.0), 4000);
        CHECK(comminute::lognormal(0.8, 0.6, 2.0).finer(size) ==
              doctest::Approx(helpers::simpson(bell, -7.0, std::log(size), 4000) / cut).epsilon(1e-11));
        const auto ramp = [](double d) { return 1.0 - std::exp(-std::pow(d / 0.8, 1.7)); };
        CHECK(comminute::rosin_rammler(0.8, 1.7, 2.0).finer(size) ==
              doctest::Approx(ramp(size) / ramp(2.0)).epsilon(1e-14));
    }
    const Grading normal = comminute::lognormal(0.5, 0.25);
    CHECK(normal.largest() == doctest::Approx(0.5 * std::exp(1.0)).epsilon(1e-15));
    CHECK(normal.finer(0.5) == doctest::Approx(0.5).epsilon(1e-4));
    CHECK(normal.notes ==
          std::vector<std::string>{"the lognormal law is cut off 4 standard deviations above its "
                                   "median, at " +
                                   comminute::text(normal.largest())});
    const Grading rammler = comminute::rosin_rammler(0.5, 2.0);
    CHECK(rammler.finer(0.5) == doctest::Approx((1.0 - std::exp(-1.0)) / (1.0 - 1e-4)).epsilon(1e-14));
    CHECK(std::exp(-std::pow(rammler.largest() / 0.5, 2.0)) == doctest::Approx(1e-4).epsilon(1e-12));
    CHECK(rammler.notes ==
          std::vector<std::string>{"the Rosin-Rammler law is cut off where 0.01 % would be coarser, "
                                   "at " +
                                   comminute::text(rammler.largest())});
    CHECK(comminute::lognormal(0.5, 0.25, 1.0).notes.empty());
    for (const Grading& grading : {normal, rammler, comminute::fuller(16.0)}) {
        CHECK(grading.smallest() == 0.0);
        for (const double tail : {1e-6, 1e-3, 0.4}) {
            CHECK(grading.finer(grading.smallest(tail)) == doctest::Approx(tail).epsilon(1e-9));
        }
    }
}

TEST_CASE("the makers refuse what is no grading, naming value and rule") {
    CHECK_REFUSED(monodisperse(0.0), "size is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(monodisperse(infinity), "size is inf; it must be greater than 0 and finite");
    CHECK_REFUSED(gap_graded(-1.0, 0.1), "coarse is -1; it must be greater than 0 and finite");
    CHECK_REFUSED(gap_graded(1.0, not_a_number), "fine is nan; it must be greater than 0 and finite");
    CHECK_REFUSED(gap_graded(1.0, 0.1, 1.01), "coarse_share is 1.01; it must be between 0 and 1");
    CHECK_REFUSED(gap_graded(1.0, 0.1, not_a_number), "coarse_share is nan; it must be between 0 and 1");
    CHECK_REFUSED(gap_graded(0.1, 1.0), "fine is 1 and coarse is 0.1; fine must be less than coarse");
    CHECK_REFUSED(power_law(not_a_number, 0.1, 1.0), "fractal_dimension is nan; it must be finite");
    CHECK_REFUSED(power_law(3.0, 0.0, 1.0),
                  "smallest is 0; it must be greater than 0 (or 0, for a fractal dimension below 3)");
    CHECK_REFUSED(power_law(2.5, not_a_number, 1.0),
                  "smallest is nan; it must be greater than 0 (or 0, for a fractal dimension below 3)");
    CHECK_REFUSED(comminute::fuller(16.0, 0.0), "exponent is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(comminute::lognormal(0.0, 1.0), "median is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(comminute::lognormal(1.0, infinity), "sd_log is inf; it must be greater than 0 and finite");
    CHECK_REFUSED(comminute::lognormal(1.0, 0.1, 0.01),
                  "largest is 0.01; it must be within 30 standard deviations below the median");
    CHECK_REFUSED(comminute::rosin_rammler(-1.0, 1.0), "d63 is -1; it must be greater than 0 and finite");
    CHECK_REFUSED(comminute::rosin_rammler(1.0, 1.0, 0.0),
                  "largest is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(power_law(2.5, 0.1, infinity), "largest is inf; it must be greater than 0 and finite");
    CHECK_REFUSED(power_law(2.5, 1.0, 1.0),
                  "smallest is 1 and largest is 1; smallest must be less than largest");
    CHECK_REFUSED(monodisperse(1.0).finer(0.0), "size is 0; it must be greater than 0");
    CHECK_REFUSED(monodisperse(1.0).smallest(1.0), "tail is 1; it must be at least 0 and less than 1");
}

TEST_CASE("on a grid each bin holds the mass between its edges, the fines bin all below, and the sum is 1") {
    const LogGrid grid(-5.0, 0.7, 115);
    const Grading gradings[] = {monodisperse(1.0),
                                monodisperse(1e-9),
                                gap_graded(2.0, 0.3, 0.37),
                                power_law(2.5, 1e-3, 2.0),
                                power_law(3.0, 1e-4, 1.0),
                                comminute::lognormal(0.2, 0.5, 1.5),
                                comminute::rosin_rammler(0.3, 1.4, 2.0),
                                comminute::fuller(1.9),
                                sieve_grading({0.1, 0.5, 2.0}, {7.0, 40.0, 100.0}),
                                sieve_grading({1e-4, 2e-4}, {0.0, 100.0})};
    for (const Grading& grading : gradings) {
        const Numbers pmf = grading.on_grid(grid);
        CHECK(pmf.size() == 115);
        CHECK(std::abs(helpers::sum_of(pmf) - 1.0) < 1e-15);
        CHECK(helpers::smallest_entry(pmf) >= 0.0);
        double below = 0.0;
        for (Index i = 0; i < 115; ++i) {
            const double finer = grading.finer(std::exp(grid.edge(i + 1)));
            REQUIRE(std::abs(pmf[at(i)] - (finer - below)) < 1e-15);
            below = finer;
        }
        CHECK(comminute::mixed_fabric(grading, grid).grainsize()[40] == pmf[40]);
    }
    CHECK(monodisperse(1e-9).on_grid(grid)[0] == 1.0);
    CHECK_REFUSED(monodisperse(4.0).on_grid(LogGrid(-1.0, 0.0, 11)),
                  "the largest grain, 4, lies above the grid's top edge, 1.0512710963760241; raise "
                  "psi_max, or size the grid from the grading with fitting_grid");
    CHECK_NOTHROW(monodisperse(std::exp(0.05)).on_grid(LogGrid(-1.0, 0.0, 11)));  // on the edge itself
}

TEST_CASE("a sieve curve is linear in ln d between sieves, whatever their order") {
    const Grading sand = sieve_grading({1.0, 0.25, 4.0, 0.5}, {60.0, 0.0, 100.0, 10.0});
    CHECK(sand == sieve_grading({0.25, 0.5, 1.0, 4.0}, {0.0, 10.0, 60.0, 100.0}));
    CHECK(sand.unit == "mm");
    CHECK(sand.notes.empty());
    CHECK(sand.finer(0.25) == 0.0);
    CHECK(sand.finer(0.1) == 0.0);
    CHECK(sand.finer(0.5) == doctest::Approx(0.1).epsilon(1e-15));
    CHECK(sand.finer(std::sqrt(0.5)) == doctest::Approx(0.35).epsilon(1e-14));
    CHECK(sand.finer(2.0) == doctest::Approx(0.8).epsilon(1e-14));
    CHECK(sand.finer(4.0) == 1.0);
    CHECK(sand.finer(9.0) == 1.0);
    CHECK(sand.largest() == 4.0);
    CHECK(sand.smallest() == doctest::Approx(0.25).epsilon(1e-14));
    CHECK(sand.smallest(0.05) == doctest::Approx(0.25 * std::sqrt(2.0)).epsilon(1e-13));
    const Grading plateaus = sieve_grading({0.1, 0.2, 1.0, 2.0, 3.0}, {0.0, 0.0, 100.0, 100.0, 100.0});
    CHECK(plateaus.largest() == 1.0);
    CHECK(plateaus.smallest() == doctest::Approx(0.2).epsilon(1e-14));
    CHECK(plateaus.finer(0.15) == 0.0);
}

TEST_CASE("what a sieve curve leaves open is filled by a stated rule, and a note says so") {
    const Grading tail = sieve_grading({0.1, 0.4, 2.0}, {5.0, 20.0, 100.0});
    CHECK(tail.finer(0.05) == doctest::Approx(0.025).epsilon(1e-14));  // slope ln 4 / ln 4 = 1
    CHECK(tail.finer(1e-5) == doctest::Approx(5e-6).epsilon(1e-14));
    CHECK(tail.smallest() == 0.0);
    CHECK(tail.smallest(0.01) == doctest::Approx(0.02).epsilon(1e-13));
    REQUIRE(tail.notes.size() == 1);
    CHECK(
        tail.notes[0] ==
        "5 % is finer than the finest sieve, 0.1 mm: it continues as a power law of slope 1, through the two "
        "finest points");

    const Grading fractions = sieve_grading({1.0, 2.0}, {0.0, 1.0}, SieveOptions{""});
    CHECK(fractions.finer(std::sqrt(2.0)) == doctest::Approx(0.5).epsilon(1e-14));
    CHECK(fractions.notes ==
          std::vector<std::string>{"the values end at 1: read as fractions, not per cent"});

    const Grading extended = sieve_grading({0.5, 1.0}, {0.0, 50.0}, SieveOptions{"mm", true});
    CHECK(extended.largest() == doctest::Approx(2.0).epsilon(1e-14));
    CHECK(extended.finer(1.0) == doctest::Approx(0.5).epsilon(1e-14));
    CHECK(extended.notes ==
          std::vector<std::string>{
              "the coarsest sieve, 1 mm, has 50 % finer, not 100 %: the curve is carried on "
              "at its last slope to 100 % at 2 mm"});
    CHECK(sieve_grading({0.5, 1.0}, {0.0, 100.0}, SieveOptions{"mm", true}).notes.empty());

    // what sums leave behind is no finding, and fractions are told by a top near 1
    const Grading summed =
        sieve_grading({0.5, 1.0, 2.0}, {-5e-15, 50.0, 100.00000000000001}, SieveOptions{""});
    CHECK(summed.finer(0.5) == 0.0);
    CHECK(summed.finer(2.0) == 1.0);
    const Grading rounded = sieve_grading({1.0, 2.0}, {0.0, 0.9999999999999999}, SieveOptions{""});
    CHECK(rounded.finer(2.0) == 1.0);
    const Grading open = sieve_grading({1.0, 2.0, 3.0}, {0.0, 0.5, 0.95}, SieveOptions{"", true});
    CHECK(open.finer(2.0) == doctest::Approx(0.5).epsilon(1e-14));
    CHECK_THROWS_AS(sieve_grading({1.0, 2.0}, {0.0, 0.85}, SieveOptions{"", true}), ParameterError);
    CHECK_THROWS_AS(sieve_grading({1.0, 2.0}, {0.0, 1.05}, SieveOptions{""}), ParameterError);
    CHECK_THROWS_AS(sieve_grading({1.0, 2.0}, {0.0, 40.0}, SieveOptions{"", true}), ParameterError);
}

TEST_CASE("a sieve curve with an error in it is refused, naming row, value, rule and remedy") {
    const auto refused = [](const Numbers& size, const Numbers& finer, const char* text,
                            const std::string& unit = "mm", bool extend = false) {
        CHECK_REFUSED(sieve_grading(size, finer, SieveOptions{unit, extend}), text);
    };
    refused(
        {0.6, 0.3, 1.0}, {40.0, 50.0, 100.0},
        "row 1: 40 % finer at 0.6 mm is less than 50 % at 0.3 mm; cumulative per cent finer cannot fall with "
        "size. Retained percentages? convert them to per cent finer first");
    refused(
        {0.3, 0.6, 1.0}, {50.0, 40.0, 100.0},
        "row 2: 40 % finer at 0.6 is less than 50 % at 0.3; cumulative per cent finer cannot fall with size. "
        "Retained percentages? convert them to per cent finer first",
        "");
    refused({1.0, 2.0, 3.0}, {0.0, 50.0, 1.0},
            "row 3: 1 % finer at 3 mm is less than 50 % at 2 mm; cumulative per cent finer cannot fall with "
            "size. "
            "Retained percentages? convert them to per cent finer first");
    refused({0.5, 2.0, 0.5}, {0.0, 100.0, 10.0},
            "row 3: size 0.5 mm stands already in row 1; each sieve may appear once");
    refused({0.5, 0.0}, {0.0, 100.0}, "row 2: size is 0; it must be greater than 0 and finite");
    refused({-0.5, 1.0}, {0.0, 100.0}, "row 1: size is -0.5; it must be greater than 0 and finite");
    refused({0.5, not_a_number}, {0.0, 100.0}, "row 2: size is nan; it must be greater than 0 and finite");
    refused({0.5, infinity}, {0.0, 100.0}, "row 2: size is inf; it must be greater than 0 and finite");
    refused({0.5, 1.0}, {not_a_number, 100.0}, "row 1: percent_finer is nan; it must be between 0 and 100");
    refused({0.5, 1.0}, {-1.0, 100.0}, "row 1: percent_finer is -1; it must be between 0 and 100");
    refused({0.5, 1.0}, {0.0, 100.5}, "row 2: percent_finer is 100.5; it must be between 0 and 100");
    refused({0.5}, {100.0}, "the sieve curve has 1 points; it must have at least 2");
    refused({}, {}, "the sieve curve has 0 points; it must have at least 2");
    refused({0.5, 1.0}, {0.0, 90.0},
            "the coarsest sieve, 1 mm, has 90 % finer, not 100 %; add the size that all grains pass, or set "
            "extend_top to carry the last slope on to 100 %");
    refused(
        {0.5, 1.0}, {90.0, 90.0},
        "the coarsest sieve, 1 um, has 90 % finer, not 100 %; the curve is flat there and has no slope to "
        "carry on. Add the size that all grains pass",
        "um", true);
    refused(
        {0.5, 1.0, 2.0}, {30.0, 30.0, 100.0},
        "30 % is finer than the finest sieve, 0.5 mm, and the curve is flat above it, so no tail can be read "
        "from it; add a size with 0 % finer");
    CHECK_THROWS_WITH_AS(sieve_grading({0.5, 1.0}, {100.0}),
                         "percent_finer has 1 entries; it must have one for each of the 2 sizes", ShapeError);
}

TEST_CASE("a percentile is the size below which that share of the mass lies") {
    // Edges of this grid are at powers of 2: a curve with its points there is exact on it.
    const double h = std::log(2.0);
    const LogGrid grid(-7.5 * h, 0.5 * h, 9);
    const Grading sand =
        sieve_grading({1.0 / 16, 1.0 / 4, 1.0 / 2, 1.0, 2.0}, {0.0, 20.0, 50.0, 50.0, 100.0});
    const Numbers cdf = cdf_of(sand, grid);
    CHECK(percentile(grid, cdf, 20.0) == doctest::Approx(0.25).epsilon(1e-13));
    CHECK(percentile(grid, cdf, 10.0) == doctest::Approx(0.125).epsilon(1e-13));
    CHECK(percentile(grid, cdf, 5.0) == doctest::Approx(0.0625 * std::sqrt(2.0)).epsilon(1e-13));
    CHECK(percentile(grid, cdf, 50.0) == doctest::Approx(0.5).epsilon(1e-11));  // lower end of the plateau
    CHECK(percentile(grid, cdf, 50.0 + 1e-6) == doctest::Approx(1.0).epsilon(1e-7));
    CHECK(percentile(grid, cdf, 75.0) == doctest::Approx(std::sqrt(2.0)).epsilon(1e-13));
    CHECK(percentile(grid, cdf, 100.0) == doctest::Approx(2.0).epsilon(1e-13));
    const LogGrid fine(-6.0, 0.0, 121);
    const Numbers power = cdf_of(power_law(2.5, 1e-2, 1.0), fine);
    for (const double percent : {1.0, 10.0, 50.0, 90.0}) {
        const double root = 0.1 + percent / 100.0 * 0.9;  // F = (s^1/2 - 0.1) / 0.9
        // linear interpolation over h = 0.05: h^2 / 8 of the slope's change
        CHECK(percentile(fine, power, percent) == doctest::Approx(root * root).epsilon(2e-3));
    }
}

TEST_CASE("a percentile where no size is known is refused, or continued as a power law if asked for") {
    const LogGrid grid(-0.5, 6.5, 8);
    const Numbers half(8, 0.5);
    CHECK_REFUSED(percentile(grid, half, 10.0),
                  "D10 lies in the fines bin, which holds 50 % below a size of 1; lower "
                  "psi_min to resolve it, or set extrapolate");
    CHECK_REFUSED(percentile(grid, half, 75.0), "D75 lies above the largest size: only 50 % are finer");
    CHECK_REFUSED(percentile(grid, half, 100.1), "percent is 100.1; it must be between 0 and 100");
    CHECK_REFUSED(percentile(grid, half, -1.0), "percent is -1; it must be between 0 and 100");
    CHECK_REFUSED(percentile(grid, half, not_a_number), "percent is nan; it must be between 0 and 100");
    CHECK_THROWS_WITH_AS(percentile(grid, Numbers(9, 0.5), 10.0), "cdf has 9 entries; the grid has 8 bins",
                         ShapeError);
    Numbers power(8);
    for (Index i = 0; i < 8; ++i)
        power[at(i)] = std::exp(0.6 * (grid.edge(i + 1) - 7.0));  // F = (s / s_M)^0.6, s_M = e^7
    for (const double percent : {0.01, 0.3, 1.4}) {
        CHECK(percentile(grid, power, percent, true) ==
              doctest::Approx(std::exp(7.0) * std::pow(percent / 100.0, 1.0 / 0.6)).epsilon(1e-12));
        CHECK_THROWS_AS(percentile(grid, power, percent), ParameterError);
    }
    power[0] = 0.0;  // no curve to continue: refused, not NaN
    CHECK_THROWS_AS(percentile(grid, power, 1e-11, true), ParameterError);
}

TEST_CASE("a fitting grid ends at the largest grain and clears the crush zone of the largest load") {
    struct Standard {
        Grading grading;
        double finest;
        bool points;
    };
    const Standard cases[] = {{monodisperse(1.0), 1.0, true},
                              {gap_graded(1.0, 0.1), 0.1, true},
                              {power_law(2.5, 1e-3, 1.0), 1e-3, false},
                              {power_law(2.0, 0.9, 1.0), 0.9, false},
                              {comminute::fuller(1.0), 1e-6, false}};  // 0.1 % are finer than 1e-6
    for (const Standard& c : cases) {
        for (const double stress_ratio : {0.0, 0.9, 1.0, 10.0, 1e4}) {
            for (const double spacing : {0.05, 0.02, 0.013}) {
                const LogGrid grid = fitting_grid(c.grading, Material{}, stress_ratio, spacing);
                CHECK(grid.spacing() <= spacing * (1.0 + 1e-12));
                CHECK(grid.edge(1) < std::log(c.finest) + 0.01);
                CHECK(comminute::CrushZones(grid, Material{}, stress_ratio).distrusted_below() == -infinity);
                if (c.points) {
                    CHECK(grid.centre(grid.bins() - 1) == 0.0);
                    CHECK(std::abs(grid.centre(grid.bin_of(std::log(c.finest))) - std::log(c.finest)) <
                          1e-12);
                } else {
                    CHECK(std::abs(grid.edge(grid.bins())) < 1e-12);
                }
                CHECK(std::abs(helpers::sum_of(c.grading.on_grid(grid)) - 1.0) < 1e-15);
            }
        }
    }
    for (const double n :
         {0.5, 1.0, 2.0}) {  // a wider fabric reaches further down beside a grain that crushes
        const LogGrid wide = fitting_grid(monodisperse(1.0), helpers::material(n), 100.0);
        CHECK(comminute::CrushZones(wide, helpers::material(n), 100.0).distrusted_below() == -infinity);
    }
    // of several point masses the two coarsest lie on centres
    const Grading three{PointMasses{{0.013, 0.3, 1.7}, {0.2, 0.3, 0.5}}, "", {}};
    const LogGrid grid = fitting_grid(three, Material{}, 5.0);
    for (const double size : {0.3, 1.7}) {
        CHECK(std::abs(grid.centre(grid.bin_of(std::log(size))) - std::log(size)) < 1e-12);
    }
}

TEST_CASE("a fitting grid is refused where no load bounds it, and stays finite for a nearly flat tail") {
    CHECK_REFUSED(
        fitting_grid(monodisperse(1.0), Material{}, infinity),
        "max_stress_ratio is inf; it must be finite; with no bound on the load a grid must be given");
    CHECK_REFUSED(fitting_grid(monodisperse(1.0), Material{}, -1.0),
                  "stress_ratio is -1; it must be a number of at least 0 (0 is no load)");
    CHECK_REFUSED(fitting_grid(monodisperse(1.0), Material{}, 1.0, 0.0),
                  "spacing is 0; it must be greater than 0 and finite");
    // A tail of slope 3e-4 runs on for thousands of decades; a state on this grid must still fit in memory.
    const Grading flat = sieve_grading({1.0, 2.0, 4.0}, {50.0, 50.01, 100.0});
    CHECK(flat.notes.size() == 1);
    Index bins = 0;
    std::string refusal;
    try {
        bins = fitting_grid(flat, Material{}, 10.0).bins();
    } catch (const ParameterError& error) {  // if so, then not about a psi_min that nobody gave
        refusal = error.what();
    }
    CHECK(bins < 20000);
    CHECK(refusal.find("psi_min") == std::string::npos);
}

TEST_CASE("a fitting grid keeps to the bins and ends that are given, and still holds the grading") {
    const Grading gap = gap_graded(2.0, 0.2);
    const Grading spread = power_law(2.5, 0.0, 2.0);
    const double top = std::log(2.0);
    for (const auto& grading : {gap, spread}) {
        const bool points = grading == gap;
        const auto fit = [&](const GridOptions& options) {
            return fitting_grid(grading, Material{}, 50.0, options);
        };
        const LogGrid free = fit({});
        GridOptions options;
        options.bins = 100;
        for (const auto& low : {std::optional<double>{}, std::optional<double>{-5.0}}) {
            options.psi_min = low;
            const LogGrid grid = fit(options);
            CHECK(grid.bins() == 100);
            if (low) CHECK(grid.psi_min() == -5.0);
            // the largest grain lies on the last centre, or at the last edge
            CHECK((points ? grid.psi_max() : grid.edge(100)) == doctest::Approx(top).epsilon(1e-14));
            if (points && !low)
                CHECK(std::abs(grid.centre(grid.bin_of(std::log(0.2))) - std::log(0.2)) < 1e-12);
        }
        options = {};
        options.psi_max = 1.0;
        CHECK(fit(options).psi_min() == free.psi_min());
        CHECK(fit(options).psi_max() == 1.0);
        CHECK(fit(options).spacing() <= free.spacing());
        options.psi_min = -5.0;
        CHECK(fit(options).psi_min() == -5.0);
        CHECK(fit(options).spacing() <= free.spacing());
        options.bins = 99;  // nothing is left to fit, so that no load needs to bound it
        CHECK(fitting_grid(grading, Material{}, infinity, options) == LogGrid(-5.0, 1.0, 99));
    }
    CHECK(fitting_grid(spread, Material{}, 50.0, 0.05) ==
          fitting_grid(spread, Material{}, 50.0, GridOptions{0.05}));
}

TEST_CASE("bins and ends that make no grid are refused") {
    const auto refused = [](std::optional<Index> bins, std::optional<double> low,
                            std::optional<double> high) {
        return fitting_grid(gap_graded(1.0, 0.1), Material{}, 10.0, GridOptions{0.02, bins, low, high});
    };
    for (const Index bins : {Index{-3}, Index{0}, Index{1}, Index{7}}) {
        CHECK_REFUSED(refused(bins, {}, {}),
                      ("bins is " + std::to_string(bins) + "; it must be at least 8").c_str());
    }
    CHECK_REFUSED(refused({}, 3.0, {}), "psi_min is 3 and psi_max is 0; psi_min must be less than psi_max");
    CHECK_REFUSED(refused({}, 3.0, 2.0), "psi_min is 3 and psi_max is 2; psi_min must be less than psi_max");
    CHECK_REFUSED(refused({}, not_a_number, {}), "psi_min is nan; it must be finite");
    CHECK_REFUSED(refused({}, {}, infinity), "psi_max is inf; it must be finite");
    CHECK_REFUSED(refused(100, {}, -infinity), "psi_max is -inf; it must be finite");
}

TEST_CASE("two sizes that hardly differ do not make a state too large for any memory") {
    CHECK(fitting_grid(gap_graded(1.0, 0.9999), Material{}, 10.0).bins() < 20000);
}

TEST_CASE("the finest sizes are found in a tail over hundreds of decades") {
    const Grading rammler = comminute::rosin_rammler(1.0, 0.01);
    CHECK(rammler.finer(rammler.smallest(5e-3)) == doctest::Approx(5e-3).epsilon(1e-9));
}

TEST_CASE("a grading's inverse finds every share of its cdf again, and plateaus at their lower end") {
    const comminute::Grading gradings[] = {comminute::power_law(2.5, 1e-3, 1.0),
                                           comminute::power_law(3.4, 1e-3, 1.0),
                                           comminute::log_uniform(0.1, 2.0),
                                           comminute::fuller(16.0),
                                           comminute::lognormal(0.3, 0.8),
                                           comminute::lognormal(0.3, 0.8, 0.2),
                                           comminute::rosin_rammler(0.5, 1.5),
                                           comminute::rosin_rammler(0.5, 1.5, 0.4),
                                           comminute::sieve_grading({0.5, 1.0, 2.0}, {10.0, 50.0, 100.0})};
    for (const comminute::Grading& grading : gradings) {
        for (const double share : {1e-6, 1e-3, 0.1, 0.3, 0.6, 0.9, 0.99}) {
            CAPTURE(share);
            CHECK(std::abs(grading.finer(grading.quantile(share)) - share) < 2e-12);
            CHECK(grading.percentile(100.0 * share, true) ==
                  doctest::Approx(grading.quantile(share)).epsilon(1e-13));
        }
        CHECK(grading.quantile(1.0) == doctest::Approx(grading.largest()).epsilon(1e-15));
    }
    const auto gap = comminute::gap_graded(1.0, 0.1, 0.25);
    CHECK(gap.quantile(0.75) == 0.1);
    CHECK(gap.quantile(0.75 + 1e-9) == 1.0);
    const auto flat = comminute::sieve_grading({0.5, 1.0, 2.0, 4.0}, {0.0, 50.0, 50.0, 100.0});
    CHECK(flat.quantile(0.5) == 1.0);
    CHECK(flat.quantile(0.5 + 1e-9) > 2.0);
    CHECK_REFUSED(gap.quantile(0.0), "share is 0; it must be greater than 0 and at most 1");
}

TEST_CASE("a curve ends at the largest grain, and jumps at the sizes that were given") {
    const LogGrid grid(-6.0, 0.1, 62);
    const comminute::Fabric equal = comminute::mixed_fabric(comminute::gap_graded(1.0, 0.1), grid);
    CHECK(equal.largest() == 1.0);
    REQUIRE(equal.points().size() == 2);
    CHECK(equal.points()[0].size == 0.1);
    comminute::QuasiStatic solver(grid, comminute::Material{});
    const comminute::Fabric crushed = comminute::remix(solver.solve(equal, 4.0));
    CHECK(crushed.largest() == 1.0);
    CHECK(crushed.points()[0].size == 0.1);
    const auto cdf = crushed.cdf();
    const auto curve = comminute::curve_on_grid(grid, comminute::VectorView<const double>(cdf),
                                                crushed.points(), crushed.largest());
    CHECK(curve.size.back() == 1.0);
    CHECK(std::count(curve.size.begin(), curve.size.end(), 0.1) == 2);
    CHECK(percentile(grid, cdf, 100.0, false, crushed.points(), 1.0) == 1.0);
    const auto spread = crushed.binned();  // nothing is known of its largest grain
    CHECK(percentile(grid, spread.cdf(), 100.0, false, spread.points(), spread.largest()) > 1.0);
    // mass of the coarsest bin alone: even in ln d up to the largest grain
    const Numbers one_bin{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0};
    const LogGrid small(-7.0, 0.0, 8);
    CHECK(percentile(small, one_bin, 50.0, false, {}, 1.0) ==
          doctest::Approx(std::exp(-0.25)).epsilon(1e-12));
    CHECK_REFUSED(percentile(small, one_bin, 50.0, false, {}, -1.0),
                  "largest is -1; it must be a size, or 0 where it is not known");
}
