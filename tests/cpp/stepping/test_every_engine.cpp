// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <array>
#include <cstring>
#include <utility>

#include "support/helpers.hpp"

using comminute::CrushZones;
using comminute::FullConvolution;
using comminute::Kernel;
using comminute::KernelKind;
using comminute::LogGrid;
using comminute::Material;
using comminute::MatrixView;
using comminute::PowerLawFragments;
using comminute::Scheme;
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

constexpr auto schemes = {Scheme::paper, Scheme::conservative};

// Steps with an engine, a copy of it, and one that was copied over another; all three must give the same bits.
template <class E, class Options>
void check_copies(const Options& options, std::mt19937_64& random) {
    const LogGrid grid(-4.0, 0.0, 60);
    E engine(grid, material(0.5), options);
    E copy = engine;
    E assigned(LogGrid(-2.0, 0.0, 8), Material{});
    State a = random_state(60, random);
    State b = a;
    State c = a;
    for (int step = 0; step < 3; ++step) {
        engine.step(a.view(), 50.0, a.view());
        if (step == 0) assigned = copy;
        copy.step(b.view(), 50.0, b.view());
        assigned.step(c.view(), 50.0, c.view());
    }
    CHECK(a.mass == b.mass);
    CHECK(a.mass == c.mass);
    CHECK(copy.options() == options);
    CHECK(assigned.grid() == grid);
    CHECK(assigned.material() == material(0.5));
    E moved = std::move(engine);
    moved.step(b.view(), 60.0, b.view());
    copy.step(a.view(), 60.0, a.view());
    CHECK(a.mass == b.mass);
}

}  // namespace

TEST_CASE("every engine moves mass as the cells' own kernels do, and reports what it crushed") {
    std::mt19937_64 random(31);
    for (const Index bins : {8, 9, 16, 33}) {
        for (const Scheme scheme : schemes) {
            Material m = material(log_uniform(random, 0.05, 2.0));
            m.weibull_modulus = log_uniform(random, 1.0, 6.0);
            m.reference_size = log_uniform(random, 0.3, 3.0);
            const comminute::FragmentLaw power = PowerLawFragments{log_uniform(random, 0.5, 5.0)};
            if (bins % 2 == 1) m.fragments = power;
            const LogGrid grid(-3.0, 0.5, bins);
            for (const Engine& engine : all_engines(grid, m, scheme)) {
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

TEST_CASE("a copy of an engine gives the same bits from a workspace of its own") {
    std::mt19937_64 random(50);
    for (const Scheme scheme : schemes) {
        check_copies<SlowUpdate>(comminute::SlowUpdateOptions{scheme}, random);
        for (const KernelKind kind : {KernelKind::exact, KernelKind::slow, KernelKind::fast}) {
            const comminute::KernelOptions kernel{kind, 0.0, scheme};
            for (const StepPath path :
                 helpers::step_paths(Kernel(LogGrid(-4.0, 0.0, 60), material(0.5), kernel))) {
                check_copies<FullConvolution>(comminute::FullConvolutionOptions{kernel, path}, random);
            }
        }
    }
}

TEST_CASE("a step in place gives the same bits as one into another array of any stride") {
    std::mt19937_64 random(32);
    const Index n = 40;
    for (const Scheme scheme : schemes) {
        for (const Engine& engine : all_engines(LogGrid(-4.0, 0.0, n), material(0.4), scheme)) {
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
    for (const Scheme scheme : schemes) {
        for (const Engine& engine : all_engines(grid, material(0.2), scheme)) {
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
    for (const Engine& engine : all_engines(grid, material(10.0), Scheme::conservative)) {
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
        const bool along_lines = engine.kernel.options().kind == KernelKind::slow;
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
