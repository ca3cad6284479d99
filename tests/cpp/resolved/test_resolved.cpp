// SPDX-License-Identifier: BSD-3-Clause
// The law of three cells: values, exact answers, laws.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "resolved/random_case.hpp"
#include "support/helpers.hpp"

using comminute::Material;
using comminute::Mean;
using comminute::ParameterError;
using comminute::Resolved;
using comminute::ResolvedGrid;
using comminute::ResolvedOptions;
using comminute::ShapeError;
using helpers::at;
using helpers::Index;
using helpers::RandomCase;
using helpers::with_width;

namespace {

/// 32 bins of 0.25 from -8 to 0, and exact sizes.
ResolvedGrid even_nodes(const std::vector<double>& exact) {
    std::vector<double> lower{-10.0};
    std::vector<double> upper{-8.0};
    for (int i = 0; i < 32; ++i) {
        lower.push_back(-8.0 + 0.25 * i);
        upper.push_back(-8.0 + 0.25 * (i + 1));
        for (const double psi : exact) {
            if (psi != upper.back()) continue;
            lower.push_back(psi);
            upper.push_back(psi);
        }
    }
    return {lower, upper};
}

std::vector<double> top_node(const ResolvedGrid& grid) {
    std::vector<double> pmf(at(grid.nodes()), 0.0);
    pmf.back() = 1.0;
    return pmf;
}

/// Mass in bins that end at or below a log size, exact sizes left out.
double finer(const Resolved& law, double psi) {
    const std::vector<double> pmf = law.pmf();
    double sum = 0.0;
    for (Index i = 0; i < law.grid().nodes(); ++i) {
        if (law.grid().upper(i) <= psi + 1e-9 && !law.grid().exact(i)) sum += pmf[at(i)];
    }
    return sum;
}

struct Row {
    double load;
    double exact;
    double finer_quarter;
    double finer_one;
    double finer_three;
    double crushes;
};

void check(const Material& material, Mean mean, const std::vector<Row>& rows) {
    const ResolvedGrid grid = even_nodes({0.0});
    ResolvedOptions options;
    options.mean = mean;
    Resolved law(grid, material, top_node(grid), options);
    for (const Row& row : rows) {
        CAPTURE(row.load);
        law.load_to(row.load);
        CHECK(std::abs(law.pmf().back() - row.exact) < 1e-5);
        CHECK(std::abs(finer(law, -0.25) - row.finer_quarter) < 1e-5);
        CHECK(std::abs(finer(law, -1.0) - row.finer_one) < 1e-5);
        CHECK(std::abs(finer(law, -3.0) - row.finer_three) < 1e-5);
        CHECK(std::abs(law.crushes() - row.crushes) < 1e-5);
    }
}

}  // namespace

TEST_CASE("gradings of equal grains are those of another program, written from the equations") {
    check(with_width(0.05), Mean::arithmetic,
          {{1.0, .567653, .370054, .210523, .033219, .432347},
           {1.5, .553939, .390724, .222419, .035113, .455719},
           {8.0, .539800, .417760, .238926, .037760, .487298},
           {100.0, .526011, .439925, .257619, .040810, .520999},
           {1e4, .507644, .467995, .290506, .046278, .576985}});
    check(with_width(0.05), Mean::geometric,
          {{8.0, .540715, .416089, .237513, .037531, .484790},
           {1e4, .512743, .460921, .276643, .044286, .555474}});
    check(with_width(0.2), Mean::arithmetic,
          {{8.0, .449402, .531457, .391545, .063963, .738098},
           {1e4, .411930, .574356, .535337, .119134, 1.032335}});
}

