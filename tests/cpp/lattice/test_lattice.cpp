// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "comminute/comminute.hpp"

using comminute::FragmentLaw;
using comminute::Grading;
using comminute::Index;
using comminute::Lattice;
using comminute::LatticeOptions;
using comminute::LatticeState;
using comminute::LogGrid;
using comminute::Material;
using comminute::Mean;
using comminute::ParameterError;
using comminute::ShapeError;
using comminute::TimeSteppedLattice;
using comminute::TimeStepping;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
using Numbers = std::vector<double>;

Numbers psi_of(const LatticeState& lattice, Index replica = 0) {
    Numbers psi(static_cast<std::size_t>(lattice.cells()));
    lattice.psi(replica, psi);
    return psi;
}

LatticeOptions with(Index replicas, Index threads, std::uint64_t seed = 0) {
    LatticeOptions options;
    options.replicas = replicas;
    options.threads = threads;
    options.seed = seed;
    return options;
}

// Largest distance of a sample from a continuous cdf, in units of 1/sqrt(n). Above 2.23 in 1 of 10^4 samples.
template <class Cdf>
double kolmogorov(Numbers sample, const Cdf& cdf) {
    std::sort(sample.begin(), sample.end());
    const auto n = static_cast<double>(sample.size());
    double distance = 0.0;
    for (std::size_t q = 0; q < sample.size(); ++q) {
        const double f = cdf(sample[q]);
        distance = std::max({distance, static_cast<double>(q + 1) / n - f, f - static_cast<double>(q) / n});
    }
    return distance * std::sqrt(n);
}

Material fabric_off() {
    Material material;
    material.fabric_width = infinity;
    return material;
}

double log_critical(const Material& material, const Numbers& psi, std::size_t c) {
    const std::size_t count = psi.size();
    const double mean = 0.5 * (std::exp(psi[(c + count - 1) % count]) + std::exp(psi[(c + 1) % count]));
    return std::log(comminute::critical_stress_ratio(material, std::exp(psi[c]), mean));
}

const std::vector<Grading>& starts() {
    static const std::vector<Grading> all{comminute::monodisperse(1.0), comminute::gap_graded(1.0, 0.1),
                                          comminute::uniform_size(0.9, 1.0),
                                          comminute::power_law(2.5, 1e-3, 1.0)};
    return all;
}

}  // namespace

