// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <optional>
#include <random>

#include "support/helpers.hpp"

using comminute::Batch;
using comminute::BatchSolver;
using comminute::Fabric;
using comminute::FragmentLaw;
using comminute::Index;
using comminute::LogGrid;
using comminute::Marginal;
using comminute::Material;
using comminute::MatrixView;
using comminute::QuasiStatic;
using comminute::Scheme;
using comminute::SolvePath;
using comminute::SolveReport;
using comminute::StackView;
using helpers::at;
using helpers::State;

namespace {

Material material_of(double fabric_width,
                     const FragmentLaw& fragments = comminute::WeibullFragments{1.0, 1.0}) {
    Material material;
    material.fabric_width = fabric_width;
    material.fragments = fragments;
    return material;
}

State solved(QuasiStatic& solver, const State& p, double load, std::optional<double> settled_at,
             SolveReport* report = nullptr) {
    State out(p.bins);
    const SolveReport said = solver.solve(p.view(), load, settled_at, out.view());
    if (report != nullptr) *report = said;
    return out;
}

}  // namespace

TEST_CASE("a narrow band swept cell by cell gives what the sweep along arms gives") {
    const std::vector<FragmentLaw> laws{
        comminute::WeibullFragments{1.0, 1.0}, comminute::WeibullFragments{0.2, 1.5},
        comminute::PowerLawFragments{0.8}, comminute::LogNormalFragments{-1.0, 0.4}};
    Index narrow = 0;
    for (const Index bins : {8, 9, 11, 16, 41, 100}) {
        const LogGrid grid(-4.0, 0.3, bins);
        std::mt19937_64 random(static_cast<unsigned>(bins));
        for (const FragmentLaw& law : laws) {
            for (const Scheme scheme : {Scheme::conservative, Scheme::paper}) {
                for (const double width : {0.01, 0.06, 0.15}) {
                    QuasiStatic by_cells(grid, material_of(width, law), {scheme, 0.0, SolvePath::automatic});
                    QuasiStatic by_arms(grid, material_of(width, law), {scheme, 0.0, SolvePath::direct});
                    State p = helpers::random_state(bins, random, 1.0, 0.3);
                    double before = 0.0;
                    for (const double load : {1.3, 20.0, 700.0}) {
                        SolveReport report;
                        const std::optional<double> settled =
                            before > 0.0 ? std::optional(before) : std::nullopt;
                        const State one = solved(by_cells, p, load, settled, &report);
                        SolveReport other;
                        p = solved(by_arms, p, load, settled, &other);
                        narrow += report.path == SolvePath::narrow;
                        CHECK(helpers::largest_difference(one.mass, p.mass) < 1e-14);
                        CHECK(std::abs(one.total() - 1.0) < 2e-15);
                        CHECK(report.crushed == doctest::Approx(other.crushed).epsilon(1e-12));
                        CHECK(report.crushed_neighbour ==
                              doctest::Approx(other.crushed_neighbour).epsilon(1e-12));
                        before = load;
                    }
                }
            }
        }
    }
    CHECK(narrow > 300);  // of 432
}

TEST_CASE("no bit of a problem depends on those that are swept beside it") {
    constexpr Index bins = 37, size = bins * bins, count = 23;
    const LogGrid grid(-3.0, 0.2, bins);
    std::mt19937_64 random(5);
    std::uniform_real_distribution<double> share(0.0, 1.0);
    std::vector<double> states;
    std::vector<double> load, settled(at(count), 0.0);
    for (Index b = 0; b < count; ++b) {
        const State p = helpers::random_state(bins, random, 1.0, 0.4);
        states.insert(states.end(), p.mass.begin(), p.mass.end());
        load.push_back(std::pow(2000.0, share(random)));
    }
    BatchSolver solver(QuasiStatic(grid, material_of(0.05)));
    const auto solved_from = [&](Index first, Index several) {
        std::vector<double> out(at(several * size)), at_rest(at(several));
        solver.solve({StackView<const double>(states.data() + first * size, several, bins),
                      {load.data() + first, several},
                      {nullptr, 0}},
                     {out.data(), several, bins}, {at_rest});
        return out;
    };
    const std::vector<double> all = solved_from(0, count);
    for (const Index cut : {1, 2, 5, 8, 9}) {
        std::vector<double> pieces;
        for (Index first = 0; first < count; first += cut) {
            const std::vector<double> piece = solved_from(first, std::min(cut, count - first));
            pieces.insert(pieces.end(), piece.begin(), piece.end());
        }
        CHECK(pieces == all);
    }
}

TEST_CASE("gradings under many loads are those of one load after another, exact sizes and all") {
    const LogGrid grid(-5.0, 0.1, 61);
    const std::vector<double> loads{30.0, 0.5, 1.0, 2.0, 2.0, 900.0, 7.0, 1.01, 400.0, 0.0, 55.0};
    for (const Scheme scheme : {Scheme::conservative, Scheme::paper}) {
        QuasiStatic solver(grid, material_of(0.05), {scheme});
        const Fabric start = comminute::mixed_fabric(comminute::gap_graded(1.0, 0.1), grid);
        for (const Fabric& from : {start, solver.solve(start, 3.0)}) {
            const std::vector<Marginal> many = solver.marginals(from, loads);
            REQUIRE(many.size() == loads.size());
            for (std::size_t k = 0; k < loads.size(); ++k) {
                const Marginal one = solver.marginal(from, loads[k]);
                const Fabric whole = solver.solve(from, loads[k]);
                CHECK(many[k].grainsize == one.grainsize);
                CHECK(many[k].points == one.points);
                CHECK(many[k].report.crushed == one.report.crushed);
                CHECK(std::equal(one.grainsize.begin(), one.grainsize.end(), whole.grainsize().begin()));
                CHECK(std::abs(many[k].mass_error()) < 2e-15);
            }
        }
        CHECK(solver.marginals(start, {nullptr, 0}).empty());
        CHECK_THROWS_AS(solver.marginals(start, std::vector<double>{1.0, -2.0}), comminute::ParameterError);
    }
}

TEST_CASE("numbers that are no masses stay where they are outside a narrow band") {
    constexpr Index bins = 40;
    const LogGrid grid(-4.0, 0.3, bins);
    QuasiStatic solver(grid, material_of(0.03));
    std::mt19937_64 random(2);
    State p = helpers::random_state(bins, random, 1.0, 0.2);
    const State clean = solved(solver, p, 40.0, std::nullopt);
    p(30, 3) = helpers::not_a_number;
    p(3, 35) = helpers::infinity;
    State found = solved(solver, p, 40.0, std::nullopt);
    CHECK(std::isnan(found(30, 3)));
    CHECK(std::isinf(found(3, 35)));
    found(30, 3) = clean(30, 3);
    found(3, 35) = clean(3, 35);
    CHECK(found.mass == clean.mass);
}