TEST_CASE("gradings of two sizes, and of a packing that is mixed anew, are that program's too") {
    const ResolvedGrid grid = even_nodes({-2.25, 0.0});
    std::vector<double> pmf(at(grid.nodes()), 0.0);
    Index small = 0;
    while (!(grid.exact(small) && grid.lower(small) == -2.25)) ++small;
    pmf.back() = pmf[at(small)] = 0.5;
    Resolved two(grid, with_width(0.05), pmf);
    struct Shares {
        double load;
        double large;
        double small;
    };
    for (const Shares& row : {Shares{1.0, .421001, .5}, Shares{8.0, .417608, .5},
                              Shares{100.0, .415801, .417460}, Shares{1e4, .413266, .414357}}) {
        CAPTURE(row.load);
        two.load_to(row.load);
        CHECK(std::abs(two.pmf().back() - row.large) < 1e-5);
        CHECK(std::abs(two.pmf()[at(small)] - row.small) < 1e-5);
    }
    CHECK(std::abs(finer(two, -1.0) + two.pmf()[at(small)] - .550764) < 1e-5);
    CHECK(std::abs(two.crushes() - .198477) < 1e-5);

    const ResolvedGrid one = even_nodes({0.0});
    Resolved mixed(one, with_width(0.05), top_node(one));
    mixed.load_to(8.0);
    mixed.load_to(2.0);
    CHECK(std::abs(mixed.pmf().back() - .539800) < 1e-5);
    mixed.remix();
    CHECK(mixed.settled_at() == 0.0);
    mixed.load_to(4.0);
    CHECK(std::abs(mixed.pmf().back() - .430813) < 1e-5);
    CHECK(std::abs(mixed.crushes() - .625644) < 1e-5);
}

TEST_CASE("random sequential adsorption is exact: of intact cells rho, rho^2 (1 - e^(-2 rho)) / 2 crush") {
    for (const double rho : {1.0, 0.5, 0.2}) {
        CAPTURE(rho);
        const ResolvedGrid grid = even_nodes({-2.25, 0.0});
        std::vector<double> pmf(at(grid.nodes()), 0.0);
        pmf.back() = rho;
        pmf[1] = 1.0 - rho;  // dust, far too small to crush or to be crushed by
        const double exact = 0.5 * rho * rho * -std::expm1(-2.0 * rho);
        double before = 0.0;
        for (const double tolerance : {0.02, 0.01, 0.005}) {
            ResolvedOptions options;
            options.tolerance = tolerance;
            Resolved law(grid, with_width(0.05), pmf, options);
            law.load_to(1.0);
            const double error = std::abs(1.0 * rho - law.pmf().back() - exact);
            CHECK(error < 5e-5);
            CHECK(error < 1.1 * law.step_error());
            if (before > 0.0 && rho == 1.0) CHECK(before / error > 2.5);  // second order
            before = error;
        }
    }
}

TEST_CASE("loads on the way, unloading, copies and threads change no bit") {
    for (unsigned seed = 20; seed < 24; ++seed) {
        CAPTURE(seed);
        RandomCase c = RandomCase::draw(seed);
        Resolved at_once(c.grid, c.material, c.pmf, c.options);
        at_once.load_to(60.0);
        c.options.threads = 2;
        Resolved stepped(c.grid, c.material, c.pmf, c.options);
        for (const double load : {0.3, 1.0, 1.01, 7.0, 3.0, 40.0}) stepped.load_to(load);
        Resolved copy = stepped;
        Resolved stored(c.grid, c.material, stepped.record(), c.options);
        CHECK(stored.triples() == stepped.triples());
        stepped.load_to(60.0);
        copy.load_to(60.0);
        stored.load_to(60.0);
        for (const Resolved* other : {&stepped, &copy, &stored}) {
            CHECK(other->pmf() == at_once.pmf());
            CHECK(other->triples() == at_once.triples());
            CHECK(other->crushes() == at_once.crushes());
            CHECK(other->avalanches() == at_once.avalanches());
            CHECK(other->settled_at() == 60.0);
        }
        stepped.load_to(5.0);
        CHECK(stepped.triples() == at_once.triples());
        stepped.remix();
        at_once.remix();
        stepped.load_to(9.0);
        at_once.load_to(9.0);
        CHECK(stepped.pmf() == at_once.pmf());
        CHECK(stepped.crushes() > copy.crushes());
    }
}

