// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <array>
#include <cstring>

#include "support/helpers.hpp"

using comminute::CrushZones;
using comminute::FragmentRule;
using comminute::FullConvolution;
using comminute::Kernel;
using comminute::KernelKind;
using comminute::LogGrid;
using comminute::Material;
using comminute::MatrixView;
using comminute::ParameterError;
using comminute::PowerLawFragments;
using comminute::ShapeError;
using comminute::SlowUpdate;
using comminute::StepPath;
using comminute::StepReport;
using comminute::Zone;
using helpers::all_engines;
using helpers::at;
using helpers::dense_step;
using helpers::Engine;
using helpers::Index;
using helpers::infinity;
using helpers::log_uniform;
using helpers::material;
using helpers::mean_of;
using helpers::random_state;
using helpers::State;

namespace {

constexpr auto rules = {FragmentRule::paper, FragmentRule::conservative};

}  // namespace

TEST_CASE("the kernel of a cell sends its mass where its zone and the kind of kernel say") {
    // h = ln 2 and uniform X: f_m = 2^-m, and from bin i a share 2^-(i-1) ends in the fines bin
    Material m = material(1.0);
    m.fragments = PowerLawFragments{};
    const LogGrid grid(-11.0 * std::log(2.0), 0.0, 12);
    const auto f = [](Index from, Index to) {
        if (to >= from) return 0.0;
        return std::pow(2.0, -static_cast<double>(to == 0 ? from - 1 : from - to));
    };
    const auto stays = [](Index from, Index to) { return from == to ? 1.0 : 0.0; };
    struct Cell {
        Index i, j;
        Zone zone;
        double grain[3], neighbour[3], both[3];  // shares for exact, slow, blend 0.25
    };
    // At sigma* = 8 the zone of psi = 0 reaches 2.9 bins, and both grains crush at a distance of 1.
    const Cell cells[] = {
        {11, 9, Zone::grain, {1.0, 1.0, 0.75}, {0.0, 0.0, 0.0}, {0.0, 0.0, 0.25}},
        {9, 11, Zone::neighbour, {0.0, 0.0, 0.0}, {1.0, 1.0, 0.75}, {0.0, 0.0, 0.25}},
        {11, 10, Zone::both, {0.0, 1.0, 0.75}, {0.0, 0.0, 0.0}, {1.0, 0.0, 0.25}},
        {10, 11, Zone::both, {0.0, 0.0, 0.0}, {0.0, 1.0, 0.75}, {1.0, 0.0, 0.25}},
        {11, 11, Zone::both, {0.0, 0.5, 0.375}, {0.0, 0.5, 0.375}, {1.0, 0.0, 0.25}},
    };
    const CrushZones zones(grid, m, 8.0);
    State kernel_of(12);
    for (const Cell& c : cells) {
        CHECK(zones.at(c.i, c.j) == c.zone);
        for (std::size_t kind = 0; kind < 4; ++kind) {
            const KernelKind kinds[] = {KernelKind::exact, KernelKind::slow, KernelKind::blend,
                                        KernelKind::fast};
            const double grain = kind == 3 ? 0.0 : c.grain[kind];
            const double neighbour = kind == 3 ? 0.0 : c.neighbour[kind];
            const double both = kind == 3 ? 1.0 : c.both[kind];
            Kernel(grid, m, kinds[kind], kind == 2 ? 0.25 : 0.0).cell(c.i, c.j, 8.0, kernel_of.view());
            for (Index a = 0; a < 12; ++a) {
                for (Index b = 0; b < 12; ++b) {
                    const double expected = grain * f(c.i, a) * stays(c.j, b) +
                                            neighbour * stays(c.i, a) * f(c.j, b) +
                                            both * f(c.i, a) * f(c.j, b);
                    REQUIRE(std::abs(kernel_of(a, b) - expected) < 1e-15);
                }
            }
        }
    }
    const Kernel slow(grid, m, KernelKind::slow);
    slow.cell(11, 8, 8.0, kernel_of.view());  // outside
    CHECK(kernel_of(11, 8) == 1.0);
    CHECK(kernel_of.total() == 1.0);
    slow.cell(0, 0, 1e9, kernel_of.view());  // fines among fines
    CHECK(kernel_of(0, 0) == 1.0);
    slow.cell(0, 3, 1e9, kernel_of.view());
    CHECK(kernel_of(0, 2) == doctest::Approx(0.5).epsilon(1e-14));
    CHECK(kernel_of(0, 0) == doctest::Approx(0.25).epsilon(1e-14));
}

