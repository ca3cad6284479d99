// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <cstring>
#include <optional>
#include <thread>

#include "support/helpers.hpp"

using comminute::Batch;
using comminute::BatchOptions;
using comminute::BatchOutcome;
using comminute::BatchSolver;
using comminute::LogGrid;
using comminute::MatrixView;
using comminute::ParameterError;
using comminute::QuasiStatic;
using comminute::Scheme;
using comminute::ShapeError;
using comminute::SolveReport;
using comminute::StackView;
using comminute::StateStatus;
using comminute::VectorView;
using helpers::at;
using helpers::Index;
using helpers::material;
using helpers::not_a_number;

namespace {

constexpr Index bins = 24;
constexpr Index size = bins * bins;
constexpr Index count = 70;  // some blocks, the last of them not full
const LogGrid grid(-3.0, 0.2, bins);

/// Material points of a host: states at rest under some load, or never loaded, and the next load of each.
struct Points {
    std::vector<double> states = std::vector<double>(at(count * size));
    std::vector<double> load = std::vector<double>(at(count));
    std::vector<double> settled_at = std::vector<double>(at(count));
    std::vector<double> settled_after = std::vector<double>(at(count));

    explicit Points(unsigned seed) {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> share(0.0, 1.0);
        for (Index b = 0; b < count; ++b) {
            const helpers::State state = helpers::random_state(bins, random, 1.0, 0.4);
            std::copy(state.mass.begin(), state.mass.end(), states.begin() + b * size);
            load[at(b)] = b % 9 == 0 ? 0.0 : std::pow(500.0, share(random));
            settled_at[at(b)] = b % 4 == 0 ? 0.0 : std::pow(100.0, share(random));
        }
    }
    StackView<double> view() { return {states.data(), count, bins}; }
    Batch batch() { return {view(), load, settled_at}; }
    BatchOutcome outcome() { return {settled_after}; }
};

bool same(const SolveReport& a, const SolveReport& b) {
    return a.path == b.path && a.terms == b.terms && a.head == b.head && a.fit_error == b.fit_error &&
           a.crushed == b.crushed && a.crushed_neighbour == b.crushed_neighbour;
}

BatchOptions threads(Index n) {
    BatchOptions options;
    options.threads = n;
    return options;
}

}  // namespace

TEST_CASE("a batch gives the bits of one solve after another, on any number of threads") {
    for (const Scheme scheme : {Scheme::conservative, Scheme::paper}) {
        for (const double rate : {0.0, 0.3}) {
            CAPTURE(rate);
            Points points(11);
            const QuasiStatic like(grid, material(0.3), {scheme, rate});
            std::vector<double> expected(points.states.size());
            std::vector<double> gradings(at(count * bins));
            std::vector<SolveReport> said(at(count));
            for (Index b = 0; b < count; ++b) {
                QuasiStatic fresh(grid, material(0.3), {scheme, rate});
                said[at(b)] = fresh.solve(points.view()[b], points.load[at(b)], points.settled_at[at(b)],
                                          StackView<double>(expected.data(), count, bins)[b]);
                fresh.marginal(points.view()[b], points.load[at(b)], points.settled_at[at(b)],
                               {gradings.data() + b * bins, bins});
            }
            BatchSolver solver(like);
            for (const Index n : {1, 2, 5, 1}) {
                CAPTURE(n);
                std::vector<double> out(points.states.size(), -1.0);
                std::vector<double> grainsize(gradings.size(), -1.0);
                std::vector<SolveReport> reports(at(count));
                CHECK(solver.solve(points.batch(), {out.data(), count, bins}, {points.settled_after, reports},
                                   threads(n)));
                CHECK(out == expected);
                for (Index b = 0; b < count; ++b) CHECK(same(reports[at(b)], said[at(b)]));
                CHECK(solver.marginal(points.batch(), {grainsize.data(), count, bins}, {}, threads(n)));
                CHECK(grainsize == gradings);
            }
            CHECK(solver.solve(points.batch(), points.view(), points.outcome(), threads(3)));  // in place
            CHECK(points.states == expected);
        }
    }
}

TEST_CASE("states that lie apart in a host's memory are solved where they are") {
    Points points(12);
    const Index stride = size + 7;
    std::vector<double> spread(at(count * stride), 3.0);
    const StackView<double> apart(spread.data(), count, bins, stride);
    for (Index b = 0; b < count; ++b) {
        std::copy_n(points.view()[b].data(), size, apart[b].data());
    }
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    solver.solve({apart, points.load, points.settled_at}, apart, points.outcome());
    solver.solve(points.batch(), points.view(), points.outcome());
    for (Index b = 0; b < count; ++b) {
        CHECK(std::equal(apart[b].data(), apart[b].data() + size, points.view()[b].data()));
        for (Index q = size; q < stride; ++q) CHECK(apart[b].data()[q] == 3.0);
    }
}