TEST_CASE("sizes times e^q and loads times e^(-3 q / w) change nothing") {
    for (unsigned seed = 30; seed < 34; ++seed) {
        CAPTURE(seed);
        const RandomCase c = RandomCase::draw(seed);
        const double q = 0.75;
        std::vector<double> lower;
        std::vector<double> upper;
        for (Index i = 0; i < c.grid.nodes(); ++i) {
            lower.push_back(c.grid.lower(i) + q);
            upper.push_back(c.grid.upper(i) + q);
        }
        Resolved here(c.grid, c.material, c.pmf, c.options);
        Resolved there(ResolvedGrid(lower, upper), c.material, c.pmf, c.options);
        here.load_to(30.0);
        there.load_to(30.0 * std::exp(-3.0 * q / c.material.weibull_modulus));
        CHECK(helpers::largest_difference(here.pmf(), there.pmf()) < 1e-11);
        CHECK(here.crushes() == doctest::Approx(there.crushes()).epsilon(1e-11));
    }
}

TEST_CASE("a random mixture counted triple by triple is that mixture") {
    const RandomCase c = RandomCase::draw(40);
    const Index nodes = c.grid.nodes();
    std::vector<double> triples;
    for (Index b = 0; b < nodes; ++b) {
        for (Index a = 0; a < nodes; ++a) {
            for (Index k = 0; k < nodes; ++k) triples.push_back(c.pmf[at(b)] * (c.pmf[at(a)] * c.pmf[at(k)]));
        }
    }
    Resolved counted = Resolved::of_triples(c.grid, c.material, triples, c.options);
    Resolved mixed(c.grid, c.material, c.pmf, c.options);
    counted.load_to(20.0);
    mixed.load_to(20.0);
    CHECK(counted.pmf() == mixed.pmf());

    triples[at((1 * nodes + 2) * nodes + 3)] += 1e-6;
    CHECK_THROWS_AS(Resolved::of_triples(c.grid, c.material, triples, c.options), ParameterError);
}

TEST_CASE("triples of a ring are counted in both directions") {
    const ResolvedGrid grid({-3.0, -2.0, -1.0, 0.0}, {-2.0, -1.0, 0.0, 0.0});
    const std::vector<double> psi{0.0, -0.5, -1.5, 0.0};
    const std::vector<double> triples = comminute::count_triples(psi, grid);
    const auto mass = [&](Index b, Index a, Index c) { return triples[at((b * 4 + a) * 4 + c)]; };
    CHECK(mass(2, 3, 1) == 0.125);
    CHECK(mass(2, 1, 3) == 0.125);
    CHECK(mass(1, 2, 3) == 0.125);
    CHECK(mass(3, 1, 3) == 0.125);
    CHECK(mass(3, 3, 2) == 0.125);
    CHECK(std::accumulate(triples.begin(), triples.end(), 0.0) == 1.0);
    CHECK_THROWS_WITH_AS(comminute::count_triples(std::vector<double>{0.0, 0.1, 0.0}, grid),
                         "psi[1] is 0.1; the nodes end at 0", ParameterError);
}

TEST_CASE("the joint law on bins has the grading's margin, and before any load the mixture's") {
    const RandomCase c = RandomCase::draw(50);
    Resolved law(c.grid, c.material, c.pmf, c.options);
    law.load_to(50.0);
    const comminute::LogGrid bins(-6.9, 0.1, 71);
    const std::vector<double> joint = law.joint(bins);
    CHECK(std::accumulate(joint.begin(), joint.end(), 0.0) == doctest::Approx(1.0).epsilon(1e-12));
    const std::vector<double> pmf = law.pmf();
    for (Index j = 1; j < bins.bins(); ++j) {  // at its edges the grading is read within its nodes
        double below = 0.0;
        for (Index i = 0; i < j * bins.bins(); ++i) below += joint[at(i)];
        double expected = 0.0;
        for (Index i = 0; i < c.grid.nodes(); ++i) {
            const double edge = bins.edge(j);
            if (c.grid.exact(i)) {
                expected += c.grid.lower(i) < edge ? pmf[at(i)] : 0.0;
            } else {
                expected += pmf[at(i)] * std::clamp((edge - c.grid.lower(i)) / c.grid.width(i), 0.0, 1.0);
            }
        }
        CHECK(below == doctest::Approx(expected).epsilon(1e-9));
    }
    CHECK_THROWS_AS(law.joint(comminute::LogGrid(-6.0, -0.5, 30)), ParameterError);
    const double spacing = 0.1 + 1e-17;
    const comminute::LogGrid ends(-7.05 * (1.0 - 1e-16), -0.5 * spacing * (1.0 + 4e-15),
                                  71);  // at 0 less rounding
    const std::vector<double> again = law.joint(ends);
    CHECK(std::accumulate(again.begin(), again.end(), 0.0) == doctest::Approx(1.0).epsilon(1e-12));
}