TEST_CASE("every engine moves mass as the cells' own kernels do, and reports what it crushed") {
    std::mt19937_64 random(31);
    for (const Index bins : {8, 9, 16, 33}) {
        for (const FragmentRule rule : rules) {
            Material m = material(log_uniform(random, 0.05, 2.0));
            m.weibull_modulus = log_uniform(random, 1.0, 6.0);
            m.reference_size = log_uniform(random, 0.3, 3.0);
            if (bins % 2 == 1) m.fragments = PowerLawFragments{log_uniform(random, 0.5, 5.0)};
            const LogGrid grid(-3.0, 0.5, bins);
            for (const Engine& engine : all_engines(grid, m, rule)) {
                CAPTURE(engine.name);
                State p = random_state(bins, random, 1.0, 0.3);
                for (const double stress_ratio : {0.0, 0.7, 3.0, 50.0, infinity}) {
                    const State expected = dense_step(engine.kernel, p, stress_ratio);
                    const CrushZones zones(grid, m, stress_ratio);
                    double active = 0.0;
                    double crushed = 0.0;
                    double crushed_neighbour = 0.0;
                    for (Index i = 0; i < bins; ++i) {
                        for (Index j = 0; j < bins; ++j) {
                            if (zones.at(i, j) == Zone::rest) continue;
                            const auto share = engine.kernel.shares(zones.at(i, j), i, j);
                            active += p(i, j);
                            crushed += p(i, j) * (share.grain + share.both);
                            crushed_neighbour += p(i, j) * (share.neighbour + share.both);
                        }
                    }
                    const StepReport report = engine.step(p.view(), stress_ratio, p.view());
                    CHECK(helpers::largest_difference(p.mass, expected.mass) < 1e-13);
                    CHECK(report.steps == 1);
                    CHECK(std::abs(report.active - active) < 1e-14);
                    CHECK(std::abs(report.crushed - crushed) < 1e-14);
                    CHECK(std::abs(report.crushed_neighbour - crushed_neighbour) < 1e-14);
                }
            }
        }
    }
}

TEST_CASE("the slow update moves a large state as its cells one by one") {
    std::mt19937_64 random(40);
    const Index n = 300;  // 45 000 cells crush in psi: more than one block of the engine's buffer
    const LogGrid grid(-6.0, 0.5, n);
    for (const double width : {0.05, 2.0}) {
        const Material m = material(width);
        const comminute::FragmentPmf f =
            comminute::fragment_pmf(m.fragments, grid.spacing(), n, FragmentRule::conservative);
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
        SlowUpdate engine(grid, m, FragmentRule::conservative);
        State p = start;
        engine.step(p.view(), 2000.0, p.view());
        CHECK(helpers::largest_difference(p.mass, expected.mass) < 1e-15);
    }
}

TEST_CASE("a copy of a slow update gives the same bits") {
    std::mt19937_64 random(50);
    SlowUpdate engine(LogGrid(-4.0, 0.0, 60), material(0.5));
    SlowUpdate copy = engine;
    State a = random_state(60, random);
    State b = a;
    for (int step = 0; step < 3; ++step) {
        engine.step(a.view(), 50.0, a.view());
        copy.step(b.view(), 50.0, b.view());
    }
    CHECK(a.mass == b.mass);
}

