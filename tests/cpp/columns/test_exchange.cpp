// SPDX-License-Identifier: BSD-3-Clause
// One exchange between rows whose neighbours are correlated: against values worked out elsewhere and factors of the fabric.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "columns/exchange.hpp"
#include "columns/shifted_exchange.hpp"
#include "support/helpers.hpp"

using namespace comminute::detail;
using comminute::ResolvedGrid;
using helpers::Index;

namespace {

// The sizes 0.25, 0.5 and 1, and a fines bin that stays empty.
struct Rows {
    ResolvedGrid grid{
        {-4.0, std::log(0.2), std::log(0.25), std::log(0.25), std::log(0.5), std::log(0.5), 0.0},
        {std::log(0.2), std::log(0.25), std::log(0.25), std::log(0.5), std::log(0.5), 0.0, 0.0}};
    TripleTables tables{grid, comminute::Material{}, comminute::Mean::arithmetic};
    std::vector<double> sizes{0.01, 0.22, 0.25, 0.4, 0.5, 0.8, 1.0};
    std::vector<Index> exact{2, 4, 6};

    Index place(Index b, Index a, Index c) const {
        const Index nodes = grid.nodes();
        return (b * nodes + a) * nodes + c;
    }

    // A chain in which a neighbour is of the same size with the probability `same`, and drawn anew else.
    TripleState chain(const std::vector<double>& share, double same) const {
        const Index nodes = grid.nodes();
        std::vector<double> mass(at_size(nodes * nodes * nodes), 0.0);
        const auto step = [&](std::size_t from, std::size_t to) {
            return (from == to ? same : 0.0) + (1.0 - same) * share[to];
        };
        for (std::size_t b = 0; b < 3; ++b) {
            for (std::size_t a = 0; a < 3; ++a) {
                for (std::size_t c = 0; c < 3; ++c)
                    mass[at_size(place(exact[b], exact[a], exact[c]))] = share[b] * step(b, a) * step(b, c);
            }
        }
        return TripleState(tables, Triples{mass});
    }
    static std::size_t at_size(Index i) { return static_cast<std::size_t>(i); }

    std::vector<double> shares(const TripleState& row) const {
        std::vector<double> found = row.pmf(tables);
        double total = 0.0;
        for (const double mass : found) total += mass;
        for (double& mass : found) mass /= total;
        return found;
    }
    double pair(const TripleState& row, Index b, Index a) const {
        double sum = 0.0;
        for (Index c = 0; c < grid.nodes(); ++c) sum += row.mass(tables, b, a, c);
        return sum;
    }
};

struct Wanted {
    bool shifted;
    double lower_111, upper_111, lower_mixed, upper_mixed;
    double pair_11, pair_quarter;
};

}  // namespace

