// SPDX-License-Identifier: BSD-3-Clause
// Response tables against direct solves, finite differences and the percentiles of whole curves.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "support/helpers.hpp"

using comminute::Fabric;
using comminute::Grading;
using comminute::LogGrid;
using comminute::Material;
using comminute::ParameterError;
using comminute::QuasiStatic;
using comminute::Response;
using comminute::ResponseOptions;
using comminute::ResponseStatus;
using comminute::ResponseTable;
using comminute::ShapeError;
using helpers::at;
using helpers::Index;

namespace {

constexpr double most = 1e4;

struct Start {
    const char* name;
    Grading grading;
};

const std::vector<Start>& starts() {
    static const std::vector<Start> all{
        {"equal", comminute::monodisperse(1.0)},
        {"gap-graded", comminute::gap_graded(1.0, 0.1)},
        {"band", comminute::uniform_size(0.5, 1.0)},
        {"power law", comminute::power_law(2.5, 1e-2, 1.0)},
        {"sieves", comminute::sieve_grading({0.1, 0.5, 0.9, 2.0}, {3.0, 20.0, 70.0, 100.0}, {"mm"})},
    };
    return all;
}

struct Case {
    QuasiStatic solver;
    Fabric start;
    ResponseTable table;

    explicit Case(const Grading& grading, const ResponseOptions& options = {}, Index bins = 128)
        : solver(comminute::fitting_grid(grading, {}, most, {{}, bins, {}, {}}), Material{}),
          start(comminute::mixed_fabric(grading, solver.grid())),
          table(solver, start, most, options) {}
};

std::vector<double> cdf_of(const ResponseTable& table, double load) {
    std::vector<double> cdf(at(table.grid().bins()));
    CHECK(table.grading(load, cdf) == ResponseStatus::inside);
    return cdf;
}

}  // namespace

TEST_CASE("between its loads a table is the direct solve to its tolerance") {
    for (const Start& one : starts()) {
        const std::string name = one.name;
        const Grading& grading = one.grading;
        CAPTURE(name);
        Case c(grading);
        std::mt19937_64 random(5);
        std::uniform_real_distribution<double> log_load(std::log(0.05), std::log(most));
        double worst = 0.0;
        for (int k = 0; k < 300; ++k) {
            const double load = std::exp(log_load(random));
            const comminute::Marginal direct = c.solver.marginal(c.start, load);
            const std::vector<double> cdf = cdf_of(c.table, load);
            double finer = 0.0;
            for (std::size_t i = 0; i < cdf.size(); ++i) {
                finer += direct.grainsize[i];
                worst = std::max(worst, std::abs(cdf[i] - finer));
            }
            CHECK(std::abs(c.table.crushes(load).value - direct.report.crushed) < 1e-3);
        }
        CHECK(worst <= c.table.options().tolerance);
        CHECK(c.table.memory() < 4'000'000);
        CHECK(cdf_of(c.table, most).back() == doctest::Approx(1.0).epsilon(1e-14));
    }
}

TEST_CASE("what only rises in the model only rises in the table, on both sides of a jump") {
    for (const Start& one : starts()) {
        const std::string name = one.name;
        const Grading& grading = one.grading;
        CAPTURE(name);
        const Case c(grading, {1e-3, 4000});
        std::vector<double> before(at(c.table.grid().bins()), -1.0);
        double crushes = -1.0;
        for (int k = 0; k <= 4000; ++k) {
            const double load = std::min(std::exp(std::log(0.5) + k * std::log(most / 0.5) / 4000.0), most);
            const std::vector<double> cdf = cdf_of(c.table, load);
            for (std::size_t i = 0; i < cdf.size(); ++i) CHECK(cdf[i] >= before[i] - 1e-15);
            CHECK(c.table.crushes(load).value >= crushes);
            before = cdf;
            crushes = c.table.crushes(load).value;
        }
    }
    const Case equal(comminute::monodisperse(1.0));
    CHECK(equal.table.crushes(1.0 - 1e-8).value == 0.0);
    CHECK(equal.table.crushes(1.0 + 1e-8).value == doctest::Approx(0.5).epsilon(1e-6));
}