TEST_CASE("a step in place gives the same bits as one into another array of any stride") {
    std::mt19937_64 random(32);
    const Index n = 40;
    for (const FragmentRule rule : rules) {
        for (const Engine& engine : all_engines(LogGrid(-4.0, 0.0, n), material(0.4), rule)) {
            CAPTURE(engine.name);
            const State start = random_state(n, random);
            State in_place = start;
            State source = start;
            std::vector<double> padded(at(n * (n + 3)), helpers::not_a_number);
            const MatrixView<double> out(padded.data(), n, n, n + 3);
            engine.step(in_place.view(), 30.0, in_place.view());
            engine.step(source.view(), 30.0, out);
            CHECK(source.mass == start.mass);
            int different = 0;
            for (Index i = 0; i < n; ++i) {
                for (Index j = 0; j < n; ++j) different += out(i, j) != in_place(i, j) ? 1 : 0;
                for (Index gap = n; gap < n + 3; ++gap) different += std::isnan(out.row(i)[gap]) ? 0 : 1;
            }
            CHECK(different == 0);
        }
    }
}

TEST_CASE("mass is kept, none is negative, and sizes only fall, over 200 steps of rising load") {
    std::mt19937_64 random(33);
    const LogGrid grid(-5.0, 0.5, 48);
    for (const FragmentRule rule : rules) {
        for (const Engine& engine : all_engines(grid, material(0.2), rule)) {
            CAPTURE(engine.name);
            State p = random_state(48, random, 2.0);
            double mean = mean_of(p.by_grain(), grid);
            double mean_neighbour = mean_of(p.by_neighbour(), grid);
            int rises = 0;
            for (int step = 0; step < 200; ++step) {
                engine.step(p.view(), 0.5 * std::exp(0.05 * step), p.view());
                REQUIRE(helpers::smallest_entry(p.mass) >= 0.0);
                const double now = mean_of(p.by_grain(), grid);
                const double now_neighbour = mean_of(p.by_neighbour(), grid);
                if (now > mean + 1e-14 || now_neighbour > mean_neighbour + 1e-14) ++rises;  // 1e-14: rounding
                mean = now;
                mean_neighbour = now_neighbour;
            }
            CHECK(rises == 0);
            CHECK(std::abs(p.total() - 2.0) < 2e-13);
        }
    }
}

TEST_CASE("mass is kept to the last bits where next to none of it reaches the fines") {
    std::mt19937_64 random(48);
    const LogGrid grid(-60.0, 0.0, 200);
    for (const Engine& engine : all_engines(grid, material(10.0), FragmentRule::conservative)) {
        CAPTURE(engine.name);
        State p(200);
        const State top = random_state(20, random);
        for (Index i = 0; i < 20; ++i) {
            for (Index j = 0; j < 20; ++j) p(180 + i, 180 + j) = top(i, j);
        }
        for (int step = 0; step < 4; ++step) {
            engine.step(p.view(), 1e12, p.view());
            REQUIRE(helpers::smallest_entry(p.mass) >= 0.0);
            // Two units in the last place; of sums, which close no balance, two for each step's two crushes as well.
            const double by_sums = engine.name.find("sums") != std::string::npos ? 4.5e-16 * (step + 1) : 0.0;
            CHECK(std::abs(p.total() - 1.0) < 5e-16 + by_sums);
        }
    }
}

TEST_CASE("nothing lands where no larger source lies, not even rounding") {
    std::mt19937_64 random(34);
    const Index n = 36;
    for (const Engine& engine : all_engines(LogGrid(-3.0, 0.0, n), material(1.0))) {
        CAPTURE(engine.name);
        const bool along_lines = engine.kernel.kind() == KernelKind::slow;
        State p = random_state(n, random, 1.0, 0.99);
        const State start = p;
        engine.step(p.view(), 100.0, p.view());
        int stray = 0;
        for (Index a = 0; a < n; ++a) {
            for (Index b = 0; b < n; ++b) {
                bool reachable = false;
                for (Index i = a; i < n; ++i) {
                    for (Index j = b; j < n; ++j) {
                        if (start(i, j) > 0.0 && (!along_lines || i == a || j == b)) reachable = true;
                    }
                }
                if (!reachable && p(a, b) != 0.0) ++stray;
            }
        }
        CHECK(stray == 0);
    }
}

