// SPDX-License-Identifier: BSD-3-Clause
// One step of the three-cell law by hand, and what every step keeps.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "resolved/random_case.hpp"
#include "resolved/triple_state.hpp"
#include "support/helpers.hpp"

using comminute::Mean;
using comminute::ResolvedGrid;
using comminute::detail::TripleScratch;
using comminute::detail::TripleState;
using comminute::detail::TripleTables;
using helpers::Index;
using helpers::RandomCase;
using helpers::with_width;

TEST_CASE("one step by hand: half of equal grains are overrun, and no more than two ninths crush at once") {
    const ResolvedGrid grid({-3.0, -1.0, 0.0}, {-1.0, 0.0, 0.0});
    const comminute::Material material = with_width(0.05);
    const TripleTables tables(grid, material, Mean::arithmetic);
    TripleScratch scratch(tables);
    TripleState state(tables, std::vector<double>{0.0, 0.0, 1.0});
    const double tie = 0.002 * 0.05 * 0.05;
    CHECK(state.overrun_mass(tables, -0.5 * tie) == doctest::Approx(0.5).epsilon(1e-12));
    state.step(tables, -0.5 * tie, scratch);
    CHECK(state.avalanches() == doctest::Approx(0.5).epsilon(1e-12));
    const std::vector<double> pmf = state.pmf(tables);
    CHECK(pmf[2] == doctest::Approx(7.0 / 9.0).epsilon(1e-14));
    CHECK(state.mass(tables, 2, 2, 2) == doctest::Approx(1.0 / 3.0).epsilon(1e-14));
    double pair = 0.0;
    for (Index c = 0; c < 3; ++c) pair += state.mass(tables, 2, 2, c);
    CHECK(pair == doctest::Approx(5.0 / 9.0).epsilon(1e-14));
    double pending = 0.0;
    for (const double mass : state.pending()) pending += mass;
    CHECK(pending == doctest::Approx(5.0 / 42.0).epsilon(1e-12));
    CHECK(state.crushes() == doctest::Approx(2.0 / 9.0).epsilon(1e-14));
}

TEST_CASE("mass, mirror symmetry and the pair's two sides are kept, and nothing is negative") {
    for (unsigned seed = 0; seed < 12; ++seed) {
        CAPTURE(seed);
        const RandomCase c = RandomCase::draw(seed);
        const TripleTables tables(c.grid, c.material, c.options.mean);
        TripleScratch scratch(tables);
        TripleState state(tables, c.pmf);
        const Index nodes = tables.nodes();
        double log_load = tables.log_stress_ratio(tables.lowest_level());
        const double end = std::log(200.0);
        while (log_load < end) {
            log_load = std::min(log_load + 0.25, end);  // far coarser than the clock's, to need the limiter
            state.step(tables, tables.level(log_load), scratch);
        }
        double least = 0.0;
        for (const double mass : state.settled()) least = std::min(least, mass);
        for (const double mass : state.pending()) least = std::min(least, mass);
        CHECK(least >= -1e-18);
        double asymmetry = 0.0;
        double sides = 0.0;
        double total = 0.0;
        for (Index a = 0; a < nodes; ++a) {
            for (Index b = 0; b < nodes; ++b) {
                double right = 0.0;
                double left = 0.0;
                for (Index k = 0; k < nodes; ++k) {
                    right += state.mass(tables, b, a, k);
                    left += state.mass(tables, a, b, k);
                    asymmetry = std::max(asymmetry,
                                         std::abs(state.mass(tables, b, a, k) - state.mass(tables, b, k, a)));
                }
                sides = std::max(sides, std::abs(right - left));
                total += right;
            }
        }
        CHECK(asymmetry == 0.0);
        CHECK(sides < 1e-13);
        CHECK(std::abs(total - 1.0) < 1e-13);
    }
}