TEST_CASE("an exchange of two chains gives the values worked out elsewhere") {
    const Wanted cases[] = {
        {true, 0.25263072, 0.02897888, 0.00877800, 0.02245800, 0.34272, 0.05930},
        {false, 0.25229600, 0.02808188, 0.00895620, 0.02305020, 0.34240, 0.05950},
    };
    const double share[] = {0.23, 0.3, 0.47};
    const Rows rows;
    for (const Wanted& c : cases) {
        CAPTURE(c.shifted);
        TripleState lower = rows.chain({0.2, 0.3, 0.5}, 0.6);
        TripleState upper = rows.chain({0.5, 0.3, 0.2}, 0.2);
        FreshPairs below(rows.tables);
        FreshPairs above(rows.tables);
        Exchange exchange(rows.tables);
        const Swaps swaps{0.1, 0.0};
        if (c.shifted) {
            exchange_shifted(rows.tables, rows.sizes, swaps, exchange, lower, below, upper, above);
        } else {
            const std::vector<double> of_lower = rows.shares(lower);
            const std::vector<double> of_upper = rows.shares(upper);
            exchange.permuted(ArrivalRates(rows.sizes, {swaps, true, of_upper.data()}), lower, below);
            exchange.permuted(ArrivalRates(rows.sizes, {swaps, false, of_lower.data()}), upper, above);
        }
        below.merge(rows.tables, lower);
        above.merge(rows.tables, upper);
        const std::vector<double> pmf = lower.pmf(rows.tables);
        for (std::size_t k = 0; k < 3; ++k)
            CHECK(pmf[Rows::at_size(rows.exact[k])] == doctest::Approx(share[k]).epsilon(1e-12));
        CHECK(lower.mass(rows.tables, 6, 6, 6) == doctest::Approx(c.lower_111).epsilon(1e-7));
        CHECK(upper.mass(rows.tables, 6, 6, 6) == doctest::Approx(c.upper_111).epsilon(1e-7));
        CHECK(lower.mass(rows.tables, 4, 6, 2) == doctest::Approx(c.lower_mixed).epsilon(1e-7));
        CHECK(upper.mass(rows.tables, 4, 6, 2) == doctest::Approx(c.upper_mixed).epsilon(1e-7));
        CHECK(rows.pair(lower, 6, 6) == doctest::Approx(c.pair_11).epsilon(1e-7));
        CHECK(rows.pair(lower, 6, 2) == doctest::Approx(c.pair_quarter).epsilon(1e-7));
    }
}

TEST_CASE(
    "equal rows keep (1 - q)^2 of what is not random in their pairs, and q^2 more where a row is shifted") {
    const Rows rows;
    const double q = 0.1;
    const std::vector<double> share{0.2, 0.3, 0.5};
    for (const bool shifted : {false, true}) {
        CAPTURE(shifted);
        TripleState lower = rows.chain(share, 0.6);
        TripleState upper = lower;
        FreshPairs below(rows.tables);
        FreshPairs above(rows.tables);
        Exchange exchange(rows.tables);
        const std::vector<double> of_both = rows.shares(lower);
        const double before = rows.pair(lower, 6, 6) - 0.25;
        if (shifted) {
            exchange_shifted(rows.tables, rows.sizes, {q, 0.0}, exchange, lower, below, upper, above);
        } else {
            exchange.permuted(ArrivalRates(rows.sizes, {{q, 0.0}, true, of_both.data()}), lower, below);
        }
        below.merge(rows.tables, lower);
        const double kept = (rows.pair(lower, 6, 6) - 0.25) / before;
        CHECK(kept == doctest::Approx(shifted ? 0.82 : 0.81).epsilon(1e-12));
    }
}

TEST_CASE("probabilities of segregation move no mass, and make newcomers of what they move") {
    const Rows rows;
    TripleState row = rows.chain({0.2, 0.3, 0.5}, 0.6);
    const std::vector<double> above{0.0, 0.0, 0.6, 0.0, 0.4, 0.0, 0.0};
    FreshPairs fresh(rows.tables);
    Exchange exchange(rows.tables);
    const ArrivalRates rates(rows.sizes, {{0.05, 0.2}, true, above.data()});
    exchange.permuted(rates, row, fresh);
    double old = 0.0;
    double centre = 0.0;
    double left = 0.0;
    for (const double mass : row.settled()) old += mass;
    for (const double mass : fresh.settled[0]) centre += mass;
    for (const double mass : fresh.settled[1]) left += mass;
    CHECK(old + centre + 2.0 * left == doctest::Approx(1.0).epsilon(1e-14));
    // of a grain of size 1 leaves 0.05 (all), and Q - Q^2 / 2 of 0.2 (1 - s) for each size s above
    const double leaves = 0.05 + 0.6 * (0.15 - 0.5 * 0.15 * 0.15) + 0.4 * (0.1 - 0.5 * 0.1 * 0.1);
    CHECK(rates.stays()[6] == doctest::Approx(1.0 - leaves).epsilon(1e-14));
}