TEST_CASE("stepping a batch through loads equals one batch at the last, to rounding") {
    Points points(13);
    std::vector<double> never(at(count), 0.0);
    std::vector<double> at_once(points.states.size());
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    const std::vector<double> last(at(count), 300.0);
    solver.solve({points.view(), last, {nullptr, 0}}, {at_once.data(), count, bins}, points.outcome());
    std::vector<double> settled = never;
    for (const double load : {3.0, 20.0, 90.0, 300.0}) {
        const std::vector<double> loads(at(count), load);
        solver.solve({points.view(), loads, settled}, points.view(), {settled});
        CHECK(settled == loads);
    }
    CHECK(helpers::largest_difference(points.states, at_once) < 1e-15);
}

TEST_CASE("the first bad input is refused by its index before anything is written") {
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    for (const Index n : {1, 4}) {
        Points points(14);
        points.load[40] = points.load[50] = not_a_number;
        points.load[60] = -1.0;
        const std::vector<double> untouched = points.states;
        CHECK_THROWS_WITH_AS(solver.solve(points.batch(), points.view(), points.outcome(), threads(n)),
                             "stress_ratio[40] is nan; it must be a number of at least 0 (0 is no load)",
                             ParameterError);
        points.load[40] = points.load[50] = points.load[60] = 400.0;
        points.settled_at[41] = -2.0;
        CHECK_THROWS_WITH_AS(solver.solve(points.batch(), points.view(), points.outcome(), threads(n)),
                             "settled_at[41] is -2; it must be a number of at least 0 (0 is no load)",
                             ParameterError);
        points.settled_at[41] = 0.0;
        CHECK(points.states == untouched);

        points.view()[60](20, 19) = points.view()[50](21, 20) = helpers::infinity;
        const std::vector<double> bad = points.states;
        CHECK_THROWS_WITH_AS(solver.solve(points.batch(), points.view(), points.outcome(), threads(n)),
                             "states[50, 21, 20] is inf; every entry inside the crush zone must be finite",
                             ParameterError);
        std::vector<double> grainsize(at(count * bins), 5.0);
        CHECK_THROWS_AS(solver.marginal(points.batch(), {grainsize.data(), count, bins}), ParameterError);
        CHECK(points.states == bad);
        CHECK(grainsize == std::vector<double>(grainsize.size(), 5.0));

        points.load[50] = points.load[60] = 0.0;  // outside their zones they do no harm
        CHECK(solver.solve(points.batch(), points.view(), points.outcome(), threads(n)));
        CHECK(points.view()[50](21, 20) == helpers::infinity);
    }
}

TEST_CASE("masses whose sum overflows are refused with the index of their state") {
    Points points(15);
    for (Index i = 0; i < bins; ++i) points.view()[33](i, i) = 1e308;
    points.load[33] = 400.0;
    points.settled_at[33] = 0.0;
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    std::vector<double> out(points.states.size());
    CHECK_THROWS_WITH_AS(
        solver.solve(points.batch(), {out.data(), count, bins}, points.outcome()),
        "states[33]: state adds up to more than a number can hold; it must be scaled to a total of 1",
        ParameterError);
}

TEST_CASE("a point remembers its largest load through unloading") {
    // Three cycles between two loads end where the larger of them alone does.
    Points points(19);
    std::vector<double> once(points.states.size());
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    const std::vector<double> high(at(count), 200.0);
    const std::vector<double> low(at(count), 20.0);
    std::vector<double> settled(at(count), 0.0);
    solver.solve({points.view(), high, settled}, {once.data(), count, bins}, points.outcome());
    for (int cycle = 0; cycle < 3; ++cycle) {
        solver.solve({points.view(), high, settled}, points.view(), {settled});
        solver.solve({points.view(), low, settled}, points.view(), {settled});
        CHECK(settled == high);
    }
    CHECK(points.states == once);
}

TEST_CASE("a batch that says nothing of the loads its states are at rest under is refused") {
    Points points(20);
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    CHECK_THROWS_WITH_AS(solver.solve(points.batch(), points.view(), {}),
                         "settled_at of the outcome has 0 entries; there are 70 states", ShapeError);
}

