// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <cmath>
#include <comminute/quasi_static.hpp>
#include <optional>
#include <thread>

#include "support/helpers.hpp"

using comminute::Fabric;
using comminute::LogGrid;
using comminute::Material;
using comminute::MatrixView;
using comminute::ParameterError;
using comminute::QuasiStatic;
using comminute::Scheme;
using comminute::ShapeError;
using comminute::SolvePath;
using comminute::SolveReport;
using helpers::at;
using helpers::Index;
using helpers::material;
using helpers::not_a_number;
using helpers::State;

namespace {

const LogGrid grid(-4.0, 0.2, 60);

State start(unsigned seed, double empty = 0.5) {
    std::mt19937_64 random(seed);
    return helpers::random_state(grid.bins(), random, 1.0, empty);
}

struct Solved {
    State state;
    SolveReport report;
};

Solved solve(QuasiStatic& solver, const State& from, double load,
             std::optional<double> settled_at = std::nullopt) {
    Solved solved{State(from.bins), {}};
    solved.report = solver.solve(from.view(), load, settled_at, solved.state.view());
    return solved;
}

bool same(const SolveReport& a, const SolveReport& b) {
    return a.path == b.path && a.terms == b.terms && a.head == b.head && a.fit_error == b.fit_error &&
           a.crushed == b.crushed && a.crushed_neighbour == b.crushed_neighbour;
}

// Every way to solve that has code of its own.
struct Way {
    const char* name;
    Scheme scheme;
    double rate;
    SolvePath path;
};
const std::vector<Way> ways = {{"direct", Scheme::conservative, 0.0, SolvePath::direct},
                               {"sums", Scheme::conservative, 0.0, SolvePath::sums},
                               {"automatic", Scheme::conservative, 0.0, SolvePath::automatic},
                               {"paper", Scheme::paper, 0.0, SolvePath::sums},
                               {"blend", Scheme::conservative, 0.3, SolvePath::automatic},
                               {"fast", Scheme::paper, 1.0, SolvePath::automatic}};

QuasiStatic solver_of(const Way& way, const Material& m = material(0.4), const LogGrid& g = grid) {
    return {g, m, {way.scheme, way.rate, way.path}};
}

}  // namespace

TEST_CASE("a solver is refused what it cannot use, with value, rule and remedy") {
    CHECK_REFUSED(QuasiStatic(grid, Material{}, {Scheme::paper, -0.1}),
                  "loading_rate is -0.1; it must be between 0 and 1");
    CHECK_REFUSED(QuasiStatic(grid, Material{}, {Scheme::paper, not_a_number}),
                  "loading_rate is nan; it must be between 0 and 1");
    CHECK_REFUSED(QuasiStatic(grid, Material{}, {Scheme::paper, 0.5, SolvePath::blend}),
                  "path is blend; a solve only reports that; it must be automatic, direct or sums");
    CHECK_THROWS_AS(QuasiStatic(grid, material(-1.0)), ParameterError);
}

TEST_CASE("a solve is refused bad loads, shapes and overlaps, and leaves out as it was") {
    QuasiStatic solver(grid, Material{});
    const State p = start(1);
    State out(grid.bins());
    out.mass.assign(out.mass.size(), -7.0);
    const State untouched = out;
    for (const double load : {-1.0, not_a_number}) {
        CHECK_THROWS_AS(solver.solve(p.view(), load, std::nullopt, out.view()), ParameterError);
        CHECK_THROWS_AS(solver.solve(p.view(), 2.0, load, out.view()), ParameterError);
    }
    const State small(40);
    CHECK_THROWS_AS(solver.solve(small.view(), 2.0, std::nullopt, out.view()), ShapeError);
    State small_out(40);
    CHECK_THROWS_AS(solver.solve(p.view(), 2.0, std::nullopt, small_out.view()), ShapeError);
    std::vector<double> grainsize(59);
    CHECK_THROWS_AS(solver.marginal(p.view(), 2.0, std::nullopt, {grainsize.data(), 59}), ShapeError);
    CHECK(out.mass == untouched.mass);

    std::vector<double> shared(at(61 * 60), 0.0);
    CHECK_THROWS_AS(solver.solve(MatrixView<const double>(shared.data(), 60, 60), 2.0, std::nullopt,
                                 MatrixView<double>(shared.data() + 60, 60, 60)),
                    ShapeError);
}

