// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include "support/helpers.hpp"

using comminute::Fabric;
using comminute::LogGrid;
using comminute::Mean;
using comminute::mixed_fabric;
using comminute::ParameterError;
using comminute::ShapeError;
using helpers::at;
using helpers::Index;
using helpers::random_state;
using helpers::State;

namespace {

std::vector<double> random_pmf(Index bins, std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<double> pmf(at(bins));
    for (double& share : pmf) share = unit(random) < 0.3 ? 0.0 : unit(random);
    const double sum = helpers::sum_of(pmf);
    for (double& share : pmf) share /= sum;
    return pmf;
}

// Every pair of neighbours by itself: its mean is shared between the two centres around it, by size or by
// log size.
std::vector<double> neighbourhood_by_pairs(const LogGrid& grid, const std::vector<double>& pmf, Mean mean) {
    std::vector<double> place(pmf.size());
    for (Index i = 0; i < grid.bins(); ++i) {
        place[at(i)] = mean == Mean::arithmetic ? std::exp(grid.centre(i)) : grid.centre(i);
    }
    std::vector<double> result(pmf.size(), 0.0);
    for (std::size_t a = 0; a < pmf.size(); ++a) {
        for (std::size_t b = 0; b < pmf.size(); ++b) {
            const double between = 0.5 * (place[a] + place[b]);
            std::size_t upper = 1;
            while (upper + 1 < place.size() && place[upper] < between) ++upper;
            const double weight = (between - place[upper - 1]) / (place[upper] - place[upper - 1]);
            result[upper] += weight * pmf[a] * pmf[b];
            result[upper - 1] += (1.0 - weight) * pmf[a] * pmf[b];
        }
    }
    return result;
}

template <class F>
double expectation(const LogGrid& grid, const std::vector<double>& pmf, const F& f) {
    long double sum = 0.0L;
    for (Index i = 0; i < grid.bins(); ++i) sum += static_cast<long double>(pmf[at(i)]) * f(grid.centre(i));
    return static_cast<double>(sum);
}

const auto size_of = [](double psi) { return std::exp(psi); };
const auto log_size_of = [](double psi) { return psi; };

}  // namespace

TEST_CASE("a fabric hands out the numbers it was given, and their sums by row and by column") {
    std::mt19937_64 random(41);
    const LogGrid grid(-4.0, 1.0, 23);
    const State state = random_state(23, random, 1.0, 0.4);
    const Fabric fabric(grid, state.mass, {}, 12.5, Mean::geometric);
    CHECK(fabric.grid() == grid);
    CHECK(fabric.mean() == Mean::geometric);
    CHECK(fabric.settled_at() == 12.5);
    CHECK(!Fabric(grid, state.mass).settled_at().has_value());
    CHECK(Fabric(grid, state.mass).mean() == Mean::arithmetic);
    const auto p = fabric.probability();
    CHECK(p.rows() == 23);
    CHECK(p.cols() == 23);
    double worst = 0.0;
    for (Index i = 0; i < 23; ++i) {
        for (Index j = 0; j < 23; ++j) worst = std::max(worst, std::abs(p(i, j) - state(i, j)));
    }
    CHECK(worst == 0.0);
    const auto grainsize = fabric.grainsize();
    const std::vector<double> cdf = fabric.cdf();
    const std::vector<double> by_grain = state.by_grain();
    CHECK(helpers::largest_difference({grainsize.begin(), grainsize.end()}, by_grain) < 1e-16);
    CHECK(helpers::largest_difference(fabric.neighbourhood(), state.by_neighbour()) < 1e-16);
    double finer = 0.0;
    for (Index i = 0; i < 23; ++i) {
        finer += by_grain[at(i)];
        CHECK(std::abs(cdf[at(i)] - finer) < 1e-15);
    }
}

TEST_CASE("copies of a fabric share their numbers") {
    const Fabric fabric(LogGrid(-1.0, 0.0, 8), std::vector<double>(64, 1.0 / 64.0));
    const Fabric copy = fabric;
    Fabric assigned = mixed_fabric(LogGrid(-2.0, 0.0, 8), std::vector<double>(8, 0.125));
    assigned = fabric;
    CHECK(copy.probability().data() == fabric.probability().data());
    CHECK(assigned.probability().data() == fabric.probability().data());
    CHECK(copy.grainsize().data() == fabric.grainsize().data());
}