TEST_CASE("derivatives are the slopes of the values") {
    for (const Start& one : starts()) {
        const std::string name = one.name;
        const Grading& grading = one.grading;
        CAPTURE(name);
        const Case c(grading);
        const std::vector<double> loads = c.table.stress_ratios();
        const auto slope = [](const auto& of, double load, double step) {
            return (of(load + step).value - of(load - step).value) / (2.0 * step);
        };
        for (std::size_t k = 0; k + 1 < loads.size(); ++k) {
            const double load = std::sqrt(loads[k] * loads[k + 1]);
            const double step = 1e-4 * (loads[k + 1] - loads[k]);
            if (loads[k + 1] < loads[k] * (1.0 + 1e-6)) continue;  // a jump
            const auto crushes = [&](double s) { return c.table.crushes(s); };
            const auto finer = [&](double s) { return c.table.finer(100, s); };
            CHECK(crushes(load).derivative == doctest::Approx(slope(crushes, load, step)).epsilon(1e-5));
            CHECK(finer(load).derivative == doctest::Approx(slope(finer, load, step)).epsilon(1e-4));
            const auto size = [&](double s) { return c.table.percentile(30.0, s); };
            const Response below = size(load - step);
            const Response above = size(load + step);
            const Index bin = c.table.grid().bin_of(std::log(size(load).value));
            const bool one_bin = c.table.grid().bin_of(std::log(below.value)) == bin &&
                                 c.table.grid().bin_of(std::log(above.value)) == bin;
            if (size(load).status != ResponseStatus::inside || !one_bin) continue;
            CHECK(size(load).derivative == doctest::Approx(slope(size, load, step)).epsilon(1e-3));
        }
        CHECK(c.table.crushes(0.01).derivative == 0.0);
        CHECK(c.table.percentile(90.0, 0.01).derivative == 0.0);
    }
}

TEST_CASE("percentiles are those of the interpolated curve") {
    for (const Start& one : starts()) {
        const std::string name = one.name;
        const Grading& grading = one.grading;
        CAPTURE(name);
        const Case c(grading);
        for (const double load : {0.0, 0.3, 1.0, 1.7, 12.0, 900.0, most}) {
            std::vector<double> cdf = cdf_of(c.table, load);
            for (std::size_t i = 1; i < cdf.size(); ++i) cdf[i] = std::max(cdf[i], cdf[i - 1]);
            const auto points = c.table.points(load);
            for (const double percent : {0.01, 1.0, 10.0, 35.0, 50.0, 50.1, 90.0, 99.9, 100.0}) {
                CAPTURE(load);
                CAPTURE(percent);
                const Response found = c.table.percentile(percent, load);
                if (cdf[0] >= percent / 100.0) {
                    CHECK(found.status == ResponseStatus::in_fines);
                    continue;
                }
                const double expected =
                    comminute::percentile(c.table.grid(), cdf, percent, false, points, c.table.largest());
                CHECK(found.value == doctest::Approx(expected).epsilon(1e-9));
            }
        }
    }
}

TEST_CASE("loads that a table does not know have a status and no value") {
    const Case c(comminute::uniform_size(0.5, 1.0));
    const double none = std::nan("");
    for (const double bad : {-1.0, none}) {
        CHECK(c.table.crushes(bad).status == ResponseStatus::bad_load);
        CHECK(std::isnan(c.table.crushes(bad).value));
        CHECK(c.table.percentile(50.0, bad).status == ResponseStatus::bad_load);
    }
    CHECK(c.table.crushes(most * (1.0 + 1e-12)).status == ResponseStatus::above);
    CHECK(std::isnan(c.table.finer(3, 2.0 * most).value));
    CHECK(c.table.finer(c.table.grid().bins(), 1.0).status == ResponseStatus::no_scalar);
    CHECK(c.table.scalar(0, 1.0).status == ResponseStatus::no_scalar);
    CHECK(c.table.percentile(101.0, 1.0).status == ResponseStatus::no_scalar);
    CHECK(c.table.points(2.0 * most).empty());
    std::vector<double> cdf(at(c.table.grid().bins()), 7.0);
    CHECK(c.table.grading(none, cdf) == ResponseStatus::bad_load);
    CHECK(cdf.front() == 7.0);
    std::vector<double> few(3);
    CHECK_THROWS_AS(c.table.grading(1.0, few), ShapeError);
}