TEST_CASE("a mass in the zone that is no number is refused by its place") {
    for (const Way& way : ways) {
        CAPTURE(way.name);
        QuasiStatic solver = solver_of(way);
        State p = start(2);
        p(57, 56) = not_a_number;
        p(0, 55) = not_a_number;  // at rest, which is nobody's business
        CHECK_THROWS_WITH_AS(solve(solver, p, 100.0),
                             "state[57, 56] is nan; every entry inside the crush zone must be finite",
                             ParameterError);
        CHECK(solve(solver, start(2), 100.0).state.total() ==
              doctest::Approx(1.0));  // and is none the worse for it
    }
}

TEST_CASE("a mass at rest that is no number stays where it is, and touches nothing else") {
    for (const Way& way : ways) {
        CAPTURE(way.name);
        QuasiStatic solver = solver_of(way);
        State p = start(2);
        const State expected = solve(solver, p, 100.0).state;
        p(0, 55) = p(55, 0) = not_a_number;
        State found = solve(solver, p, 100.0).state;
        CHECK(std::isnan(found(0, 55)));
        CHECK(std::isnan(found(55, 0)));
        found(0, 55) = expected(0, 55);
        found(55, 0) = expected(55, 0);
        CHECK(found.mass == expected.mass);
    }
}

TEST_CASE("a fabric on another grid is refused with both grids") {
    QuasiStatic solver(grid, Material{});
    const LogGrid other(-4.0, 0.2, 61);
    const Fabric fabric = comminute::mixed_fabric(comminute::monodisperse(1.0), other);
    CHECK_THROWS_AS(solver.solve(fabric, 2.0), ParameterError);
    CHECK_THROWS_AS(solver.marginal(fabric, 2.0), ParameterError);
}

TEST_CASE("in place, out of place, and in rows further apart give the same bits") {
    for (const Way& way : ways) {
        for (const std::optional<double> settled_at : {std::optional<double>{}, std::optional<double>{3.0}}) {
            CAPTURE(way.name);
            QuasiStatic solver = solver_of(way);
            const State p = start(3);
            const Solved expected = solve(solver, p, 50.0, settled_at);

            State in_place = p;
            CHECK(same(solver.solve(in_place.view(), 50.0, settled_at, in_place.view()), expected.report));
            CHECK(in_place.mass == expected.state.mass);

            const Index stride = 64;
            std::vector<double> wide(at(grid.bins() * stride), -3.0);
            std::vector<double> wide_out(wide);
            for (Index i = 0; i < 60; ++i)
                for (Index j = 0; j < 60; ++j) wide[at(i * stride + j)] = p(i, j);
            const MatrixView<const double> from(wide.data(), 60, 60, stride);
            CHECK(same(solver.solve(from, 50.0, settled_at, {wide_out.data(), 60, 60, stride}),
                       expected.report));
            CHECK(same(solver.solve(from, 50.0, settled_at, {wide.data(), 60, 60, stride}), expected.report));
            bool equal = true;
            for (Index i = 0; i < 60; ++i) {
                for (Index j = 0; j < stride; ++j) {
                    const double wanted = j < 60 ? expected.state(i, j) : -3.0;
                    equal =
                        equal && wide_out[at(i * stride + j)] == wanted && wide[at(i * stride + j)] == wanted;
                }
            }
            CHECK(equal);
        }
    }
}

TEST_CASE("a solver keeps nothing from one solve to the next") {
    for (const Way& way : ways) {
        CAPTURE(way.name);
        QuasiStatic used = solver_of(way);
        for (const double load : {1e5, 0.3, 40.0, 0.0}) {
            solve(used, start(4), load);
            std::vector<double> grainsize(60);
            used.marginal(start(5).view(), load, 0.5 * load, {grainsize.data(), 60});
        }
        QuasiStatic fresh = solver_of(way);
        for (const double load : {7.0, 900.0}) {
            const Solved a = solve(used, start(6), load, 2.0);
            const Solved b = solve(fresh, start(6), load, 2.0);
            CHECK(a.state.mass == b.state.mass);
            CHECK(same(a.report, b.report));
        }
        QuasiStatic moved = std::move(used);
        CHECK(solve(moved, start(6), 7.0).state.mass == solve(fresh, start(6), 7.0).state.mass);
        CHECK(moved.options().loading_rate == way.rate);
        CHECK(moved.options().path == way.path);
    }
}

