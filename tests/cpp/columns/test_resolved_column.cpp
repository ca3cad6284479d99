// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <numeric>
#include <vector>

#include "comminute/error.hpp"
#include "comminute/resolved_column.hpp"
#include "support/helpers.hpp"

using namespace comminute;
using helpers::at;

namespace {

const ResolvedGrid small({-6.0, -4.0, -1.5, -0.7, 0.0}, {-4.0, -1.5, -0.7, 0.0, 0.0});
const std::vector<double> start{0.0, 0.0, 0.3, 0.0, 0.7,  //
                                0.0, 0.2, 0.2, 0.0, 0.6,  //
                                0.0, 0.5, 0.0, 0.0, 0.5};
const std::vector<double> loads{8.0, 4.0, 2.0};
const std::vector<double> shear{1.0, 2.0, 1.0};

ResolvedColumn column(Index threads) {
    ResolvedColumnOptions options;
    options.threads = threads;
    return ResolvedColumn(small, Material{}, {start.data(), 3, 5}, 3.0, options);
}

ColumnDrive drive() {
    ColumnDrive found;
    found.shear_rate = shear;
    found.mixing = 0.03;
    found.segregation = 0.02;
    return found;
}

}  // namespace

TEST_CASE("a column goes on from its record to the same bits, on any number of threads") {
    ResolvedColumn one = column(1);
    CHECK(one.load_to(loads));
    one.advance(1.0, drive());
    ResolvedColumn again(small, Material{}, one.record(), 3.0);
    ResolvedColumn other = column(3);
    other.load_to(loads);
    other.advance(1.0, drive());
    CHECK(other.record() == one.record());
    one.advance(1.0, drive());
    again.advance(1.0, drive());
    CHECK(again.record() == one.record());
    for (Index z = 0; z < 3; ++z) {
        const std::vector<double> pmf = one.pmf(z);
        CHECK(std::accumulate(pmf.begin(), pmf.end(), 0.0) == doctest::Approx(1.0).epsilon(1e-14));
        CHECK(one.crushes(z) > 0.0);
    }
}

TEST_CASE("a host that says stop finds the column between two exchanges") {
    ResolvedColumn stopped = column(2);
    stopped.load_to(loads);
    int asked = 0;
    const ResolvedColumnReport report = stopped.advance(100.0, drive(), {}, [&] { return ++asked < 4; });
    CHECK(report.exchanges == 3);
    CHECK(stopped.sweeps() == 6);
}

TEST_CASE("what does not fit is refused") {
    ResolvedColumn fresh = column(1);
    CHECK_THROWS_AS(fresh.advance(1.0, drive()), ParameterError);  // no load
    fresh.load_to(loads);
    CHECK_THROWS_AS(fresh.advance(1.0, drive(), {ColumnEnd::periodic, ColumnEnd::periodic, {}, 0.0}),
                    ParameterError);  // an odd number of rows
    CHECK_THROWS_AS(fresh.advance(1.0, drive(), {ColumnEnd::closed, ColumnEnd::feed, {1.0}, 0.0}),
                    ShapeError);
    CHECK_THROWS_AS(fresh.advance(-1.0, drive()), ParameterError);
    CHECK_THROWS_AS(fresh.pmf(3), ParameterError);
    ResolvedColumnRecord broken = fresh.record();
    broken.rows.back().start.pop_back();
    CHECK_THROWS_AS(ResolvedColumn(small, Material{}, broken, 3.0), ShapeError);
    CHECK_THROWS_AS(fresh.load_to(std::vector<double>{1.0}), ShapeError);
    ResolvedColumnOptions locked;
    locked.partners = Partners::locked;
    CHECK_THROWS_AS(ResolvedColumn(small, Material{}, {start.data(), 3, 5}, 3.0, locked), ParameterError);
}
