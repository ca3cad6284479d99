// SPDX-License-Identifier: BSD-3-Clause
// The vector loops against the plain loops that their comments state, on arrays that end where the loops must.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "simd/arms.hpp"
#include "simd/loops.hpp"
#include "simd/sums.hpp"

using namespace comminute;
using namespace comminute::detail;

namespace {

using Numbers = std::vector<double>;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

std::size_t at(Index k) {
    return static_cast<std::size_t>(k);
}

// Numbers without a pattern, in (-1, 1).
Numbers numbers(Index count, int seed) {
    Numbers found(at(count));
    for (Index k = 0; k < count; ++k) {
        found[at(k)] = std::sin(1.7 * static_cast<double>(k + 1) + 11.3 * static_cast<double>(seed));
    }
    return found;
}

void check_equal(const Numbers& found, const Numbers& wanted) {
    REQUIRE(found.size() == wanted.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
        CAPTURE(k);
        CHECK(found[k] == doctest::Approx(wanted[k]).epsilon(1e-15).scale(8.0));
    }
}

}  // namespace

TEST_CASE("loops over arrays of any length are what they say") {
    for (Index count = 0; count <= 3 * lanes + 1; ++count) {
        CAPTURE(count);
        const Numbers a = numbers(count, 1);
        const Numbers b = numbers(count, 2);
        const Numbers old = numbers(count, 3);
        Numbers scaled = old;
        add_scaled(0.7, a.data(), scaled.data(), count);
        const Index stride = count + 2;
        const Numbers rows = numbers(3 * stride, 4);
        const Numbers others = numbers(3 * stride, 5);
        const Numbers factors = numbers(3, 6);
        Numbers by_terms = old;
        add_terms(factors.data(), {rows.data(), stride}, 3, by_terms.data(), count);
        Numbers products = old;
        add_products({rows.data(), stride}, {others.data(), stride}, 3, products.data(), count);
        Numbers row = old;
        Numbers fines = b;
        settle_row({a.data(), b.data(), 0.3, 0.2}, row.data(), fines.data(), count);
        Numbers rest(at(count));
        leave({a.data(), b.data(), old.data(), scaled.data()}, rest.data(), count);
        Numbers in_place = a;
        leave({in_place.data(), b.data(), old.data(), scaled.data()}, in_place.data(), count);
        CHECK(in_place == rest);

        double total = 0.0;
        Numbers want_scaled, want_by_terms, want_products, want_row, want_fines, want_rest;
        for (std::size_t k = 0; k < a.size(); ++k) {
            total += a[k];
            want_scaled.push_back(old[k] + 0.7 * a[k]);
            want_by_terms.push_back(old[k]);
            want_products.push_back(old[k]);
            for (std::size_t t = 0; t < 3; ++t) {
                const std::size_t place = t * at(stride) + k;
                want_by_terms.back() += factors[t] * rows[place];
                want_products.back() += rows[place] * others[place];
            }
            want_row.push_back(old[k] + b[k] + 0.3 * a[k]);
            want_fines.push_back(b[k] + 0.2 * a[k]);
            want_rest.push_back(a[k] * (1.0 - old[k]) + b[k] * (1.0 - scaled[k]));
        }
        check_equal(scaled, want_scaled);
        check_equal(by_terms, want_by_terms);
        check_equal(products, want_products);
        check_equal(row, want_row);
        check_equal(fines, want_fines);
        check_equal(rest, want_rest);
        CHECK(sum(a.data(), count) == doctest::Approx(total).epsilon(1e-15).scale(8.0));
    }
}

TEST_CASE("a number that is not finite is seen wherever it stands") {
    for (Index count = 1; count <= 2 * lanes + 1; ++count) {
        for (Index place = 0; place < count; ++place) {
            Numbers values = numbers(count, 4);
            CHECK(all_finite(values.data(), count));
            for (const double bad : {not_a_number, infinity, -infinity}) {
                values[at(place)] = bad;
                CHECK_FALSE(all_finite(values.data(), count));
            }
        }
    }
}

TEST_CASE("a square of a pack each way is transposed") {
    const Numbers from = numbers(lanes * 11, 5);
    Numbers to(at(lanes * 9), 0.0);
    transpose(from.data(), 11, to.data(), 9);
    for (Index r = 0; r < lanes; ++r) {
        for (Index c = 0; c < lanes; ++c) CHECK(to[at(9 * c + r)] == from[at(11 * r + c)]);
    }
}