TEST_CASE("a load of nothing moves nothing and infinite loads end in the fines") {
    for (const Way& way : ways) {
        CAPTURE(way.name);
        QuasiStatic solver = solver_of(way, material(helpers::infinity));
        const State p = start(7);
        CHECK(solve(solver, p, 0.0).state.mass == p.mass);
        const Solved all = solve(solver, p, 1e12);
        CHECK(all.state(0, 0) == doctest::Approx(1.0).epsilon(1e-13));
        CHECK(all.state.total() == doctest::Approx(1.0).epsilon(1e-13));
    }
}

TEST_CASE("the smallest grid and grids across blocks and vectors conserve mass on every path") {
    for (const Index bins : {8, 9, 31, 32, 33, 63, 64, 65, 127, 130, 193}) {
        const LogGrid g(-5.0, 0.3, bins);
        std::mt19937_64 random(static_cast<unsigned>(bins));
        const State p = helpers::random_state(bins, random, 1.0, 0.3);
        for (const double n : {0.02, 0.2, 2.0, 50.0}) {
            QuasiStatic direct(g, material(n), {Scheme::conservative, 0.0, SolvePath::direct});
            QuasiStatic sums(g, material(n), {Scheme::conservative, 0.0, SolvePath::sums});
            QuasiStatic automatic(g, material(n));
            for (const double load : {0.9, 4.0, 300.0}) {
                const Solved a = solve(direct, p, load);
                const Solved b = solve(sums, p, load);
                CHECK(helpers::largest_difference(a.state.mass, b.state.mass) < 5e-15);
                CHECK(helpers::largest_difference(a.state.mass, solve(automatic, p, load).state.mass) <
                      5e-15);
                CHECK(std::abs(b.state.total() - 1.0) < 1e-14);
                CHECK(helpers::smallest_entry(a.state.mass) >= 0.0);
                CHECK(helpers::smallest_entry(b.state.mass) >= 0.0);
                std::vector<double> grainsize(at(bins));
                const SolveReport report =
                    sums.marginal(p.view(), load, std::nullopt, {grainsize.data(), bins});
                CHECK(same(report, b.report));
                CHECK(helpers::largest_difference(grainsize, b.state.by_grain()) < 5e-15);
            }
        }
    }
}

TEST_CASE("one solver a thread and one fabric for all give the bits of a serial run") {
    const Fabric shared = comminute::mixed_fabric(comminute::gap_graded(1.0, 0.1), grid);
    const auto run = [&](std::size_t t) {
        QuasiStatic solver = solver_of(ways[t % ways.size()]);
        Fabric fabric = shared;
        for (double load = 0.5; load < 1e4; load *= 3.0) fabric = solver.solve(fabric, load);
        return comminute::remix(fabric);
    };
    const std::size_t count = 2 * ways.size();
    std::vector<std::optional<Fabric>> found(count);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < count; ++t) threads.emplace_back([&, t] { found[t] = run(t); });
    for (std::thread& thread : threads) thread.join();
    for (std::size_t t = 0; t < count; ++t) CHECK(*found[t] == run(t));
}

TEST_CASE("on an edge of a bin an exact size stays within it") {
    // Rounding may put such a size an ulp outside of its bin; no part of a ridge may become negative by that.
    for (const Index bins : {9, 11, 23, 40}) {
        for (const double psi_min : {-1.8228129844145249, -1.75, -3.3}) {
            const LogGrid g(psi_min, 0.0, bins);
            for (Index edge = 2; edge < bins; ++edge) {
                const std::vector<comminute::Atom> atoms{{g.edge(edge), g.edge(edge - 1), 0.5},
                                                         {0.0, g.edge(edge), 0.5}};
                const Fabric start_at(g, std::vector<double>(at(bins * bins), 0.0), atoms);
                QuasiStatic solver(g, material(1.0, 1.0, 0.4));
                const Fabric after = solver.solve(solver.solve(start_at, 1.0), 3.0);
                for (const comminute::Ridge& ridge : after.ridges()) {
                    CHECK(helpers::smallest_entry(ridge.mass) >= 0.0);
                    CHECK(ridge.above <= ridge.mass[at(g.bin_of(ridge.at))]);
                    CHECK(ridge.above >= 0.0);
                }
            }
        }
    }
}