TEST_CASE("settling leaves a state at rest, and one settling does the work of fifty small ones") {
    std::mt19937_64 random(36);
    const LogGrid grid(-6.0, 0.3, 50);
    const Material m = material(0.15);
    for (const Engine& engine : all_engines(grid, m)) {
        if (engine.kernel.kind() == KernelKind::exact) continue;  // depends on the path: zone 11 grows
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
    SlowUpdate engine(LogGrid(-3.0, 0.0, 16), Material{});
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
    for (const FragmentRule rule : rules) {
        SlowUpdate engine(grid, m, rule);
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
        // Wald: crushes = mean drop / mean drop a crush, here 1, or h / (1 - e^-h) by the paper's rule
        const double drop = 39.0 * h + h / -std::expm1(-h);
        const double per_crush = rule == FragmentRule::conservative ? 1.0 : h / -std::expm1(-h);
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
        SlowUpdate shallow_engine(shallow, material(n));
        SlowUpdate deep_engine(deep, material(n));
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

TEST_CASE("bad shapes, overlaps, loads and entries are refused and leave the state alone") {
    std::mt19937_64 random(39);
    const LogGrid grid(-2.0, 0.0, 8);
    for (const Engine& engine : all_engines(grid, material(0.4))) {
        CAPTURE(engine.name);
        State p = random_state(8, random);
        std::vector<double> buffer(200, 7.0);
        const std::vector<double> untouched = buffer;
        const MatrixView<double> out(buffer.data(), 8, 8);
        const auto refuses_shape = [&](MatrixView<const double> from, MatrixView<double> to,
                                       const char* text) {
            CHECK_THROWS_WITH_AS(engine.step(from, 2.0, to), text, ShapeError);
        };
        refuses_shape({buffer.data(), 8, 9}, p.view(), "p has shape (8, 9); the grid needs (8, 8)");
        refuses_shape(p.view(), {buffer.data(), 7, 8}, "out has shape (7, 8); the grid needs (8, 8)");
        const char* overlap =
            "out overlaps p in part; it must be p itself, to step in place, or an array of its own";
        CHECK_THROWS_WITH_AS(engine.step({buffer.data(), 8, 8, 4}, 2.0, out), doctest::Contains("stride"),
                             ShapeError);
        refuses_shape({buffer.data() + 1, 8, 8}, out, overlap);
        refuses_shape({buffer.data() + 63, 8, 8}, out, overlap);
        refuses_shape(out, {buffer.data() + 8, 8, 8}, overlap);
        refuses_shape(out, {buffer.data(), 8, 8, 9}, overlap);
        CHECK_THROWS_WITH_AS(engine.settle({buffer.data(), 8, 9}, 2.0, 1, {}),
                             "state has shape (8, 9); the grid needs (8, 8)", ShapeError);
        CHECK_REFUSED(engine.step(p.view(), -1.0, out),
                      "stress_ratio is -1; it must be a number of at least 0 (0 is no load)");
        CHECK_REFUSED(engine.step(p.view(), helpers::not_a_number, out),
                      "stress_ratio is nan; it must be a number of at least 0 (0 is no load)");
        for (const double bad : {helpers::not_a_number, infinity, -infinity}) {
            for (const std::array<Index, 2> place : {std::array<Index, 2>{7, 6}, {6, 7}, {7, 7}}) {
                State broken = p;
                broken(place[0], place[1]) = bad;
                const State before = broken;
                const std::string rule = engine.name == "slow update"
                                             ? "every entry inside the crush zone must be finite"
                                             : "every entry must be finite";
                const std::string text = "p[" + std::to_string(place[0]) + ", " + std::to_string(place[1]) +
                                         "] is " + comminute::text(bad) + "; " + rule;
                CHECK_REFUSED(engine.step(broken.view(), 50.0, out), text.c_str());
                CHECK_REFUSED(engine.step(broken.view(), 50.0, broken.view()), text.c_str());
                CHECK(std::memcmp(broken.mass.data(), before.mass.data(), 64 * sizeof(double)) == 0);
            }
        }
        CHECK(buffer == untouched);
        CHECK_NOTHROW(engine.step({buffer.data(), 8, 8}, 2.0, {buffer.data() + 64, 8, 8}));
    }
}

TEST_CASE("a kernel refuses a loading rate, a cell or an array that does not fit it") {
    const LogGrid grid(-2.0, 0.0, 8);
    CHECK_REFUSED(Kernel(grid, Material{}, KernelKind::blend, 1.5),
                  "loading_rate is 1.5; it must be between 0 and 1");
    CHECK_REFUSED(Kernel(grid, Material{}, KernelKind::blend, helpers::not_a_number),
                  "loading_rate is nan; it must be between 0 and 1");
    for (const KernelKind kind : {KernelKind::exact, KernelKind::slow, KernelKind::fast}) {
        CHECK_REFUSED(Kernel(grid, Material{}, kind, 0.5),
                      "loading_rate is 0.5 but the kernel is not a blend; use kind \"blend\", or "
                      "leave loading_rate at 0");
    }
    CHECK_THROWS_AS(SlowUpdate(grid, material(-1.0)), ParameterError);
    const Kernel kernel(grid, Material{}, KernelKind::exact);
    State out(8);
    out.mass.assign(64, 7.0);
    CHECK_REFUSED(kernel.cell(8, 0, 2.0, out.view()), "i is 8; it must be a bin of the grid, 0 to bins - 1");
    CHECK_REFUSED(kernel.cell(0, -1, 2.0, out.view()),
                  "j is -1; it must be a bin of the grid, 0 to bins - 1");
    CHECK_THROWS_AS(kernel.cell(7, 7, -2.0, out.view()), ParameterError);
    CHECK_THROWS_WITH_AS(kernel.cell(7, 7, 2.0, {out.mass.data(), 8, 7}),
                         "out has shape (8, 7); the grid needs (8, 8)", ShapeError);
    CHECK(out.mass == std::vector<double>(64, 7.0));
}

#ifdef COMMINUTE_HAS_FFTW

TEST_CASE("the slow update equals the full convolution with the slow kernel") {
    std::mt19937_64 random(35);
    for (const Index bins : {8, 31, 64, 127}) {
        for (const FragmentRule rule : rules) {
            const Material m = material(log_uniform(random, 0.03, 1.0));
            const LogGrid grid(-5.0, 0.4, bins);
            SlowUpdate slow(grid, m, rule);
            FullConvolution full(Kernel(grid, m, KernelKind::slow, 0.0, rule));
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
        FullConvolution engine(Kernel(grid, m, KernelKind::fast, 0.0, FragmentRule::conservative));
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

TEST_CASE("an engine's bits do not depend on what was planned before it") {
    std::mt19937_64 random(49);
    // a size that no other test plans with PlanEffort::measure
    const Kernel kernel(LogGrid(-4.0, 0.0, 90), material(0.3), KernelKind::fast);
    const State start = random_state(90, random);
    State before = start;
    State measured = start;
    State after = start;
    FullConvolution(kernel, StepPath::transforms).step(start.view(), 50.0, before.view());
    FullConvolution(kernel, StepPath::transforms, comminute::PlanEffort::measure)
        .step(start.view(), 50.0, measured.view());
    FullConvolution(kernel, StepPath::transforms).step(start.view(), 50.0, after.view());
    CHECK(before.mass == after.mass);
    CHECK(helpers::largest_difference(before.mass, measured.mass) < 1e-13);
}

TEST_CASE("a build with FFTW says so") {
    CHECK(comminute::has_fftw());
}

#else

TEST_CASE("without FFTW the full convolution says what is missing") {
    CHECK(!comminute::has_fftw());
    const Kernel kernel(LogGrid(-2.0, 0.0, 8), Material{}, KernelKind::slow);
    CHECK_THROWS_WITH_AS(FullConvolution(kernel, StepPath::transforms), doctest::Contains("FFTW"),
                         comminute::UnavailableError);
}

#endif
