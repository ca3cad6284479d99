// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include "support/helpers.hpp"

using comminute::LogGrid;
using comminute::ParameterError;
using helpers::Index;

TEST_CASE("centres and edges of a grid are evenly spaced") {
    const LogGrid grid(-6.0, 1.0, 351);
    CHECK(grid.bins() == 351);
    CHECK(grid.psi_min() == -6.0);
    CHECK(grid.psi_max() == 1.0);
    CHECK(grid.spacing() == 7.0 / 350.0);
    const double rounding = 4e-15;  // a few units in the last place of 6
    for (Index i = 0; i < 351; ++i) {
        const double centre = -6.0 + 0.02 * static_cast<double>(i);
        CHECK(std::abs(grid.centre(i) - centre) < rounding);
        CHECK(std::abs(grid.edge(i) - (centre - 0.01)) < rounding);
    }
    CHECK(std::abs(grid.edge(351) - 1.01) < rounding);
}

TEST_CASE("both ends of a grid are exact whatever they are") {
    std::mt19937_64 random(11);
    std::uniform_real_distribution<double> end(-9.0, 3.0);
    int inexact = 0;
    for (Index bins = 8; bins < 2008; ++bins) {
        const double a = end(random);
        const double b = end(random);
        const LogGrid grid(std::min(a, b), std::max(a, b), bins);
        if (grid.centre(0) != grid.psi_min() || grid.centre(bins - 1) != grid.psi_max()) ++inexact;
    }
    CHECK(inexact == 0);
}

TEST_CASE("a bin centre at zero is exactly zero") {
    for (Index below = 1; below <= 40; ++below) {
        for (Index above = 1; above <= 8; ++above) {
            for (const Index per_unit : {1, 3, 7, 10, 50, 127}) {
                const Index bins = (below + above) * per_unit + 1;
                if (bins < 8) continue;
                const LogGrid grid(-0.25 * static_cast<double>(below), 0.25 * static_cast<double>(above),
                                   bins);
                REQUIRE(grid.centre(below * per_unit) == 0.0);
            }
        }
    }
}

TEST_CASE("bin_of finds the bin whose edges enclose a log size") {
    const LogGrid grid(-2.0, 1.0, 25);  // spacing 1/8: edges are exact, so each belongs to the bin above it
    for (Index i = 1; i < 25; ++i) {
        CHECK(grid.bin_of(grid.edge(i)) == i);
        CHECK(grid.bin_of(grid.edge(i) - 1e-14) == i - 1);
        CHECK(grid.bin_of(grid.centre(i)) == i);
    }
    CHECK(grid.bin_of(grid.edge(25)) == 24);  // the top edge is the one closed one

    std::mt19937_64 random(12);
    for (int q = 0; q < 200; ++q) {
        const double low = std::uniform_real_distribution<double>(-20.0, 5.0)(random);
        const auto bins = std::uniform_int_distribution<Index>(8, 900)(random);
        const LogGrid any(low, low + helpers::log_uniform(random, 0.01, 30.0), bins);
        const auto i = std::uniform_int_distribution<Index>(1, bins - 1)(random);
        const double inside = 1e-9 * any.spacing() + 1e-14 * std::max(std::abs(low), std::abs(any.psi_max()));
        REQUIRE(any.bin_of(any.edge(i) + inside) == i);
        REQUIRE(any.bin_of(any.edge(i) - inside) == i - 1);
        REQUIRE(any.bin_of(any.centre(i)) == i);
    }
}

TEST_CASE("everything below a grid is in the fines bin, nothing is above it") {
    const LogGrid grid(-6.0, 1.0, 8);
    CHECK(grid.bin_of(-6.5) == 0);
    CHECK(grid.bin_of(-1e300) == 0);
    CHECK(grid.bin_of(-helpers::infinity) == 0);
    CHECK(grid.bin_of(1.5 + 1e-13) == 7);  // a rounding error above the edge
    CHECK_REFUSED(grid.bin_of(1.5 + 1e-9),
                  "a log size of 1.500000001 lies above the grid's top edge, 1.5; raise psi_max");
    CHECK_REFUSED(grid.bin_of(helpers::infinity),
                  "a log size of inf lies above the grid's top edge, 1.5; raise psi_max");
    CHECK_REFUSED(grid.bin_of(helpers::not_a_number),
                  "a log size of nan lies above the grid's top edge, 1.5; raise psi_max");
}

TEST_CASE("a grid refuses what is no range, naming the value and the rule") {
    using helpers::infinity;
    CHECK_REFUSED(LogGrid(-1.0, 1.0, 7), "bins is 7; it must be at least 8");
    CHECK_REFUSED(LogGrid(-1.0, 1.0, -3), "bins is -3; it must be at least 8");
    CHECK_NOTHROW(LogGrid(-1.0, 1.0, 8));
    CHECK_REFUSED(LogGrid(1.0, -1.0, 8), "psi_min is 1 and psi_max is -1; psi_min must be less than psi_max");
    CHECK_REFUSED(LogGrid(0.5, 0.5, 8),
                  "psi_min is 0.5 and psi_max is 0.5; psi_min must be less than psi_max");
    CHECK_REFUSED(LogGrid(helpers::not_a_number, 1.0, 8), "psi_min is nan; it must be finite");
    CHECK_REFUSED(LogGrid(-1.0, helpers::not_a_number, 8), "psi_max is nan; it must be finite");
    CHECK_REFUSED(LogGrid(-infinity, 1.0, 8), "psi_min is -inf; it must be finite");
    CHECK_REFUSED(LogGrid(-1.0, infinity, 8), "psi_max is inf; it must be finite");
}

TEST_CASE("grids are equal when both ends and the number of bins are") {
    const LogGrid grid(-6.0, 1.0, 64);
    CHECK(grid == LogGrid(-6.0, 1.0, 64));
    CHECK(grid != LogGrid(-6.0, 1.0, 65));
    CHECK(grid != LogGrid(-6.0, 1.5, 64));
    CHECK(grid != LogGrid(-6.5, 1.0, 64));
}

TEST_CASE("numbers in messages are the shortest that read back the same") {
    CHECK(comminute::text(0.1) == "0.1");
    CHECK(comminute::text(1.0) == "1");
    CHECK(comminute::text(-2.5e-7) == "-2.5e-07");
    CHECK(comminute::text(helpers::infinity) == "inf");
    CHECK(comminute::text(helpers::not_a_number) == "nan");
    std::mt19937_64 random(13);
    for (int q = 0; q < 100; ++q) {
        const double value = helpers::log_uniform(random, 1e-30, 1e30);
        REQUIRE(std::stod(comminute::text(value)) == value);
    }
}