TEST_CASE("running sums take in, give and decay as their terms do one by one") {
    for (const Index terms : {1, 3, 14}) {
        for (Index count = 0; count <= 6 * lanes; count += lanes) {
            const Numbers entering = numbers(terms, 1);
            const Numbers falling = numbers(terms, 2);
            const Numbers enters = numbers(count, 3);
            const Numbers old = numbers(count * terms, 4);
            Numbers sums = old;
            Numbers arriving(at(count));
            advance({terms, entering.data(), falling.data(), sums.data()}, enters.data(), arriving.data(),
                    count);
            Numbers want_sums = old;
            Numbers want_arriving(at(count), 0.0);
            for (Index k = 0; k < count; ++k) {
                for (Index a = 0; a < terms; ++a) {
                    double& line = want_sums[at((k / lanes * terms + a) * lanes + k % lanes)];
                    line += entering[at(a)] * enters[at(k)];
                    want_arriving[at(k)] += falling[at(a)] * line;
                }
            }
            check_equal(sums, want_sums);
            check_equal(arriving, want_arriving);

            if (count > 0) sums[0] = 1e-300;
            Numbers decayed = sums;
            decay(falling.data(), terms, decayed.data(), count);
            for (Index k = 0; k < count * terms; ++k) {
                const double exact = sums[at(k)] * falling[at(k / lanes % terms)];
                CHECK(decayed[at(k)] == (std::abs(exact) < 1e-290 ? 0.0 : exact));
            }

            Numbers rows = numbers(rows_at_once * (count + 3), 6);
            Numbers want_rows = rows;
            const Numbers factors = numbers(rows_at_once * terms, 7);
            add_to_rows({old.data(), terms * lanes, lanes}, factors.data(), terms, rows.data(), count + 3,
                        count);
            for (Index r = 0; r < rows_at_once; ++r) {
                for (Index k = 0; k < count; ++k) {
                    for (Index a = 0; a < terms; ++a) {
                        want_rows[at(r * (count + 3) + k)] +=
                            factors[at(a * rows_at_once + r)] *
                            old[at((k / lanes * terms + a) * lanes + k % lanes)];
                    }
                }
            }
            check_equal(rows, want_rows);
        }
    }
}

TEST_CASE("two arms crush as their cells one by one") {
    constexpr Index terms = 5;
    for (Index count = 0; count <= 7 * lanes; count += lanes) {
        CAPTURE(count);
        const Index stride = count + 5;
        const Numbers entering = numbers(terms, 1);
        const Numbers falling = numbers(terms, 2);
        const Numbers power = numbers(terms * stride, 3);
        const Numbers of_diagonal = numbers(count, 4);
        Numbers settled = numbers(count, 5);
        Numbers arrived = numbers(count, 6);
        const Shell shell{terms, entering.data(),    falling.data(), power.data(),   stride,
                          0.4,   of_diagonal.data(), settled.data(), arrived.data(), 0.1};
        // The first arm has arrivals besides and tells what lands; the second has neither, and a cell that rests and
        // holds what is no number.
        Numbers there[2] = {numbers(count, 7), numbers(count, 8)};
        if (count > 0) {
            settled[3] = arrived[3] = 0.0;
            there[1][3] = not_a_number;
        }
        const Numbers besides = numbers(count, 9);
        const Numbers crossing[2] = {numbers(terms, 10), numbers(terms, 11)};
        Numbers line[2] = {numbers(count, 12), numbers(count, 13)};
        Numbers sums[2] = {numbers(count * terms, 14), numbers(count * terms, 15)};
        Numbers fines[2] = {numbers(count, 16), numbers(count, 17)};
        Numbers landed(at(count));
        const Numbers entered[2] = {line[0], line[1]};
        Numbers want_sums[2] = {sums[0], sums[1]};
        Numbers want_fines[2] = {fines[0], fines[1]};
        const auto arm = [&](std::size_t k) {
            return Arm{
                there[k].data(),    k == 0 ? besides.data() : nullptr, line[k].data(), sums[k].data(),
                crossing[k].data(), k == 0 ? landed.data() : nullptr,  line[k].data(), fines[k].data()};
        };
        const Moved moved = crush_arms(shell, arm(0), arm(1), count);
        for (std::size_t k = 0; k < 2; ++k) {
            double total = 0.0;
            Numbers want_line;
            Numbers want_landed;
            for (Index l = 0; l < count; ++l) {
                double lands = 0.4 * of_diagonal[at(l)] + (k == 0 ? besides[at(l)] : 0.0);
                for (Index a = 0; a < terms; ++a) {
                    double& own = want_sums[k][at((l / lanes * terms + a) * lanes + l % lanes)];
                    own += entering[at(a)] * entered[k][at(l)];
                    lands += falling[at(a)] * own + crossing[k][at(a)] * power[at(a * stride + l)];
                }
                const bool rests = settled[at(l)] == 0.0 && arrived[at(l)] == 0.0;
                const double moving = rests ? 0.0 : settled[at(l)] * there[k][at(l)] + arrived[at(l)] * lands;
                want_line.push_back(moving);
                want_landed.push_back(lands);
                want_fines[k][at(l)] += 0.1 * moving;
                total += moving;
            }
            check_equal(line[k], want_line);
            check_equal(sums[k], want_sums[k]);
            check_equal(fines[k], want_fines[k]);
            if (k == 0) check_equal(landed, want_landed);
            CHECK((k == 0 ? moved.first : moved.second) == doctest::Approx(total).epsilon(1e-15).scale(16.0));
        }
    }
}
