// SPDX-License-Identifier: BSD-3-Clause
// The vector loops over interleaved pairs of lines against plain ones.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "simd/pairs.hpp"

using namespace comminute;
using namespace comminute::detail;

namespace {

std::size_t at(Index k) {
    return static_cast<std::size_t>(k);
}

std::vector<double> numbers(Index count, double phase) {
    std::vector<double> found(at(count));
    for (Index k = 0; k < count; ++k) found[at(k)] = std::sin(2.3 * static_cast<double>(k) + phase);
    return found;
}

}  // namespace

TEST_CASE("complex numbers are multiplied one by one") {
    for (Index count = 0; count <= 2 * lanes + 1; ++count) {
        const std::vector<double> before = numbers(2 * count, 0.3);
        const std::vector<double> by = numbers(2 * count, 1.1);
        std::vector<double> z = before;
        multiply(z.data(), by.data(), count);
        for (Index q = 0; q < count; ++q) {
            const std::complex<double> wanted =
                std::complex<double>(before[at(2 * q)], before[at(2 * q + 1)]) *
                std::complex<double>(by[at(2 * q)], by[at(2 * q + 1)]);
            CHECK(std::abs(z[at(2 * q)] - wanted.real()) <= 4e-16);
            CHECK(std::abs(z[at(2 * q + 1)] - wanted.imag()) <= 4e-16);
        }
    }
}

TEST_CASE("a pair keeps what is positive, and what is no number") {
    for (Index coarsest = 0; coarsest <= 2 * lanes + 1; ++coarsest) {
        CAPTURE(coarsest);
        const std::vector<double> before = numbers(2 * (coarsest + 1), 0.7);
        std::vector<double> pair = before;
        const std::array<double, 2> left = keep_positive(pair.data(), coarsest, {2.0, 0.5});
        double wanted[2] = {0.0, 0.0};
        for (std::size_t k = 2; k < pair.size(); ++k) {
            CHECK(pair[k] == std::max(before[k] * (k % 2 == 0 ? 2.0 : 0.5), 0.0));
            wanted[k % 2] += pair[k];
        }
        CHECK(pair[0] == before[0]);
        CHECK(pair[1] == before[1]);
        CHECK(left[0] == doctest::Approx(wanted[0]).epsilon(1e-14));
        CHECK(left[1] == doctest::Approx(wanted[1]).epsilon(1e-14));
        for (std::size_t k = 2; k < pair.size(); ++k) {
            std::vector<double> bad = before;
            bad[k] = std::nan("");
            CHECK(std::isnan(keep_positive(bad.data(), coarsest, {2.0, 0.5})[k % 2]));
            CHECK(std::isnan(bad[k]));
        }
    }
}

TEST_CASE("either line of a pair is added, and the array's end is not passed") {
    for (Index bins = 0; bins <= 2 * lanes + 1; ++bins) {
        const std::vector<double> pair = numbers(2 * bins, 0.9);
        for (Index b = 0; b < std::min<Index>(2, 2 * bins); ++b) {
            const std::vector<double> old = numbers(bins, 0.1);
            std::vector<double> to = old;
            add_line(pair.data() + b, to.data(), bins);
            for (Index i = 0; i < bins; ++i) CHECK(to[at(i)] == old[at(i)] + pair[at(2 * i + b)]);
        }
    }
}

TEST_CASE("columns go into pairs and back") {
    const Index rows = 7;
    const Index stride = lanes + 3;
    const Index distance = 2 * rows + 5;
    const std::vector<double> columns = numbers(rows * stride, 0.2);
    std::vector<double> pairs(at(lanes / 2 * distance), 0.0);
    std::vector<double> pushed(at(lanes), 1.0);
    gather_columns(columns.data(), stride, rows, pairs.data(), distance, pushed.data());
    for (Index c = 0; c < lanes; ++c) {
        double total = 1.0;
        for (Index i = 0; i < rows; ++i) {
            CHECK(pairs[at(c / 2 * distance + 2 * i + c % 2)] == columns[at(i * stride + c)]);
            total += columns[at(i * stride + c)];
        }
        CHECK(pushed[at(c)] == doctest::Approx(total).epsilon(1e-14));
    }
    for (const Index width : {lanes + 2, lanes, lanes - 3}) {
        const std::vector<double> old = numbers(rows * (width + 1), 0.4);
        std::vector<double> state = old;
        add_columns(pairs.data(), distance, rows, {state.data(), rows, width + 1}, 1);
        for (Index i = 0; i < rows; ++i) {
            for (Index c = 0; c <= width; ++c) {
                const bool there = c >= 1 && c <= lanes;
                const double added = there ? columns[at(i * stride + c - 1)] : 0.0;
                CHECK(state[at(i * (width + 1) + c)] == old[at(i * (width + 1) + c)] + added);
            }
        }
    }
}
