// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "comminute/error.hpp"
#include "comminute/material_sweep.hpp"

using namespace comminute;

namespace {

std::vector<Material> materials() {
    std::vector<Material> all(6);
    for (std::size_t k = 0; k < all.size(); ++k) {
        all[k].fabric_width = 0.05 + 0.1 * static_cast<double>(k);
        all[k].weibull_modulus = k % 2 == 0 ? 3.0 : 5.0;
    }
    all[2].fragments = PowerLawFragments{2.0};
    all[3].fragments = PowerLawFragments{2.0};
    return all;
}

const std::vector<double> loads{1.0, 20.0, 5.0, 300.0};

}  // namespace

TEST_CASE("a solver that takes another material is a new one") {
    const LogGrid grid(-7.0, 0.0, 120);
    for (const double rate : {0.0, 0.3}) {
        QuasiStaticOptions options;
        options.loading_rate = rate;
        for (const auto& start :
             {mixed_fabric(gap_graded(1.0, 0.1), grid), mixed_fabric(power_law(2.4, 0.01, 1.0), grid)}) {
            QuasiStatic kept(grid, Material{}, options);
            for (const Material& material : materials()) {
                kept.set_material(material);
                CHECK(kept.material() == material);
                QuasiStatic fresh(grid, material, options);
                for (const double load : loads) {
                    CHECK(kept.solve(start, load) == fresh.solve(start, load));
                    CHECK(kept.marginal(start, load).grainsize == fresh.marginal(start, load).grainsize);
                }
            }
        }
    }
    QuasiStatic kept(grid, Material{});
    Material bad;
    bad.fabric_width = -1.0;
    CHECK_THROWS_AS(kept.set_material(bad), ParameterError);
    CHECK(kept.material() == Material{});
}

TEST_CASE("a sweep gives the numbers of each material, whatever came before it") {
    const LogGrid grid(-7.0, 0.0, 120);
    const auto start = mixed_fabric(power_law(2.4, 0.01, 1.0), grid);
    const GradingReader reader(start, std::nullopt, {{50.0, 80.0}, {0.1, 0.5}, 0.05});
    MaterialSweep sweep(start, reader);
    CHECK(sweep.columns() == 9);
    std::vector<double> rows(4 * 9);
    for (const Material& material : materials()) {
        sweep.run(material, loads, {rows.data(), 4, 9});
        QuasiStatic solver(grid, material);
        double largest = 0.0;
        for (std::size_t t = 0; t < loads.size(); ++t) {
            largest = std::max(largest, loads[t]);
            const Marginal grading = solver.marginal(start, largest);
            std::vector<double> expected{grading.report.crushed, grading.mass_error()};
            for (const double number : reader.read(grading)) expected.push_back(number);
            CHECK(std::vector<double>(rows.begin() + static_cast<Index>(9 * t),
                                      rows.begin() + static_cast<Index>(9 * t + 9)) == expected);
        }
    }
    const std::vector<double> bad_loads{1.0, -1.0};
    CHECK_THROWS_AS(sweep.run(Material{}, bad_loads, {rows.data(), 2, 9}), ParameterError);
    CHECK_THROWS_AS(sweep.run(Material{}, loads, {rows.data(), 3, 9}), ShapeError);
    CHECK_THROWS_AS(sweep.run(Material{}, loads, {rows.data(), 4, 8}), ShapeError);
}

TEST_CASE("what is read off a grading") {
    const LogGrid grid(-7.0, 0.0, 70);
    const auto start = mixed_fabric(monodisperse(1.0), grid);
    QuasiStatic solver(grid, Material{});
    const Marginal grading = solver.marginal(start, 8.0);
    const GradingReader reader(start, std::nullopt, {{0.0, 50.0, 100.0}, {1e-9, 0.3, 1.0, 7.0}, 0.0});
    const std::vector<double> numbers = reader.read(grading);
    CHECK(numbers[0] == grading.grainsize[0]);
    CHECK(std::isnan(numbers[2]));  // no unit, no silt
    CHECK(std::isnan(numbers[3]));  // D0 lies in the fines bin
    CHECK(numbers[5] == 1.0);
    CHECK(numbers[6] < 1e-6);
    CHECK(numbers[8] == 1.0);
    CHECK(numbers[9] == 1.0);
    CHECK_THROWS_AS(GradingReader(start, std::nullopt, {{101.0}, {}, 0.0}), ParameterError);
    CHECK_THROWS_AS(GradingReader(start, std::nullopt, {{}, {0.0}, 0.0}), ParameterError);
    CHECK_THROWS_AS(GradingReader(start, std::nullopt, {{}, {}, -1.0}), ParameterError);
    Marginal short_one = grading;
    short_one.grainsize.pop_back();
    CHECK_THROWS_AS(reader.read(short_one), ShapeError);
}