TEST_CASE("nodes are narrow below what jumps, and widen") {
    const ResolvedGrid grid = ResolvedGrid::graded(0.05, -8.0, {0.0}, {});
    REQUIRE(grid.nodes() == 46);
    std::vector<double> falling;
    for (Index i = grid.nodes() - 2; i > 0; --i) falling.push_back(grid.lower(i));
    const std::vector<double> first{-.04, -.08, -.12, -.18, -.27, -.405, -.605, -.805};
    for (std::size_t k = 0; k < first.size(); ++k) CHECK(falling[k] == doctest::Approx(first[k]));
    CHECK(falling[falling.size() - 2] == doctest::Approx(-7.805));
    CHECK(falling.back() == -8.0);

    const ResolvedGrid spread = ResolvedGrid::graded(0.2, -6.0, {}, {{-0.4, 0.0}}, {}, {-0.2, -3.0});
    int inside = 0;
    for (Index i = 1; i < spread.nodes(); ++i) inside += spread.lower(i) >= -0.4;
    CHECK(inside >= 8);
    for (const double edge : {-0.2, -3.0}) {
        bool there = false;
        for (Index i = 1; i < spread.nodes(); ++i) there |= std::abs(spread.lower(i) - edge) < 1e-9;
        CHECK(there);
    }
    for (Index i = 1; i < spread.nodes(); ++i) CHECK(spread.width(i) < 0.2 * 1.5 + 1e-12);
}

TEST_CASE("gradings come to their nodes with all their mass") {
    const std::vector<comminute::Grading> gradings{
        comminute::monodisperse(2.0),
        comminute::gap_graded(1.0, 0.1),
        comminute::uniform_size(0.5, 1.0),
        comminute::power_law(2.5, 1e-2, 1.0),
        comminute::lognormal(0.5, 0.3),
        comminute::rosin_rammler(0.5, 2.0),
        comminute::Grading{
            comminute::SieveCurve{{0.1, 0.5, 1.0, 2.0}, {0.02, 0.3, 0.8, 1.0}, 1.5}, "mm", {}}};
    for (const auto& grading : gradings) {
        const ResolvedGrid grid = comminute::fitting_nodes(grading, 0.05);
        const std::vector<double> pmf = node_pmf(grading, grid);
        CHECK(std::accumulate(pmf.begin(), pmf.end(), 0.0) == doctest::Approx(1.0).epsilon(1e-14));
        CHECK(grid.nodes() < 90);
        double below = 0.0;
        for (Index i = 0; i < grid.nodes(); ++i) {
            below += pmf[at(i)];
            if (i + 1 < grid.nodes() && grid.exact(i + 1)) continue;  // of the same upper end
            CHECK(below ==
                  doctest::Approx(grading.finer(std::exp(grid.upper(i)) * (1.0 + 1e-12))).epsilon(1e-9));
        }
    }
    CHECK_THROWS_AS(node_pmf(comminute::monodisperse(2.0), even_nodes({0.0})), ParameterError);
}