TEST_CASE("scalars are numbers over the loads, and are stored with them") {
    const Case c(comminute::gap_graded(1.0, 0.1));
    std::vector<double> squares;
    for (const double load : c.table.stress_ratios()) squares.push_back(std::log(load) * std::log(load));
    const ResponseTable table = c.table.with_scalar("square", squares);
    CHECK(table.scalars() == std::vector<std::string>{"square"});
    CHECK(table.index_of("square") == 0);
    CHECK(c.table.index_of("square") == -1);
    CHECK(table != c.table);
    const double load = 37.0;
    CHECK(table.scalar(0, load).value == doctest::Approx(std::log(load) * std::log(load)).epsilon(2e-2));
    CHECK_THROWS_AS(table.with_scalar("square", squares), ParameterError);
    CHECK_THROWS_AS(table.with_scalar("", squares), ParameterError);
    CHECK_THROWS_AS(table.with_scalar("short", {1.0}), ShapeError);
    squares[2] = std::nan("");
    CHECK_THROWS_AS(table.with_scalar("bad", squares), ParameterError);

    const std::vector<unsigned char> bytes = table.to_bytes();
    const ResponseTable again = ResponseTable::from_bytes(bytes);
    CHECK(again == table);
    for (const double s : {0.3, 1.0, 5.0, 99.0})
        CHECK(again.percentile(60.0, s).value == table.percentile(60.0, s).value);
}

TEST_CASE("bytes that are no table are refused, whatever is wrong with them") {
    const Case c(comminute::monodisperse(1.0), {1e-2, 4000}, 32);
    const std::vector<unsigned char> bytes = c.table.to_bytes();
    std::mt19937_64 random(3);
    for (int k = 0; k < 300; ++k) {
        std::vector<unsigned char> damaged = bytes;
        damaged[random() % damaged.size()] ^= static_cast<unsigned char>(1U << random() % 8U);
        CHECK_THROWS_AS(ResponseTable::from_bytes(damaged), ParameterError);
        damaged = bytes;
        damaged.resize(random() % bytes.size());
        CHECK_THROWS_AS(ResponseTable::from_bytes(damaged), ParameterError);
    }
    CHECK(ResponseTable::from_bytes(bytes) == c.table);
}

TEST_CASE("a table that cannot be made is refused") {
    const Grading grading = comminute::uniform_size(0.5, 1.0);
    const LogGrid grid = comminute::fitting_grid(grading, {}, 100.0, {{}, Index{64}, {}, {}});
    QuasiStatic solver(grid, Material{});
    const Fabric start = comminute::mixed_fabric(grading, grid);
    CHECK_THROWS_AS(ResponseTable(solver, start, 0.0), ParameterError);
    CHECK_THROWS_AS(ResponseTable(solver, start, std::nan("")), ParameterError);
    CHECK_THROWS_AS(ResponseTable(solver, start, 10.0, {0.0, 4000}), ParameterError);
    CHECK_THROWS_AS(ResponseTable(solver, start, 10.0, {1e-4, 7}), ParameterError);
    CHECK_THROWS_AS(ResponseTable(solver, start, 10.0, {1e-6, 20}), ParameterError);
    CHECK_THROWS_AS(ResponseTable(solver, solver.solve(start, 5.0), 10.0), ParameterError);
    const ResponseTable quiet(solver, start, 0.01);  // below any crush
    CHECK(quiet.crushes(0.01).value == 0.0);
}

TEST_CASE("threads share a table without a lock") {
    const Case c(comminute::power_law(2.5, 1e-2, 1.0), {1e-3, 4000}, 64);
    std::vector<double> sums(8, 0.0);
    std::vector<std::thread> threads;
    for (double& sum : sums) {
        threads.emplace_back([&sum, table = c.table] {
            for (int k = 0; k < 2000; ++k) sum += table.percentile(50.0, 0.5 + 0.01 * k).value;
        });
    }
    for (std::thread& thread : threads) thread.join();
    CHECK(std::all_of(sums.begin(), sums.end(), [&](double sum) { return sum == sums.front(); }));
}
