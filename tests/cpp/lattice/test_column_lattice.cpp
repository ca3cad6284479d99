// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "comminute/column_lattice.hpp"
#include "comminute/error.hpp"

using namespace comminute;

namespace {

const std::vector<double> loads{20.0, 8.0, 4.0, 2.0, 1.0};
const std::vector<double> shear(5, 1.0);

ColumnLattice column(Index threads, Partners partners = Partners::permuted,
                     CrushOrder order = CrushOrder::random) {
    ColumnOptions options;
    options.seed = 5;
    options.threads = threads;
    options.partners = partners;
    options.order = order;
    Material material;
    material.fabric_width = 0.2;
    return ColumnLattice(std::vector<Grading>(5, gap_graded(1.0, 0.3)), 700, material, 0.05, options);
}

ColumnDrive drive() {
    ColumnDrive found;
    found.shear_rate = shear;
    found.mixing = 1e-5;
    found.segregation = 1e-3;
    return found;
}

}  // namespace

TEST_CASE("threads change no bit of a column, nor does a copy") {
    for (const Partners partners : {Partners::permuted, Partners::shift, Partners::locked}) {
        for (const CrushOrder order : {CrushOrder::random, CrushOrder::weakest}) {
            ColumnLattice one = column(1, partners, order);
            ColumnLattice many = column(4, partners, order);
            for (ColumnLattice* each : {&one, &many}) {
                each->load_to(loads);
                each->advance(3.0, drive());
            }
            CHECK(one == many);
            ColumnLattice copy(one.state(), one.loads(), one.sweeps(), one.material(), one.height(),
                               one.options());
            CHECK(copy == one);
            copy.advance(1.0, drive());
            many.advance(1.0, drive());
            CHECK(copy == many);
            CHECK(copy != one);
        }
    }
}

TEST_CASE("rows that exchange nothing are replicas of a lattice") {
    ColumnLattice rows = column(2);
    LatticeOptions options;
    options.seed = 5;
    options.replicas = 5;
    Lattice lattice(700, rows.material(), gap_graded(1.0, 0.3), options);
    rows.load_to(std::vector<double>(5, 8.0));
    lattice.load_to(8.0);
    const ColumnReport report = rows.advance(1.0, [] {
        ColumnDrive still;
        still.shear_rate = shear;
        return still;
    }());
    CHECK(report.crushes == 0);
    CHECK(report.swaps == 0);
    for (Index z = 0; z < 5; ++z) {
        CHECK(rows.state()[static_cast<std::size_t>(z)].ring.cells ==
              lattice.rings()[static_cast<std::size_t>(z)].cells);
        CHECK(rows.mean_crushes(z) == lattice.mean_crushes()[static_cast<std::size_t>(z)]);
    }
}

TEST_CASE("an exchange moves grains with what they have been through") {
    ColumnLattice rows = column(1);
    rows.load_to(loads);
    double before = 0.0;
    double after = 0.0;
    for (Index z = 0; z < 5; ++z) before += rows.mean_crushes(z);
    const ColumnReport report = rows.advance(2.0, drive());
    CHECK(report.exchanges >= 1);
    CHECK(report.swaps > 0);
    CHECK(report.largest_probability <= 0.1 / 1.1 + 0.25 / 1.125 + 1e-12);
    for (Index z = 0; z < 5; ++z) after += rows.mean_crushes(z);
    CHECK((after - before) * 700 == doctest::Approx(static_cast<double>(report.crushes)));
}

TEST_CASE("no row stands under a load that crushes one of its cells") {
    ColumnLattice rows = column(1);
    rows.load_to(loads);
    rows.advance(2.0, drive());
    ColumnLattice again = rows;
    again.load_to(loads);  // which looks at every cell
    for (Index z = 0; z < 5; ++z) CHECK(again.mean_crushes(z) == rows.mean_crushes(z));
}

TEST_CASE("what a column refuses") {
    ColumnLattice rows = column(1);
    CHECK_THROWS_AS(rows.advance(1.0, drive()), ParameterError);  // never loaded
    CHECK_THROWS_AS(rows.load_to(std::vector<double>(4, 1.0)), ShapeError);
    CHECK_THROWS_AS(rows.load_to(std::vector<double>(5, -1.0)), ParameterError);
    rows.load_to(loads);
    CHECK_THROWS_AS(rows.advance(-1.0, drive()), ParameterError);
    ColumnDrive bad = drive();
    bad.mixing = std::nan("");
    CHECK_THROWS_AS(rows.advance(1.0, bad), ParameterError);
    CHECK_THROWS_AS(rows.crushes(5), ParameterError);
    std::vector<double> psi(3);
    CHECK_THROWS_AS(rows.psi(0, psi), ShapeError);
    const std::vector<double> sizes{1.0, 2.0, -1.0, 1.0};
    CHECK_THROWS_AS(ColumnLattice({sizes.data(), 2, 2}, Material{}, 1.0), ParameterError);
    int asked = 0;
    rows.advance(1e3, drive(), [&] { return ++asked < 3; });
    CHECK(asked == 3);
}