TEST_CASE("numbers of a curve given by points") {
    // F = .2 at .1, .6 at 1 (in a jump from .4) and 1 at 10, with a tail of slope 2 below .1
    const CurvePoints curve{{0.1, 1.0, 1.0, 10.0}, {0.2, 0.4, 0.6, 1.0}, 2.0};
    CHECK(curve.finer(0.05) == doctest::Approx(0.05));
    CHECK(curve.finer(0.1) == 0.2);
    CHECK(curve.finer(std::sqrt(0.1)) == doctest::Approx(0.3));
    CHECK(curve.finer(1.0) == 0.6);
    CHECK(curve.finer(100.0) == 1.0);
    const double ten = std::log(10.0);
    // tail: ln .1 less 1/2; then the middles of two decades, and the jump at ln 1 = 0
    CHECK(curve.mean_log() == doctest::Approx(0.2 * (-ten - 0.5) + 0.2 * (-0.5 * ten) + 0.4 * 0.5 * ten));
    CHECK(curve.breakage_potential(1.0) == doctest::Approx(0.4 * 0.5));
    // of the tail, F = .2 (d/.1)^2 with d from .01 to .1: the mean of log10(d / .01) less what lies below .01
    CHECK(curve.breakage_potential(0.01) ==
          doctest::Approx(0.4 * 2.5 + 0.2 * 2.0 + 0.2 * 1.5 + 0.2 * (1.0 - (1.0 - 0.01) / (2.0 * ten))));
    CHECK(std::isnan(CurvePoints{{0.1, 1.0}, {0.2, 1.0}, 0.0}.mean_log()));
    CHECK(CurvePoints{{0.1, 1.0}, {0.0, 1.0}, 0.0}.mean_log() == doctest::Approx(-0.5 * ten));
    CHECK(CurvePoints{{0.1, 1.0}, {0.2, 1.0}, 0.0}.finer(0.05) == 0.0);
}

TEST_CASE("a curve bends at the sieves of its start as far as there are grains of it") {
    const LogGrid grid(-6.5 * std::log(2.0), 0.5 * std::log(2.0), 8);  // a bin for each halving of 2
    const CurvePoints measured{{0.5, 0.7, 1.0}, {0.0, 0.9, 1.0}, 0.0};
    const std::vector<double> start{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0};
    const std::vector<double> after{0.0, 0.0, 0.0, 0.0, 0.1, 0.2, 0.5, 0.2};
    const CurvePoints plain{{0.25, 0.5, 1.0, 2.0}, {0.1, 0.3, 0.8, 1.0}, 0.0};
    const CurvePoints bent = with_sieves(plain, grid, after, start, measured);
    CHECK(bent.finer(0.7) ==
          doctest::Approx(0.3 + 0.5 * 0.9));  // all grains between .5 and 1 are of the start
    CHECK(with_sieves(plain, grid, start, start, measured).size == measured.size);
    const std::vector<double> half{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.5};
    const double even = std::log(0.7 / 0.5) / std::log(2.0);
    CHECK(with_sieves(plain, grid, after, half, {{0.5, 0.7, 1.0, 2.0}, {0.0, 0.45, 0.5, 1.0}, 0.0})
              .finer(0.7) == doctest::Approx(0.3 + 0.5 * 0.9));
    const std::vector<double> little{0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25, 0.75};
    CHECK(with_sieves(plain, grid, after, little, {{0.5, 0.7, 1.0, 2.0}, {0.0, 0.225, 0.25, 1.0}, 0.0})
              .finer(0.7) == doctest::Approx(0.3 + 0.25 * 0.9 + 0.25 * even));
}