TEST_CASE("a bad state keeps what it was, says so, and leaves the others right") {
    for (const Index n : {1, 3}) {
        Points points(21);
        for (double& load : points.load) load = 400.0;
        BatchSolver solver(QuasiStatic(grid, material(0.3)));
        std::vector<double> expected(points.states.size());
        solver.solve(points.batch(), {expected.data(), count, bins}, points.outcome());
        const std::vector<double> settled = points.settled_after;

        points.view()[3](0, bins - 1) = not_a_number;  // outside the zone
        points.view()[17](20, 20) = -0.25;
        points.view()[29](5, 6) = 1e250;
        points.view()[31](20, 20) = -1e-15;  // rounding
        points.load[40] = not_a_number;
        points.settled_at[50] = -1.0;
        const std::vector<double> before = points.states;
        std::vector<StateStatus> status(at(count));
        std::vector<SolveReport> reports(at(count));
        std::vector<double> out(before.size(), 7.0);
        CHECK(solver.solve(points.batch(), {out.data(), count, bins}, {points.settled_after, reports, status},
                           threads(n)));
        for (Index b = 0; b < count; ++b) {
            CAPTURE(b);
            const bool bad_state = b == 3 || b == 17 || b == 29;
            const bool bad_load = b == 40 || b == 50;
            CHECK(status[at(b)] == (bad_state  ? StateStatus::bad_state
                                    : bad_load ? StateStatus::bad_load
                                               : StateStatus::at_rest));
            if (b == 31) continue;
            const std::vector<double>& right = bad_state || bad_load ? before : expected;
            CHECK(std::memcmp(out.data() + b * size, right.data() + b * size, at(size) * sizeof(double)) ==
                  0);
            if (!bad_state && !bad_load) CHECK(points.settled_after[at(b)] == settled[at(b)]);
        }
        CHECK(points.settled_after[17] == points.settled_at[17]);
        CHECK(reports[17].path == comminute::SolvePath::none);
        REQUIRE(solver.faults().size() == 5);
        CHECK(message(solver.faults().at(3), "") == "states[3, 0, 23] is nan; every entry must be finite");
        CHECK(message(solver.faults().at(17), "") ==
              "states[17, 20, 20] is -0.25; every entry must be a mass of at least 0");
        CHECK(message(solver.faults().at(29), "") ==
              "states[29, 5, 6] is 1e+250; every entry must be a share of a total of 1");
        CHECK(message(solver.faults().at(40), "") ==
              "stress_ratio[40] is nan; it must be a number of at least 0 (0 is no load)");

        std::vector<double> grainsize(at(count * bins));
        CHECK(
            solver.marginal(points.batch(), {grainsize.data(), count, bins}, {.status = status}, threads(n)));
        CHECK(status[17] == StateStatus::bad_state);
        CHECK(std::isnan(grainsize[at(17 * bins)]));
        CHECK(std::isfinite(grainsize[at(18 * bins)]));

        points.load[40] = 400.0;
        points.settled_at[50] = 0.0;
        CHECK_THROWS_WITH_AS(
            solver.solve(points.batch(), points.view(), points.outcome(), threads(n)),
            "states[17, 20, 20] is -0.25; every entry inside the crush zone must be a mass of at least 0",
            ParameterError);
    }
}

TEST_CASE("sizes of a batch that do not fit are refused") {
    Points points(16);
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    const std::vector<double> untouched = points.states;
    const std::vector<double> few(at(count - 1), 2.0);
    std::vector<double> grainsize(at(count * bins));
    std::vector<SolveReport> reports(3);
    const Batch good = points.batch();
    CHECK_THROWS_WITH_AS(solver.solve({points.view(), few, {nullptr, 0}}, points.view(), points.outcome()),
                         "stress_ratio has 69 entries; there are 70 states", ShapeError);
    CHECK_THROWS_WITH_AS(solver.solve({points.view(), points.load, few}, points.view(), points.outcome()),
                         "settled_at has 69 entries; there are 70 states", ShapeError);
    CHECK_THROWS_WITH_AS(solver.solve(good, points.view(), {points.settled_after, reports}),
                         "reports has 3 entries; there are 70 states", ShapeError);
    CHECK_THROWS_WITH_AS(solver.solve(good, {points.states.data(), count - 1, bins}, points.outcome()),
                         "out holds 69 states of shape (24, 24); it must hold 70 of shape (24, 24)",
                         ShapeError);
    CHECK_THROWS_AS(solver.solve(good, {points.states.data(), count, bins, size - 1}, points.outcome()),
                    ShapeError);
    CHECK_THROWS_AS(
        solver.solve({{points.states.data(), count, 12}, points.load, few}, points.view(), points.outcome()),
        ShapeError);
    std::vector<double> larger(at((count + 1) * size));
    const StackView<double> shifted(larger.data() + size, count, bins);
    CHECK_THROWS_AS(solver.solve({{larger.data(), count, bins}, points.load, points.settled_at}, shifted,
                                 points.outcome()),
                    ShapeError);
    CHECK_THROWS_AS(solver.marginal(good, {grainsize.data(), count, bins - 1, bins}), ShapeError);
    CHECK_THROWS_AS(solver.marginal(good, {points.states.data() + 5, count, bins}), ShapeError);
    CHECK_THROWS_WITH_AS(solver.solve(good, points.view(), points.outcome(), threads(0)),
                         "threads is 0; it must be at least 1", ParameterError);
    CHECK(points.states == untouched);
}