TEST_CASE("equal sizes at their critical load: random sequential adsorption") {
    Lattice lattice(20'000, Material{}, comminute::monodisperse(1.0), with(40, 1, 7));
    lattice.load_to(1.0);
    const Numbers crushed = lattice.mean_crushes();
    const double mean = std::accumulate(crushed.begin(), crushed.end(), 0.0) / 40.0;
    double square = 0.0;
    for (const double x : crushed) square += (x - mean) * (x - mean);
    const double error = std::sqrt(square / 39.0 / 40.0);
    CHECK(error < 5e-4);
    CHECK(std::abs(mean - 0.5 * (1.0 - std::exp(-2.0))) < 3.0 * error);
}

TEST_CASE("the zone is closed, whatever the rounding of sizes and loads") {
    for (const double size : {1.0, 0.1, 0.3, 2.7, 1e-5}) {
        for (const double w : {1.0, 3.0, 5.7}) {
            Material material;
            material.weibull_modulus = w;
            material.reference_size = 1.7;
            const double critical = comminute::critical_stress_ratio(material, size, size);
            Lattice lattice(100, material, comminute::monodisperse(size));
            CHECK(lattice.load_to(critical * (1.0 - 1e-12)) == 0);
            CHECK(lattice.load_to(critical) > 30);
        }
    }
}

TEST_CASE("two and three cells by hand") {
    const Material material = fabric_off();
    Lattice pair(Numbers{1.0, 0.5}, material);  // without fabric a size s crushes at 1/s
    CHECK(pair.load_to(0.999) == 0);
    CHECK(pair.load_to(1.0) >= 1);
    CHECK(psi_of(pair)[0] < 0.0);
    CHECK(psi_of(pair)[1] == std::log(0.5));
    pair.load_to(2.0);
    CHECK(psi_of(pair)[0] < std::log(0.5));
    CHECK(psi_of(pair)[1] < std::log(0.5));

    // The middle cell's neighbours have mean 0.75: it crushes where Eq. 2 says, long before the others.
    Material wide;
    wide.fabric_width = 0.5;
    Lattice three(Numbers{0.5, 0.75, 1.0}, wide);
    const double middle = comminute::critical_stress_ratio(wide, 0.75, 0.75);
    const double large = comminute::critical_stress_ratio(wide, 1.0, 0.625);
    const double small = comminute::critical_stress_ratio(wide, 0.5, 0.875);
    REQUIRE(middle < std::min(large, small));
    CHECK(three.load_to(middle * (1.0 - 1e-12)) == 0);
    CHECK(three.load_to(middle) >= 1);
    CHECK(three.crushes(0)[1] >= 1);
}

TEST_CASE("results do not depend on the number of threads, nor replicas on each other") {
    for (const Grading& start : starts()) {
        Lattice one(3000, Material{}, start, with(7, 1, 5));
        one.load_to(4.0);
        one.remix();
        one.load_to(50.0);
        for (const Index threads : {2, 5}) {
            Lattice many(3000, Material{}, start, with(7, threads, 5));
            many.load_to(4.0);
            many.remix();
            many.load_to(50.0);
            CHECK(one == many);
        }
        Lattice fewer(3000, Material{}, start, with(2, 1, 5));
        fewer.load_to(4.0);
        fewer.remix();
        fewer.load_to(50.0);
        CHECK(psi_of(fewer, 1) == psi_of(one, 1));
        CHECK(psi_of(one, 0) != psi_of(one, 1));
        Lattice other(3000, Material{}, start, with(1, 1, 6));
        other.load_to(4.0);
        CHECK(psi_of(other) != psi_of(one));
    }
}

TEST_CASE("pauses on the way change nothing, nor does unloading") {
    for (const Grading& start : starts()) {
        LatticeOptions options = with(1, 1, 3);
        options.record_avalanches = true;
        Lattice at_once(20'000, Material{}, start, options);
        at_once.load_to(100.0);
        Lattice paused(20'000, Material{}, start, options);
        for (const double load : {1.0, 2.0, 0.5, 8.0, 8.0, 0.0, 99.0, 100.0}) paused.load_to(load);
        CHECK(paused == at_once);
        CHECK(paused.settled_at() == 100.0);
        CHECK(paused.load_to(20.0) == 0);
        CHECK(paused == at_once);
    }
}

TEST_CASE("after a load no cell is weaker than it") {
    for (const Grading& start : starts()) {
        for (const double n : {0.05, 0.5, 3.0}) {
            Material material;
            material.fabric_width = n;
            Lattice lattice(5000, material, start);
            lattice.load_to(30.0);
            const Numbers psi = psi_of(lattice);
            double weakest = infinity;
            for (std::size_t c = 0; c < psi.size(); ++c)
                weakest = std::min(weakest, log_critical(material, psi, c));
            CHECK(weakest > std::log(30.0) - 1e-12);
        }
    }
}

TEST_CASE("an interrupted load is finished by the next one, and ends as if undisturbed") {
    for (const Grading& start : starts()) {
        for (const int patience : {0, 1, 3}) {
            for (const Index threads : {1, 2}) {
                Lattice undisturbed(200'000, Material{}, start, with(2, 1, 9));
                undisturbed.load_to(1000.0);
                Lattice lattice(200'000, Material{}, start, with(2, threads, 9));
                int asked = 0;
                lattice.load_to(1000.0, [&] { return asked++ < patience; });
                // with more threads the answer may come when all has been done
                if (threads == 1) CHECK(lattice.settled_at().has_value() == (asked <= patience));
                lattice.load_to(0.0);
                CHECK(lattice == undisturbed);
            }
        }
    }
    Lattice thrown(200'000, Material{}, starts()[0], with(2, 2, 9));
    try {
        thrown.load_to(1000.0, []() -> bool { throw std::runtime_error("enough"); });
    } catch (const std::runtime_error& error) {
        CHECK(std::string(error.what()) == "enough");
    }
    Lattice undisturbed(200'000, Material{}, starts()[0], with(2, 1, 9));
    undisturbed.load_to(1000.0);
    thrown.load_to(1000.0);
    CHECK(thrown == undisturbed);
}

TEST_CASE("an interrupted time-stepped load is finished as well") {
    const auto make = [] {
        return TimeSteppedLattice(20'000, Material{}, starts()[1], {0.3, 1.2}, with(1, 1, 2));
    };
    TimeSteppedLattice undisturbed = make();
    undisturbed.load_to(20.0);
    TimeSteppedLattice lattice = make();
    int asked = 0;
    lattice.load_to(20.0, [&] { return asked++ < 40; });
    CHECK_FALSE(lattice.settled_at().has_value());
    lattice.load_to(1.0);
    CHECK(lattice == undisturbed);
    CHECK(lattice.settled_at() == 20.0);
}

TEST_CASE("remixing moves cells about and forgets the load") {
    Lattice lattice(5000, Material{}, starts()[3], with(2, 2, 1));
    lattice.load_to(10.0);
    const Numbers before = psi_of(lattice, 1);
    const auto counts = lattice.crushes(1);
    std::vector<std::pair<double, std::uint32_t>> pairs;
    for (std::size_t c = 0; c < before.size(); ++c)
        pairs.emplace_back(before[c], counts[static_cast<Index>(c)]);
    lattice.remix();
    CHECK_FALSE(lattice.settled_at().has_value());
    const Numbers after = psi_of(lattice, 1);
    const auto moved = lattice.crushes(1);
    std::vector<std::pair<double, std::uint32_t>> pairs_after;
    for (std::size_t c = 0; c < after.size(); ++c)
        pairs_after.emplace_back(after[c], moved[static_cast<Index>(c)]);
    CHECK(pairs != pairs_after);
    std::sort(pairs.begin(), pairs.end());
    std::sort(pairs_after.begin(), pairs_after.end());
    CHECK(pairs == pairs_after);
    CHECK(lattice.load_to(10.0) > 0);
}

TEST_CASE("a permutation puts every cell everywhere alike") {
    // 5 cells, 24 000 replicas: chi-square over the 25 places has 16 degrees of freedom; above 45 in 1 of 10^4.
    Numbers sizes{0.1, 0.2, 0.3, 0.4, 0.5};
    Lattice lattice(sizes, Material{}, with(24'000, 1, 4));
    lattice.remix();
    std::vector<int> count(25, 0);
    for (Index r = 0; r < lattice.replicas(); ++r) {
        const Numbers psi = psi_of(lattice, r);
        for (std::size_t c = 0; c < 5; ++c)
            ++count[5 * c + static_cast<std::size_t>(std::lround(10.0 * std::exp(psi[c])) - 1)];
    }
    double chi = 0.0;
    for (const int k : count) chi += (k - 4800.0) * (k - 4800.0) / 4800.0;
    CHECK(chi * 4.0 / 5.0 < 45.0);  // rows and columns are fixed: 4/5 of the plain sum is chi-square
}

TEST_CASE("fragments follow their law") {
    const std::vector<FragmentLaw> laws{
        comminute::WeibullFragments{},
        comminute::WeibullFragments{0.3, 2.5},
        comminute::WeibullFragments{20.0, 0.5},
        comminute::PowerLawFragments{},
        comminute::PowerLawFragments{0.4},
        comminute::LogNormalFragments{-1.0, 0.5},
        comminute::LogNormalFragments{3.0, 0.5},
        comminute::LogNormalFragments{-8.0, 2.0},
        comminute::TabulatedFragments{{0.25, 0.5, 1.0}, {0.0, 0.4, 1.0}},
        comminute::TabulatedFragments{{0.1, 0.2, 0.7, 1.0}, {0.1, 0.3, 0.3, 1.0}}};
    for (const FragmentLaw& law : laws) {
        Material material;
        material.fragments = law;
        TimeSteppedLattice lattice(20'000, material, comminute::monodisperse(1.0), {1.0, infinity});
        CHECK(lattice.pass(1.0) == 20'000);
        const Numbers psi = psi_of(lattice);
        CHECK(*std::max_element(psi.begin(), psi.end()) <= 0.0);
        CHECK(kolmogorov(psi, [&](double r) {
                  return std::visit([r](const auto& l) { return l.cdf(r); }, law);
              }) < 2.23);
    }
}

TEST_CASE("starts follow their grading") {
    const std::vector<Grading> gradings{
        comminute::power_law(2.5, 1e-3, 2.0),
        comminute::power_law(3.5, 1e-3, 2.0),
        comminute::power_law(2.9, 0.0, 2.0),
        comminute::log_uniform(0.1, 1.0),
        comminute::uniform_size(0.9, 1.0),
        comminute::lognormal(0.5, 0.8),
        comminute::lognormal(0.5, 0.8, 0.4),
        comminute::rosin_rammler(0.5, 1.3),
        comminute::sieve_grading({0.1, 0.5, 1.0, 2.0}, {5.0, 40.0, 40.0, 100.0})};
    for (const Grading& grading : gradings) {
        Lattice lattice(20'000, Material{}, grading, with(1, 1, 12));
        const Numbers psi = psi_of(lattice);
        CHECK(*std::max_element(psi.begin(), psi.end()) <= std::log(grading.largest()) + 1e-15);
        CHECK(kolmogorov(psi, [&](double x) { return grading.finer(std::exp(x)); }) < 2.23);
    }
    Lattice gap(100'000, Material{}, comminute::gap_graded(1.0, 0.1, 0.3));
    const Numbers psi = psi_of(gap);
    const auto coarse = std::count(psi.begin(), psi.end(), 0.0);
    CHECK(coarse + std::count(psi.begin(), psi.end(), std::log(0.1)) == 100'000);
    CHECK(std::abs(static_cast<double>(coarse) - 30'000.0) < 4.0 * std::sqrt(100'000 * 0.21));
}

TEST_CASE("histograms count every cell") {
    const LogGrid grid(-8.0, 0.0, 81);
    Lattice lattice(10'000, Material{}, starts()[1], with(3, 2, 1));
    lattice.load_to(8.0);
    const auto rows = lattice.grainsizes(grid);
    REQUIRE(rows.size() == 3);
    Numbers mean(81, 0.0);
    for (const auto& row : rows) {
        CHECK(std::accumulate(row.begin(), row.end(), 0.0) == doctest::Approx(1.0).epsilon(1e-12));
        for (std::size_t i = 0; i < 81; ++i) mean[i] += row[i] / 3.0;
    }
    const auto fabric = lattice.fabric(grid);
    CHECK(fabric.settled_at() == 8.0);
    const auto cdf = lattice.cdf(grid);
    double below = 0.0;
    for (std::size_t i = 0; i < 81; ++i) {
        below += mean[i];
        CHECK(fabric.grainsize()[static_cast<Index>(i)] == doctest::Approx(mean[i]).epsilon(1e-9));
        CHECK(cdf.mean[i] == doctest::Approx(below).epsilon(1e-9));
    }
    CHECK(cdf.standard_error[40] > 0.0);
    CHECK(std::isnan(Lattice(10, Material{}, starts()[0]).cdf(grid).standard_error[0]));
}

TEST_CASE("avalanches add up to all crushes, at rising loads, the first of equal sizes being a large one") {
    LatticeOptions options = with(1, 1, 3);
    options.record_avalanches = true;
    Lattice lattice(50'000, Material{}, starts()[0], options);
    const auto at_one = lattice.load_to(1.0);
    REQUIRE(lattice.avalanches(0).size() == 1);
    CHECK(lattice.avalanches(0)[0].stress_ratio == 1.0);
    CHECK(lattice.avalanches(0)[0].crushes == at_one);
    const auto all = at_one + lattice.load_to(1000.0);
    std::uint64_t sum = 0;
    double load = 0.0;
    for (const auto& avalanche : lattice.avalanches(0)) {
        sum += avalanche.crushes;
        CHECK(avalanche.stress_ratio > load);
        load = avalanche.stress_ratio;
    }
    CHECK(sum == all);
    CHECK(load <= 1000.0 * (1.0 + 1e-12));
}

TEST_CASE("a geometric neighbour mean is the mean of log sizes") {
    Material material;
    material.fabric_width = 0.3;
    LatticeOptions options;
    options.mean = Mean::geometric;
    const Numbers sizes{1.0, 0.4, 0.16, 0.4};
    Lattice lattice(sizes, material, options);
    const double critical = comminute::critical_stress_ratio(material, 0.4, std::sqrt(1.0 * 0.16));
    REQUIRE(critical < comminute::critical_stress_ratio(material, 1.0, 0.4));
    CHECK(lattice.load_to(critical * (1.0 - 1e-12)) == 0);
    CHECK(lattice.load_to(critical) >= 1);
}

TEST_CASE("sizes that a double cannot hold are kept by their logs") {
    Material material = fabric_off();
    material.fragments = comminute::PowerLawFragments{0.01};  // R = -100 on average
    Lattice lattice(1000, material, comminute::monodisperse(1.0));
    lattice.load_to(1.0);
    const Numbers psi = psi_of(lattice);
    CHECK(*std::min_element(psi.begin(), psi.end()) < -745.0);
    CHECK(*std::min_element(psi.begin(), psi.end()) > -infinity);
}

TEST_CASE("one pass of probability 1 crushes equal sizes whole") {
    TimeSteppedLattice lattice(1000, Material{}, comminute::monodisperse(1.0), {1.0, 1.01}, with(2, 2));
    CHECK(lattice.pass(0.99) == 0);
    CHECK(lattice.pass(1.0) == 2000);
    CHECK(lattice.settled_at() == 1.0);
    lattice.pass(1e6);
    CHECK_FALSE(lattice.settled_at().has_value());
    lattice.load_to(1.0);
    CHECK(lattice.settled_at() == 1e6);
}

TEST_CASE("a fitting grid holds every cell of a lattice and leaves room below for the load to come") {
    comminute::Material material;
    material.reference_size = 1.7;
    LatticeOptions options;
    options.replicas = 3;
    for (const auto& grading : {comminute::monodisperse(2.0), comminute::power_law(2.5, 1e-3, 2.0)}) {
        Lattice lattice(300, material, grading, options);
        for (const double load : {0.0, 20.0}) {
            lattice.load_to(load);
            Numbers psi(300), all;
            for (Index r = 0; r < 3; ++r) {
                lattice.psi(r, psi);
                all.insert(all.end(), psi.begin(), psi.end());
            }
            const auto [low, high] = std::minmax_element(all.begin(), all.end());
            const LogGrid grid = lattice.fitting_grid(100.0);
            const bool spread = *low < *high;
            CHECK((spread ? grid.edge(grid.bins()) : grid.psi_max()) ==
                  doctest::Approx(*high).epsilon(1e-14));
            CHECK(grid.edge(1) < *low);
            CHECK(lattice.grainsizes(grid).size() == 3);
            CHECK(comminute::CrushZones(grid, material, 100.0).distrusted_below() == -infinity);
            comminute::GridOptions wide;
            wide.spacing = 0.1;
            CHECK(lattice.fitting_grid(100.0, wide).bins() < grid.bins());
        }
    }
}

TEST_CASE("messages of the lattice: value, rule, remedy") {
    const Grading one = comminute::monodisperse(1.0);
    CHECK_THROWS_WITH_AS(Lattice(1, Material{}, one),
                         "cells is 1; it must be at least 2 (a ring) and less than 2^32 - 1", ParameterError);
    CHECK_THROWS_WITH_AS(Lattice(10, Material{}, one, with(0, 1)), "replicas is 0; it must be at least 1",
                         ParameterError);
    CHECK_THROWS_WITH_AS(Lattice(10, Material{}, one, with(1, 0)), "threads is 0; it must be at least 1",
                         ParameterError);
    CHECK_THROWS_WITH_AS(Lattice(Numbers{1.0, -2.0}, Material{}),
                         "sizes[1] is -2; it must be greater than 0 and finite", ParameterError);
    Lattice lattice(10, Material{}, one);
    CHECK_THROWS_WITH_AS(lattice.load_to(-1.0),
                         "stress_ratio is -1; it must be a number of at least 0 (0 is no load)",
                         ParameterError);
    CHECK_THROWS_AS(lattice.load_to(std::nan("")), ParameterError);
    CHECK_THROWS_WITH_AS(lattice.load_to(infinity),
                         "stress_ratio is inf; it must be at most e^700: more crushes grains below e^-700 of "
                         "reference_size, which a double cannot hold",
                         ParameterError);
    CHECK_THROWS_WITH_AS(lattice.avalanches(0),
                         "avalanches were not recorded; set record_avalanches when the lattice is made",
                         ParameterError);
    CHECK_THROWS_WITH_AS(lattice.crushes(1),
                         "replica is 1; it must be the index of a replica, 0 to replicas - 1",
                         ParameterError);
    Numbers small(9);
    CHECK_THROWS_WITH_AS(lattice.psi(0, small), "out has 9 entries; the ring has 10 cells", ShapeError);
    CHECK_THROWS_AS(lattice.cdf(LogGrid(-6.0, -1.0, 51)), ParameterError);
    CHECK_THROWS_WITH_AS(TimeSteppedLattice(10, Material{}, one, {0.0, 1.01}),
                         "crush_probability is 0; it must be greater than 0 and at most 1", ParameterError);
    CHECK_THROWS_WITH_AS(TimeSteppedLattice(10, Material{}, one, {0.1, 1.0}),
                         "load_factor is 1; it must be greater than 1 (inf: no loads on the way)",
                         ParameterError);
}
