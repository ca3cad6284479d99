// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include "support/helpers.hpp"

using comminute::FullConvolution;
using comminute::Kernel;
using comminute::KernelKind;
using comminute::StepPath;
using helpers::at;
using helpers::Index;
using helpers::State;

namespace {

constexpr double load = 2000.0;

// The step written out: what crushes, by Eq. 2 afresh, and plain sums along rows and then along columns.
State summed_step(const Kernel& kernel, const State& start) {
    const comminute::LogGrid& grid = kernel.grid();
    const comminute::FragmentPmf& f = kernel.fragments();
    const bool fast = kernel.kind() == KernelKind::fast;
    const bool slow = kernel.kind() == KernelKind::slow;
    State out = start;
    State in_psi(start.bins);
    const auto spread_row = [&f](State& to, Index i, Index j, double mass) {
        for (Index t = 0; t < j; ++t) to(i, j - t) += mass * f.mass[at(t)];
        to(i, 0) += mass * f.below[at(j)];
    };
    for (Index i = 0; i < start.bins; ++i) {
        for (Index j = i == 0 ? 1 : 0; j < start.bins; ++j) {
            const comminute::Material& m = kernel.material();
            const double mass = start(i, j);
            bool grain = helpers::log_critical(m, grid.centre(i), grid.centre(j)) <= std::log(load);
            bool neighbour = helpers::log_critical(m, grid.centre(j), grid.centre(i)) <= std::log(load);
            if (!grain && !neighbour) continue;
            if (fast) grain = neighbour = true;
            if (slow) {
                grain = i > j;
                neighbour = i < j;
            }
            out(i, j) -= mass;
            if (grain && neighbour) spread_row(in_psi, i, j, mass);
            if (grain && !neighbour) in_psi(i, j) += mass;
            if (neighbour && !grain) spread_row(out, i, j, mass);
        }
    }
    for (Index i = 0; i < start.bins; ++i) {
        for (Index t = 0; t <= i; ++t) {
            const double share = t < i ? f.mass[at(t)] : f.below[at(i)];
            for (Index j = 0; j < start.bins; ++j) out(i - t, j) += share * in_psi(i, j);
        }
    }
    return out;
}

}  // namespace

TEST_CASE("one step moves states of every extent as plain sums do") {
    std::mt19937_64 random(60);
    // Lines of every length and every extent of mass; 150 and 300 bins leave a part of eight columns at the end.
    for (const Index n : {8, 11, 64, 150, 300}) {
        for (const double width : {0.02, 0.3, 5.0}) {
            for (const KernelKind kind : {KernelKind::exact, KernelKind::fast}) {
                CAPTURE(n);
                CAPTURE(width);
                const Kernel kernel(
                    comminute::LogGrid(-6.0, 0.5, n), helpers::material(width), kind, 0.0,
                    n % 2 == 0 ? comminute::FragmentRule::conservative : comminute::FragmentRule::paper);
                for (const bool sparse : {false, true}) {
                    State start = helpers::random_state(n, random);
                    if (sparse) {  // a handful of cells, some of them in rows and columns of their own
                        for (double& mass : start.mass) mass *= random() % at(n * n) < 6 ? 1.0 : 0.0;
                        start(n - 1, n - 2) = start(n / 3, n / 3 + 1) = 0.5;
                    }
                    const State expected = summed_step(kernel, start);
                    for (const StepPath path : helpers::step_paths(kernel)) {
                        State p = start;
                        FullConvolution(kernel, path).step(p.view(), load, p.view());
                        CHECK(helpers::largest_difference(p.mass, expected.mass) < 2e-15);
                        CHECK(helpers::smallest_entry(p.mass) >= 0.0);
                    }
                }
            }
        }
    }
}

TEST_CASE("a line with next to no mass comes out right beside one with much") {
    std::mt19937_64 random(61);
    const Index n = 61;
    const Kernel kernel(comminute::LogGrid(-6.0, 0.5, n), helpers::material(1.0), KernelKind::slow);
    const double scales[] = {1.0, 1e-40, 1e-250};
    for (const bool rows : {true, false}) {  // what crushes in psibar stays in its row, else in its column
        State start = helpers::random_state(n, random);
        std::vector<double> line_mass(at(n), 0.0);
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; j < n; ++j) {
                const Index line = rows ? i : j;
                start(i, j) *= (rows ? i < j : i > j) ? scales[line % 3] : 0.0;
                line_mass[at(line)] += start(i, j);
            }
        }
        const State expected = summed_step(kernel, start);
        for (const StepPath path : helpers::step_paths(kernel)) {
            State p = start;
            FullConvolution(kernel, path).step(p.view(), load, p.view());
            double worst = 0.0;
            for (Index i = 0; i < n; ++i) {
                for (Index j = 0; j < n; ++j) {
                    const double mass = line_mass[at(rows ? i : j)];
                    if (mass > 0.0) worst = std::max(worst, std::abs(p(i, j) - expected(i, j)) / mass);
                }
            }
            CHECK(worst < 1e-14);
            CHECK(helpers::smallest_entry(p.mass) >= 0.0);
        }
    }
}

TEST_CASE("a step says by what means it was taken, and refuses sums that a law does not have") {
    const comminute::LogGrid grid(-6.0, 0.5, 40);
    std::mt19937_64 random(62);
    const State start = helpers::random_state(40, random);
    State out = start;
    const Kernel weibull(grid, comminute::Material{}, KernelKind::exact);
    FullConvolution by_choice(weibull);
    CHECK(by_choice.path() == StepPath::automatic);
    CHECK(by_choice.step(start.view(), load, out.view()).terms == 11);

    comminute::Material material;
    material.fragments = comminute::LogNormalFragments{};
    const Kernel lognormal(grid, material, KernelKind::exact);
    CHECK_REFUSED(
        FullConvolution(lognormal, StepPath::sums),
        "path is sums, but these fragments have no accurate exponential sum on this grid; use automatic or "
        "transforms");
#ifdef COMMINUTE_HAS_FFTW
    CHECK(FullConvolution(lognormal).step(start.view(), load, out.view()).terms == 0);
#else
    CHECK_THROWS_WITH_AS(FullConvolution{lognormal}, doctest::Contains("libfftw3-dev"),
                         comminute::UnavailableError);
#endif
}