TEST_CASE("a batch of none is solved") {
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    const StackView<double> none(nullptr, 0, bins);
    const VectorView<const double> no_loads(nullptr, 0);
    CHECK(solver.solve({none, no_loads, no_loads}, none, {}, threads(2)));
    CHECK(solver.marginal({none, no_loads, no_loads}, {nullptr, 0, bins}));
}

TEST_CASE("a batch stops when it is told to, and what its hook throws comes out in the caller's thread") {
    Points points(17);
    BatchSolver solver(QuasiStatic(grid, material(0.3)));
    const auto caller = std::this_thread::get_id();
    int asked = 0;
    BatchOptions options;
    options.go_on = [&] {
        CHECK((std::this_thread::get_id() == caller));
        return ++asked < 7;  // the first five blocks are only looked at
    };
    std::vector<double> out(points.states.size(), -1.0);
    CHECK(!solver.solve(points.batch(), {out.data(), count, bins}, points.outcome(), options));
    const auto written = std::count_if(out.begin(), out.end(), [](double mass) { return mass != -1.0; });
    CHECK(written == 16 * size);  // one block
    options.go_on = []() -> bool { throw std::runtime_error("enough"); };
    CHECK_THROWS_WITH_AS(solver.solve(points.batch(), {out.data(), count, bins}, points.outcome(), options),
                         "enough", std::runtime_error);
}

TEST_CASE("a copied solver goes its own way") {
    Points points(18);
    QuasiStatic first(grid, material(0.3));
    const Index q = 7;
    std::vector<double> expected(at(size));
    std::vector<double> found(at(size));
    first.solve(points.view()[q], 50.0, std::nullopt, {expected.data(), bins, bins});
    QuasiStatic copy(first);
    first.solve(points.view()[q], 3.0, std::nullopt, {found.data(), bins, bins});
    copy.solve(points.view()[q], 50.0, std::nullopt, {found.data(), bins, bins});
    CHECK(found == expected);
    QuasiStatic gone(std::move(first));
    first = copy;
    first.solve(points.view()[q], 50.0, std::nullopt, {found.data(), bins, bins});
    CHECK(found == expected);
}

TEST_CASE("many loads of one state that all points share are those of a fabric, up to its largest grain") {
    const LogGrid inside_a_bin(-3.0, 0.5, bins);  // the largest grain lies inside a bin
    const comminute::Fabric start =
        comminute::mixed_fabric(comminute::power_law(2.5, 0.05, 1.0), inside_a_bin);
    const std::vector<double> load{1.02, 3.0, 200.0};
    const std::vector<double> largest(3, start.largest());
    std::vector<double> settled_at(3);
    std::vector<double> states(at(3 * size));
    BatchSolver solver(QuasiStatic(inside_a_bin, comminute::Material{}));
    const StackView<const double> shared(start.probability().data(), 3, bins, 0);
    solver.solve({shared, load, {nullptr, 0}, largest}, {states.data(), 3, bins}, {settled_at});
    QuasiStatic single(inside_a_bin, comminute::Material{});
    for (Index b = 0; b < 3; ++b) {
        const comminute::Fabric after = single.solve(start, load[at(b)]);
        CHECK(std::equal(states.begin() + b * size, states.begin() + (b + 1) * size,
                         after.probability().data()));
    }
    // Without the size of the largest grain the cells of its bin are taken to be full.
    std::vector<double> full(at(3 * size));
    solver.solve({shared, load, {nullptr, 0}}, {full.data(), 3, bins}, {settled_at});
    CHECK(full != states);
}

TEST_CASE("a size that no grain exceeds is a size") {
    Points points(3);
    std::vector<double> largest(at(count), 1.0);
    largest[at(5)] = -1.0;
    BatchSolver solver(QuasiStatic(grid, comminute::Material{}));
    Batch batch = points.batch();
    batch.largest = largest;
    CHECK_THROWS_AS(solver.solve(batch, points.view(), points.outcome()), ParameterError);
    batch.largest = {largest.data(), 3};
    CHECK_THROWS_AS(solver.solve(batch, points.view(), points.outcome()), ShapeError);
}