TEST_CASE("fabrics are equal when numbers, grid, load and mean all are") {
    std::mt19937_64 random(42);
    const LogGrid grid(-1.0, 0.0, 8);
    const std::vector<double> p = random_state(8, random).mass;
    const Fabric fabric(grid, p, {}, 2.0);
    CHECK(fabric == Fabric(grid, p, {}, 2.0));
    CHECK_FALSE(fabric == Fabric(grid, p, {}, 3.0));
    CHECK_FALSE(fabric == Fabric(grid, p));
    CHECK_FALSE(fabric == Fabric(grid, p, {}, 2.0, Mean::geometric));
    CHECK_FALSE(fabric == Fabric(LogGrid(-1.5, 0.0, 8), p, {}, 2.0));
    std::vector<double> other = p;
    other[9] += 1e-15;
    CHECK_FALSE(fabric == Fabric(grid, other, {}, 2.0));
}

TEST_CASE("a fabric refuses numbers that are not shares of one mass, giving their place") {
    const LogGrid grid(-1.0, 0.0, 8);
    const std::vector<double> even(64, 1.0 / 64.0);
    const auto with = [&](std::size_t place, double value) {
        std::vector<double> p = even;
        p[place] = value;
        return p;
    };
    CHECK_THROWS_WITH_AS(Fabric(grid, std::vector<double>(63, 1.0 / 63.0)),
                         "probability has 63 entries; the grid needs shape (8, 8)", ShapeError);
    CHECK_REFUSED(Fabric(grid, with(29, -0.25)),
                  "probability[3, 5] is -0.25; a share of the mass must be finite and at least 0");
    CHECK_REFUSED(Fabric(grid, with(63, helpers::not_a_number)),
                  "probability[7, 7] is nan; a share of the mass must be finite and at least 0");
    CHECK_REFUSED(Fabric(grid, with(0, helpers::infinity)),
                  "probability[0, 0] is inf; a share of the mass must be finite and at least 0");
    CHECK_REFUSED(Fabric(grid, std::vector<double>(64, 1.0 / 32.0)),
                  "probability adds up to 2; it holds the whole mass, 1. Divide it by its sum");
    CHECK_THROWS_AS(Fabric(grid, with(5, 1.0 / 64.0 + 2e-9)), ParameterError);
    CHECK_NOTHROW(Fabric(grid, with(5, 1.0 / 64.0 + 0.9e-9)));
    CHECK_REFUSED(Fabric(grid, even, {}, -1.0),
                  "stress_ratio is -1; it must be a number of at least 0 (0 is no load)");
    CHECK_REFUSED(Fabric(grid, even, {}, helpers::not_a_number),
                  "stress_ratio is nan; it must be a number of at least 0 (0 is no load)");
    CHECK_NOTHROW(Fabric(grid, even, {}, 0.0));

    CHECK_THROWS_WITH_AS(mixed_fabric(grid, std::vector<double>(9, 1.0 / 9.0)),
                         "grainsize has 9 entries; the grid has 8 bins", ShapeError);
    CHECK_THROWS_WITH_AS(comminute::neighbourhood_pmf(grid, even, Mean::arithmetic),
                         "grainsize has 64 entries; the grid has 8 bins", ShapeError);
    CHECK_REFUSED(mixed_fabric(grid, {0.5, 0.5, 0.5, -0.5, 0.0, 0.0, 0.0, 0.0}),
                  "grainsize[3] is -0.5; a share of the mass must be finite and at least 0");
    CHECK_REFUSED(mixed_fabric(grid, std::vector<double>(8, 0.25)),
                  "grainsize adds up to 2; it holds the whole mass, 1. Divide it by its sum");
}

TEST_CASE("the neighbourhood law is that of all pairs of neighbours") {
    std::mt19937_64 random(43);
    for (const Index bins : {8, 41, 90}) {
        for (const double range : {0.3, 4.0, 25.0}) {
            const LogGrid grid(-range, 0.7, bins);
            const std::vector<double> pmf = random_pmf(bins, random);
            for (const Mean mean : {Mean::arithmetic, Mean::geometric}) {
                const std::vector<double> own = comminute::neighbourhood_pmf(grid, pmf, mean);
                // 1e-13: weights are ratios of differences of nearby sizes
                CHECK(helpers::largest_difference(own, neighbourhood_by_pairs(grid, pmf, mean)) < 1e-13);
                CHECK(std::abs(helpers::sum_of(own) - 1.0) < 1e-15);
                CHECK(helpers::smallest_entry(own) >= 0.0);
            }
        }
    }
}