TEST_CASE("sizes that are asked for are ends of bins, and exact sizes lie on the edges of bins") {
    const std::vector<double> asked{1.0, -0.3, -2.5, -9.5};
    const ResolvedGrid grid = comminute::fitting_nodes(comminute::gap_graded(1.0, 0.1), 0.05, {}, asked);
    const std::vector<double> edges = grid.edges();
    CHECK(grid.bins() == grid.nodes() - 2);
    CHECK(static_cast<Index>(edges.size()) == grid.bins() + 1);
    for (const double wanted : {-0.3, -2.5, -9.5, 0.0, std::log(0.1)})
        CHECK(std::count(edges.begin(), edges.end(), wanted) == 1);
    CHECK(edges.back() == 0.0);
    CHECK(edges[1] == -9.5);
    CHECK(std::is_sorted(edges.begin(), edges.end()));
    CHECK_THROWS_AS(comminute::fitting_nodes(comminute::monodisperse(1.0), 0.05, {}, {std::nan("")}),
                    ParameterError);
}

TEST_CASE("many materials are their single runs, whatever the threads") {
    const ResolvedGrid grid = ResolvedGrid::graded(0.05, -8.0, {0.0}, {});
    const std::vector<Material> materials{with_width(0.05), with_width(0.1), with_width(0.2)};
    const std::vector<double> loads{1.0, 8.0, 4.0, 2.0, 1.5, 30.0};
    const std::vector<double> pmf = top_node(grid);
    const auto found = comminute::resolved_gradings(grid, pmf, materials, {loads.data(), 3, 2}, {}, 2);
    for (Index m = 0; m < 3; ++m) {
        Resolved law(grid, materials[at(m)], pmf);
        for (Index t = 0; t < 2; ++t) {
            law.load_to(loads[at(2 * m + t)]);
            const auto from = found.begin() + (2 * m + t) * grid.nodes();
            CHECK(law.pmf() == std::vector<double>(from, from + grid.nodes()));
        }
    }
    const auto stopped =
        comminute::resolved_gradings(grid, pmf, materials, {loads.data(), 3, 2}, {}, 1, [] { return false; });
    CHECK(std::all_of(stopped.begin(), stopped.end(), [](double mass) { return mass == 0.0; }));
    CHECK_THROWS_AS(comminute::resolved_gradings(grid, pmf, materials, {loads.data(), 2, 2}), ShapeError);
}

TEST_CASE("what the law of three cells cannot take is refused") {
    const ResolvedGrid grid = even_nodes({0.0});
    const std::vector<double> pmf = top_node(grid);
    Material off;
    off.fabric_width = helpers::infinity;
    CHECK_THROWS_AS(Resolved(grid, off, pmf), ParameterError);
    CHECK_THROWS_WITH_AS(Resolved(grid, Material{}, std::vector<double>(3, 1.0 / 3.0)),
                         "pmf has 3 entries; the grid has 34 nodes", ShapeError);
    std::vector<double> bad = pmf;
    bad[3] = -0.1;
    CHECK_THROWS_AS(Resolved(grid, Material{}, bad), ParameterError);
    bad[3] = 0.5;
    CHECK_THROWS_AS(Resolved(grid, Material{}, bad), ParameterError);
    ResolvedOptions options;
    options.tolerance = 0.0;
    CHECK_THROWS_WITH_AS(Resolved(grid, Material{}, pmf, options),
                         "tolerance is 0; it must be greater than 0", ParameterError);
    options = {};
    options.threads = 3;
    CHECK_THROWS_AS(Resolved(grid, Material{}, pmf, options), ParameterError);
    Resolved law(grid, Material{}, pmf);
    CHECK_THROWS_AS(law.load_to(helpers::not_a_number), ParameterError);
    CHECK_THROWS_AS(law.load_to(-1.0), ParameterError);
    CHECK_THROWS_AS(ResolvedGrid({-2.0, -1.0, 0.5}, {-1.0, 0.0, 1.0}), ParameterError);
    CHECK_THROWS_AS(ResolvedGrid({-2.0, -1.0}, {-1.0, 0.0}), ShapeError);
    CHECK_THROWS_AS(ResolvedGrid({-2.0, -1.0, -1.0}, {-1.0, -1.0, -1.0}), ParameterError);
    CHECK_THROWS_AS(ResolvedGrid::graded(0.05, 1.0, {0.0}, {}), ParameterError);
    CHECK_THROWS_AS(ResolvedGrid::graded(0.05, -8.0, {0.0}, {{-1.0, -1.0}}), ParameterError);
}
