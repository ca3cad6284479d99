// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include "support/helpers.hpp"

using comminute::CrushZones;
using comminute::KernelKind;
using comminute::LogGrid;
using comminute::Material;
using comminute::ParameterError;
using comminute::PowerLawFragments;
using comminute::Scheme;
using comminute::SlowUpdate;
using comminute::StepReport;
using comminute::Zone;
using helpers::all_engines;
using helpers::at;
using helpers::Engine;
using helpers::Index;
using helpers::infinity;
using helpers::material;
using helpers::random_state;
using helpers::State;

namespace {

constexpr auto schemes = {Scheme::paper, Scheme::conservative};

}  // namespace

TEST_CASE("settling leaves a state at rest, and one settling does the work of fifty small ones") {
    std::mt19937_64 random(36);
    const LogGrid grid(-6.0, 0.3, 50);
    const Material m = material(0.15);
    for (const Engine& engine : all_engines(grid, m)) {
        if (engine.kernel.options().kind == KernelKind::exact)
            continue;  // depends on the path: zone 11 grows
        CAPTURE(engine.name);
        const State start = random_state(50, random);
        State in_one_go = start;
        State in_steps = start;
        const StepReport report = engine.settle(in_one_go.view(), 200.0, 0, {});
        CHECK(report.active <= 1e-18);
        CHECK(report.steps > 5);
        const CrushZones zones(grid, m, 200.0);
        double active = 0.0;
        for (Index i = 0; i < 50; ++i) {
            for (Index j = 0; j < 50; ++j) active += zones.at(i, j) == Zone::rest ? 0.0 : in_one_go(i, j);
        }
        CHECK(active <= 1e-18);
        double crushed = 0.0;
        double crushed_neighbour = 0.0;
        for (int step = 1; step <= 50; ++step) {
            const StepReport part =
                engine.settle(in_steps.view(), 200.0 * std::exp(0.15 * (step - 50)), 0, {});
            crushed += part.crushed;
            crushed_neighbour += part.crushed_neighbour;
        }
        CHECK(helpers::largest_difference(in_one_go.mass, in_steps.mass) < 1e-14);
        CHECK(std::abs(crushed - report.crushed) < 1e-13);
        CHECK(std::abs(crushed_neighbour - report.crushed_neighbour) < 1e-13);
        const State rested = in_one_go;
        CHECK(engine.settle(in_one_go.view(), 150.0, 0, {}).steps == 1);  // unloading changes nothing
        CHECK(helpers::largest_difference(in_one_go.mass, rested.mass) < 1e-18);
    }
}

TEST_CASE("settling takes as many steps as asked for, or stops when told to") {
    std::mt19937_64 random(37);
    for (const Engine& engine : all_engines(LogGrid(-5.0, 0.0, 30), material(0.4))) {
        CAPTURE(engine.name);
        const State start = random_state(30, random, 3.0);
        State seven = start;
        State by_hand = start;
        const StepReport report = engine.settle(seven.view(), 60.0, 7, {});
        StepReport sum;
        for (int step = 0; step < 7; ++step) {
            const StepReport part = engine.step(by_hand.view(), 60.0, by_hand.view());
            sum.active = part.active;
            sum.crushed += part.crushed;
            sum.crushed_neighbour += part.crushed_neighbour;
        }
        CHECK(report.steps == 7);
        CHECK(report.active == sum.active);
        CHECK(report.crushed == sum.crushed);
        CHECK(report.crushed_neighbour == sum.crushed_neighbour);
        CHECK(seven.mass == by_hand.mass);

        State stopped = start;
        int asked = 0;
        CHECK(engine.settle(stopped.view(), 60.0, 0, [&] { return ++asked <= 7; }).steps == 7);
        CHECK(stopped.mass == by_hand.mass);
        stopped = start;
        CHECK(engine.settle(stopped.view(), 60.0, 5, [] { return false; }).steps == 0);
        CHECK(stopped.mass == start.mass);
        CHECK_REFUSED(engine.settle(stopped.view(), 60.0, -1, {}),
                      "steps is -1; it must be at least 0 (0 means until at rest)");
        State heavy = start;  // at rest means a share of the whole, whatever its unit
        State light = start;
        for (double& mass : heavy.mass) mass *= 1099511627776.0;
        for (double& mass : light.mass) mass /= 1099511627776.0;
        CHECK(engine.settle(heavy.view(), 60.0, 0, {}).steps ==
              engine.settle(light.view(), 60.0, 0, {}).steps);
        State nothing(30);
        CHECK(engine.settle(nothing.view(), 60.0, 0, {}).steps == 1);
    }
}