TEST_CASE("mixing keeps the mean size by the arithmetic mean, the mean log size by the geometric one") {
    std::mt19937_64 random(44);
    for (int q = 0; q < 20; ++q) {
        const auto bins = std::uniform_int_distribution<Index>(8, 150)(random);
        const LogGrid grid(-helpers::log_uniform(random, 0.2, 15.0), 0.3, bins);
        const std::vector<double> pmf = random_pmf(bins, random);
        const Fabric arithmetic = mixed_fabric(grid, pmf);
        const Fabric geometric = mixed_fabric(grid, pmf, Mean::geometric);
        CHECK(arithmetic.mean() == Mean::arithmetic);
        CHECK(expectation(grid, arithmetic.neighbourhood(), size_of) ==
              doctest::Approx(expectation(grid, pmf, size_of)).epsilon(4e-15));
        CHECK(expectation(grid, geometric.neighbourhood(), log_size_of) ==
              doctest::Approx(expectation(grid, pmf, log_size_of)).epsilon(4e-15));
        // and neighbours of unlike size make the one mean larger than the other
        CHECK(expectation(grid, arithmetic.neighbourhood(), log_size_of) >
              expectation(grid, geometric.neighbourhood(), log_size_of));
    }
}

TEST_CASE("in a mixed fabric grain and neighbourhood are independent") {
    std::mt19937_64 random(45);
    const LogGrid grid(-3.0, 0.0, 30);
    const std::vector<double> pmf = random_pmf(30, random);
    for (const Mean mean : {Mean::arithmetic, Mean::geometric}) {
        const Fabric fabric = mixed_fabric(grid, pmf, mean);
        const std::vector<double> neighbours = neighbourhood_by_pairs(grid, pmf, mean);
        double worst = 0.0;
        for (Index i = 0; i < 30; ++i) {
            for (Index j = 0; j < 30; ++j) {
                worst =
                    std::max(worst, std::abs(fabric.probability()(i, j) - pmf[at(i)] * neighbours[at(j)]));
            }
        }
        CHECK(worst < 1e-14);
        CHECK(!fabric.settled_at().has_value());
        CHECK(std::vector<double>(fabric.grainsize().begin(), fabric.grainsize().end()) == pmf);
    }
}

TEST_CASE("remixing a mixed fabric changes not one bit, remixing a crushed one forgets load and neighbours") {
    std::mt19937_64 random(46);
    const LogGrid grid(-3.0, 0.0, 30);
    for (const Mean mean : {Mean::arithmetic, Mean::geometric}) {
        const Fabric mixed = mixed_fabric(grid, random_pmf(30, random), mean);
        CHECK(comminute::remix(mixed) == mixed);

        const Fabric loaded(grid, random_state(30, random, 1.0, 0.8).mass, {}, 7.0, mean);
        const Fabric remixed = comminute::remix(loaded);
        CHECK(!remixed.settled_at().has_value());
        CHECK(remixed.mean() == mean);
        const std::vector<double> grains(loaded.grainsize().begin(), loaded.grainsize().end());
        CHECK(std::vector<double>(remixed.grainsize().begin(), remixed.grainsize().end()) == grains);
        CHECK(helpers::largest_difference(remixed.neighbourhood(),
                                          neighbourhood_by_pairs(grid, grains, mean)) < 1e-14);
    }
}

TEST_CASE("a mixed fabric is a fabric: its numbers make one again") {
    const LogGrid grid(-1.0, 0.0, 8);
    for (const double excess : {0.0, 8e-10, -8e-10}) {  // sums are accepted to 1e-9
        const Fabric mixed = mixed_fabric(grid, std::vector<double>(8, (1.0 + excess) / 8.0));
        const auto p = mixed.probability();
        CHECK_NOTHROW(Fabric(grid, {p.data(), p.data() + 64}, {}, mixed.settled_at(), mixed.mean()));
    }
}
