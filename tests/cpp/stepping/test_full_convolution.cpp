// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <array>

#include "support/helpers.hpp"

using comminute::FullConvolution;
using comminute::FullConvolutionOptions;
using comminute::Kernel;
using comminute::KernelKind;
using comminute::LogGrid;
using comminute::Material;
using comminute::PlanEffort;
using comminute::PowerLawFragments;
using comminute::Scheme;
using comminute::StepPath;
using helpers::at;
using helpers::Index;
using helpers::infinity;
using helpers::material;
using helpers::random_state;
using helpers::State;

namespace {

constexpr double load = 2000.0;

FullConvolution engine_of(const Kernel& kernel, StepPath path) {
    return {kernel.grid(), kernel.material(), {kernel.options(), path}};
}

// The step written out: what crushes, by Eq. 2 afresh, and plain sums along rows and then along columns.
State summed_step(const Kernel& kernel, const State& start) {
    const LogGrid& grid = kernel.grid();
    const comminute::FragmentPmf& f = kernel.fragments();
    const bool fast = kernel.options().kind == KernelKind::fast;
    const bool slow = kernel.options().kind == KernelKind::slow;
    State out = start;
    State in_psi(start.bins);
    const auto spread_row = [&f](State& to, Index i, Index j, double mass) {
        for (Index t = 0; t < j; ++t) to(i, j - t) += mass * f.mass[at(t)];
        to(i, 0) += mass * f.below[at(j)];
    };
    for (Index i = 0; i < start.bins; ++i) {
        for (Index j = i == 0 ? 1 : 0; j < start.bins; ++j) {
            const Material& m = kernel.material();
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
                const Kernel kernel(LogGrid(-6.0, 0.5, n), material(width),
                                    {kind, 0.0, n % 2 == 0 ? Scheme::conservative : Scheme::paper});
                for (const bool sparse : {false, true}) {
                    State start = random_state(n, random);
                    if (sparse) {  // a handful of cells, some of them in rows and columns of their own
                        for (double& mass : start.mass) mass *= random() % at(n * n) < 6 ? 1.0 : 0.0;
                        start(n - 1, n - 2) = start(n / 3, n / 3 + 1) = 0.5;
                    }
                    const State expected = summed_step(kernel, start);
                    for (const StepPath path : helpers::step_paths(kernel)) {
                        State p = start;
                        engine_of(kernel, path).step(p.view(), load, p.view());
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
    const Kernel kernel(LogGrid(-6.0, 0.5, n), material(1.0), {KernelKind::slow, 0.0, Scheme::paper});
    const double scales[] = {1.0, 1e-40, 1e-250};
    for (const bool rows : {true, false}) {  // what crushes in psibar stays in its row, else in its column
        State start = random_state(n, random);
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
            engine_of(kernel, path).step(p.view(), load, p.view());
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
    const LogGrid grid(-6.0, 0.5, 40);
    std::mt19937_64 random(62);
    const State start = random_state(40, random);
    State out = start;
    FullConvolutionOptions exact;
    exact.kind = KernelKind::exact;
    exact.scheme = Scheme::paper;
    FullConvolution by_choice(grid, Material{}, exact);
    CHECK(by_choice.options().path == StepPath::automatic);
    CHECK(by_choice.step(start.view(), load, out.view()).terms == 11);

    Material lognormal;
    lognormal.fragments = comminute::LogNormalFragments{};
    FullConvolutionOptions by_sums = exact;
    by_sums.path = StepPath::sums;
    CHECK_REFUSED(FullConvolution(grid, lognormal, by_sums),
                  "path is sums; these fragments have no accurate exponential sum on this grid. Use the path "
                  "automatic, "
                  "or transforms");
#ifdef COMMINUTE_HAS_FFTW
    const StepPath without_sums = StepPath::transforms;
#else
    const StepPath without_sums = StepPath::direct;
#endif
    FullConvolution of_lognormal(grid, lognormal, exact);
    CHECK(of_lognormal.path() == without_sums);
    CHECK(of_lognormal.step(start.view(), load, out.view()).terms == 0);
    CHECK(by_choice.path() == StepPath::sums);
}

TEST_CASE("where everything crushes at every step the drops of psi are Gamma distributed") {
    Material m;
    m.fragments = PowerLawFragments{};  // uniform X: -R is exponential with mean 1
    const int crushes = 4;
    std::array<double, 3> variance_error{};
    std::array<double, 3> cdf_error{};
    std::array<double, 3> spacing{0.4, 0.2, 0.1};
    for (std::size_t level = 0; level < 3; ++level) {
        const double h = spacing[level];
        const auto below_top = static_cast<Index>(std::lround(50.0 / h));  // e^-50 is lost to the fines
        const Index n = below_top + 1;
        const LogGrid grid(-50.0, 0.0, n);
        FullConvolution engine(grid, m, {{KernelKind::fast}});
        State p(n);
        p(n - 1, n - 1) = 1.0;
        CHECK(comminute::settle(engine, p.view(), infinity, crushes).crushed ==
              doctest::Approx(crushes).epsilon(1e-14));
        const std::vector<double> pmf = p.by_grain();
        const double mean = helpers::mean_of(pmf, grid);
        CHECK(std::abs(mean + crushes) < 1e-13);
        double finer = 0.0;
        double worst_product = 0.0;
        for (Index i = 0; i < n; ++i) {
            const double psi = grid.centre(i);
            variance_error[level] += pmf[at(i)] * (psi - mean) * (psi - mean);
            finer += pmf[at(i)];
            const double x = -grid.edge(i + 1);
            const double gamma = x <= 0.0 ? 1.0 : std::exp(-x) * (1.0 + x + x * x / 2.0 + x * x * x / 6.0);
            cdf_error[level] = std::max(cdf_error[level], std::abs(finer - gamma));
            for (Index j = 0; j < n; ++j) {
                worst_product = std::max(worst_product, std::abs(p(i, j) - pmf[at(i)] * pmf[at(j)]));
            }
        }
        variance_error[level] -= crushes;
        CHECK(worst_product < 1e-15);
    }
    for (std::size_t level = 0; level < 2; ++level) {
        CHECK(variance_error[level] / variance_error[level + 1] == doctest::Approx(4.0).epsilon(0.02));
        CHECK(cdf_error[level] / cdf_error[level + 1] == doctest::Approx(4.0).epsilon(0.05));
    }
}

#ifdef COMMINUTE_HAS_FFTW

TEST_CASE("an engine's bits do not depend on what was planned before it") {
    std::mt19937_64 random(49);
    // a size that no other test plans with PlanEffort::measure
    const auto step = [](const State& from, State& to, PlanEffort effort) {
        const comminute::KernelOptions kernel{KernelKind::fast, 0.0, Scheme::paper};
        FullConvolution engine(LogGrid(-4.0, 0.0, 90), material(0.3), {kernel, StepPath::transforms, effort});
        engine.step(from.view(), 50.0, to.view());
    };
    const State start = random_state(90, random);
    State before = start;
    State measured = start;
    State after = start;
    step(start, before, PlanEffort::estimate);
    step(start, measured, PlanEffort::measure);
    step(start, after, PlanEffort::estimate);
    CHECK(before.mass == after.mass);
    CHECK(helpers::largest_difference(before.mass, measured.mass) < 1e-13);
}

TEST_CASE("a build with FFTW says so") {
    CHECK(comminute::has_fftw());
}

#else

TEST_CASE("without FFTW the full convolution says what is missing") {
    CHECK(!comminute::has_fftw());
    const FullConvolutionOptions options{{}, StepPath::transforms};
    CHECK_THROWS_WITH_AS(FullConvolution(LogGrid(-2.0, 0.0, 8), Material{}, options),
                         doctest::Contains("libfftw3-dev"), comminute::UnavailableError);
}

#endif