TEST_CASE("settling ends even where an entry at rest is not a number") {
    SlowUpdate engine(LogGrid(-3.0, 0.0, 16), Material{}, {Scheme::paper});
    State p(16);
    p(15, 15) = 1.0;
    p(15, 0) = helpers::not_a_number;  // far outside the zone: step() lets it pass
    int asked = 0;
    try {
        comminute::settle(engine, p.view(), 2.0, 0, [&] { return ++asked < 10000; });
    } catch (const ParameterError&) {  // refusing it is an end too
    }
    CHECK(asked < 10000);
}

TEST_CASE("with the fabric off and uniform X the settled sizes are uniform below the critical size") {
    // Drops are geometric on the grid, so the first passage below a bin edge is geometric to rounding.
    Material m = material(infinity);
    m.fragments = PowerLawFragments{};
    const double h = 0.05;
    const LogGrid grid(-10.0, 0.0, 201);
    const Index last_at_rest = 160;                                      // critical size at its upper edge
    const double stress_ratio = std::exp(-grid.edge(last_at_rest + 1));  // s_c = sigma*^(-w/3), w = 3
    for (const Scheme scheme : schemes) {
        SlowUpdate engine(grid, m, {scheme});
        State p(201);
        p(200, 200) = 1.0;
        const StepReport report = comminute::settle(engine, p.view(), stress_ratio);
        for (const std::vector<double>& pmf : {p.by_grain(), p.by_neighbour()}) {
            double worst = 0.0;
            for (Index i = 1; i <= 200; ++i) {
                const auto depth = static_cast<double>(last_at_rest - i);
                const double expected = i > last_at_rest ? 0.0 : std::exp(-depth * h) * -std::expm1(-h);
                worst = std::max(worst, std::abs(pmf[at(i)] - expected));
            }
            CHECK(worst < 1e-14);
        }
        // Wald: crushes = mean drop / mean drop a crush, here 1, or h / (1 - e^-h) under the paper's scheme
        const double drop = 39.0 * h + h / -std::expm1(-h);
        const double per_crush = scheme == Scheme::conservative ? 1.0 : h / -std::expm1(-h);
        CHECK(report.crushed == doctest::Approx(drop / per_crush).epsilon(1e-12));
        CHECK(report.crushed_neighbour == doctest::Approx(report.crushed).epsilon(1e-12));
    }
}

TEST_CASE("results above distrusted_below do not depend on where the grid ends") {
    std::mt19937_64 random(38);
    for (const double n : {0.1, 0.3}) {
        const LogGrid shallow(-3.0, 0.0, 61);
        const LogGrid deep(-9.0, 0.0, 181);
        State on_shallow(61);
        State on_deep(181);
        const State top = random_state(20, random);
        for (Index i = 0; i < 20; ++i) {
            for (Index j = 0; j < 20; ++j) on_shallow(41 + i, 41 + j) = on_deep(161 + i, 161 + j) = top(i, j);
        }
        SlowUpdate shallow_engine(shallow, material(n), {Scheme::paper});
        SlowUpdate deep_engine(deep, material(n), {Scheme::paper});
        comminute::settle(shallow_engine, on_shallow.view(), 300.0);
        comminute::settle(deep_engine, on_deep.view(), 300.0);
        const double limit = CrushZones(shallow, material(n), 300.0).distrusted_below();
        CHECK(limit > -3.0);
        CHECK(CrushZones(deep, material(n), 300.0).distrusted_below() == -infinity);
        double above = 0.0;
        double below = 0.0;
        for (Index i = 0; i < 61; ++i) {
            const double difference =
                std::abs(on_shallow.by_grain()[at(i)] - on_deep.by_grain()[at(120 + i)]);
            double& worst = shallow.edge(i) >= limit ? above : below;
            worst = std::max(worst, difference);
        }
        CHECK(above < 1e-14);
        CHECK(below > 1e-6);  // and the warning is not idle
    }
}
