// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include "support/helpers.hpp"

using comminute::FullConvolution;
using comminute::KernelKind;
using comminute::LogGrid;
using comminute::Material;
using comminute::Scheme;
using comminute::SlowUpdate;
using comminute::StepReport;
using helpers::at;
using helpers::Index;
using helpers::log_uniform;
using helpers::material;
using helpers::random_state;
using helpers::State;

TEST_CASE("the slow update moves a large state as its cells one by one") {
    std::mt19937_64 random(40);
    const Index n = 300;  // 45 000 cells crush in psi: more than one block of the engine's buffer
    const LogGrid grid(-6.0, 0.5, n);
    for (const double width : {0.05, 2.0}) {
        const Material m = material(width);
        const comminute::FragmentPmf f = comminute::fragment_pmf(m.fragments, grid.spacing(), n);
        const State start = random_state(n, random, 1.0, 0.2);
        State expected = start;
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; j < n; ++j) {
                const double load =
                    helpers::log_critical(m, grid.centre(std::max(i, j)), grid.centre(std::min(i, j)));
                if (i + j == 0 || load > std::log(2000.0)) continue;
                const double mass = start(i, j);
                const double in_psi = i > j ? mass : i == j ? 0.5 * mass : 0.0;
                expected(i, j) -= mass;
                for (Index t = 0; t < i; ++t) expected(i - t, j) += in_psi * f.mass[at(t)];
                for (Index t = 0; t < j; ++t) expected(i, j - t) += (mass - in_psi) * f.mass[at(t)];
                expected(0, j) += in_psi * f.below[at(i)];
                expected(i, 0) += (mass - in_psi) * f.below[at(j)];
            }
        }
        SlowUpdate engine(grid, m);
        State p = start;
        engine.step(p.view(), 2000.0, p.view());
        CHECK(helpers::largest_difference(p.mass, expected.mass) < 1e-15);
    }
}

#ifdef COMMINUTE_HAS_FFTW

TEST_CASE("the slow update equals the full convolution with the slow kernel") {
    std::mt19937_64 random(35);
    for (const Index bins : {8, 31, 64, 127}) {
        for (const Scheme scheme : {Scheme::paper, Scheme::conservative}) {
            const Material m = material(log_uniform(random, 0.03, 1.0));
            const LogGrid grid(-5.0, 0.4, bins);
            SlowUpdate slow(grid, m, {scheme});
            FullConvolution full(grid, m, {{KernelKind::slow, 0.0, scheme}});
            State a = random_state(bins, random, 1.0, 0.2);
            State b = a;
            for (double stress_ratio = 0.8; stress_ratio < 1e4; stress_ratio *= 3.0) {
                const StepReport by_slow = slow.step(a.view(), stress_ratio, a.view());
                const StepReport by_full = full.step(b.view(), stress_ratio, b.view());
                CHECK(helpers::largest_difference(a.mass, b.mass) < 1e-13);
                CHECK(std::abs(by_slow.crushed - by_full.crushed) < 1e-13);
                CHECK(std::abs(by_slow.crushed_neighbour - by_full.crushed_neighbour) < 1e-13);
            }
        }
    }
}

#endif
