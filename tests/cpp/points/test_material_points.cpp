// SPDX-License-Identifier: BSD-3-Clause
// Material points against single solves, and what a host may do with them.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "comminute/material_points.hpp"
#include "support/allocations.hpp"
#include "support/helpers.hpp"

using comminute::Fabric;
using comminute::LogGrid;
using comminute::Material;
using comminute::MaterialPoints;
using comminute::MaterialPointsOptions;
using comminute::MergedLoad;
using comminute::ParameterError;
using comminute::PointContents;
using comminute::PointLoads;
using comminute::PointNumbers;
using comminute::PointStatus;
using comminute::QuasiStatic;
using comminute::ShapeError;
using helpers::at;
using helpers::Index;

namespace {

using Numbers = std::vector<double>;

const LogGrid grid(-6.0, 0.2, 40);

Fabric start_on(const LogGrid& on) {
    return comminute::mixed_fabric(comminute::power_law(2.5, 0.02, 1.0), on);
}

MaterialPointsOptions keeping(PointContents contents, PointNumbers numbers = PointNumbers::float64) {
    MaterialPointsOptions options;
    options.contents = contents;
    options.numbers = numbers;
    return options;
}

const std::vector<MaterialPointsOptions> all_kinds{keeping(PointContents::states),
                                                   keeping(PointContents::gradings),
                                                   keeping(PointContents::states, PointNumbers::float32),
                                                   keeping(PointContents::gradings, PointNumbers::float32)};

Numbers grading_of(const MaterialPoints& points, Index i) {
    Numbers found(at(points.grid().bins()));
    points.grading(i, found);
    return found;
}

Numbers copy_of(comminute::VectorView<const double> view) {
    return {view.begin(), view.end()};
}

double error_of(const MaterialPointsOptions& options) {
    return options.numbers == PointNumbers::float64 ? 1e-14 : 3e-7;
}

/// Loads of a few points over a few steps, some of them unloading.
struct Path {
    Index points = 37;
    std::vector<Numbers> loads;
    std::vector<std::vector<unsigned char>> remix;

    explicit Path(unsigned seed, bool remixed = true) {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> share(0.0, 1.0);
        for (int step = 0; step < 5; ++step) {
            loads.emplace_back();
            remix.emplace_back();
            for (Index i = 0; i < points; ++i) {
                loads.back().push_back(i % 7 == 0 ? 0.5 : std::pow(2000.0, share(random)));
                remix.back().push_back(remixed && share(random) < 0.2);
            }
        }
    }
    PointLoads at_step(std::size_t step) const { return {loads[step], {remix[step].data(), points}}; }
};

}  // namespace

TEST_CASE("points go through loads and mixings as fabrics do") {
    const Path path(1);
    const Fabric start = start_on(grid);
    for (const MaterialPointsOptions& options : all_kinds) {
        MaterialPoints points(Material{}, start, path.points, options);
        std::vector<Fabric> fabrics(at(path.points), start);
        QuasiStatic solver(grid, Material{});
        for (std::size_t step = 0; step < path.loads.size(); ++step) {
            CHECK(points.update(path.at_step(step)));
            for (Index i = 0; i < path.points; ++i) {
                Fabric& fabric = fabrics[at(i)];
                if (path.remix[step][at(i)]) fabric = comminute::remix(fabric);
                comminute::SolveReport report;
                fabric = solver.solve(fabric, path.loads[step][at(i)], &report);
                CHECK(points.settled_at()[i] == fabric.settled_at().value_or(0.0));
                CHECK(helpers::largest_difference(grading_of(points, i), copy_of(fabric.grainsize())) <
                      error_of(options));
                CHECK(points.crushed()[i] == doctest::Approx(report.crushed).epsilon(1e-5));
            }
        }
        const Fabric last = points.fabric(3);
        CHECK(last.settled_at() == fabrics[3].settled_at());
        for (Index k = 0; k < grid.bins() * grid.bins(); ++k) {
            CHECK(std::abs(last.probability().data()[k] - fabrics[3].probability().data()[k]) <
                  error_of(options));
        }
    }
}

TEST_CASE("a loading rate belongs to the step, and to the mixing where gradings are kept") {
    const Fabric start = start_on(grid);
    QuasiStatic blend(grid, Material{}, {comminute::Scheme::conservative, 0.4});
    const Fabric after = blend.solve(blend.solve(start, 20.0), 300.0);
    const Numbers low{20.0, 20.0}, high{300.0, 300.0}, rate{0.4, 0.0}, other{0.4, 0.1};
    for (const MaterialPointsOptions& options : all_kinds) {
        MaterialPoints points(Material{}, start, 2, options);
        CHECK(points.update({low, {nullptr, 0}, rate}));
        const bool gradings = options.contents == PointContents::gradings;
        CHECK(points.update({high, {nullptr, 0}, other}) == !gradings);
        CHECK(helpers::largest_difference(grading_of(points, 0), copy_of(after.grainsize())) <
              error_of(options));
        if (!gradings) continue;
        CHECK(points.status()[1] == PointStatus::rate_change);
        CHECK(points.settled_at()[1] == 20.0);
        CHECK(points.message(1) ==
              "loading_rate[1] is 0.1; a point that keeps gradings has one loading rate from one mixing to "
              "the next");
        const std::vector<unsigned char> remix{0, 1};
        CHECK(points.update({high, {remix.data(), 2}, other}));
    }
}

TEST_CASE("a trial leaves no trace unless it is committed") {
    const Path path(2);
    for (const MaterialPointsOptions& options : all_kinds) {
        MaterialPoints points(Material{}, start_on(grid), path.points, options);
        points.update(path.at_step(0));
        const std::vector<unsigned char> before = points.pack();
        points.trial(path.at_step(1));
        CHECK(points.pack() == before);
        Numbers end(at(grid.bins()));
        points.end_grading(5, end);
        const double settled = points.end_settled_at()[5];
        points.trial(path.at_step(2));  // drops the first
        points.discard();
        CHECK(points.pack() == before);
        CHECK(copy_of(points.end_settled_at()) == copy_of(points.settled_at()));
        MaterialPoints at_once = points;
        points.trial(path.at_step(1));
        points.commit();
        CHECK(grading_of(points, 5) == end);
        CHECK(points.settled_at()[5] == settled);
        at_once.update(path.at_step(1));
        CHECK(at_once.pack() == points.pack());
        points.commit();  // nothing waits
        CHECK(at_once.pack() == points.pack());
    }
}

TEST_CASE("no bit depends on threads or on the other points") {
    const Path path(3);
    for (const MaterialPointsOptions& options : all_kinds) {
        MaterialPoints serial(Material{}, start_on(grid), path.points, options);
        MaterialPoints threaded = serial;
        MaterialPoints alone(Material{}, start_on(grid), 1, options);
        for (std::size_t step = 0; step < path.loads.size(); ++step) {
            serial.update(path.at_step(step));
            threaded.update(path.at_step(step), 8);
            alone.update({{path.loads[step].data() + 11, 1}, {path.remix[step].data() + 11, 1}});
        }
        CHECK(serial.pack() == threaded.pack());
        CHECK(grading_of(alone, 0) == grading_of(serial, 11));
        CHECK(alone.settled_at()[0] == serial.settled_at()[11]);
    }
}

TEST_CASE("points of one start on many threads of a host are independent") {
    const Fabric start = start_on(grid);
    const Material material;
    const Path path(4);
    std::vector<std::vector<unsigned char>> found(8);
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < found.size(); ++t) {
        threads.emplace_back([&, t] {
            MaterialPoints points(material, start, path.points);
            for (std::size_t step = 0; step < path.loads.size(); ++step) points.update(path.at_step(step));
            found[t] = points.pack();
        });
    }
    for (std::thread& thread : threads) thread.join();
    for (const auto& bytes : found) CHECK(bytes == found.front());
}

TEST_CASE("points that were packed go on to the bit") {
    const Path path(5);
    for (const MaterialPointsOptions& options : all_kinds) {
        Material material;
        material.fragments = comminute::TabulatedFragments{{0.25, 0.5, 1.0}, {0.0, 0.4, 1.0}};
        material.first_crush_stress = 2.0;
        material.stress_measure = comminute::StressMeasure(comminute::StressKind::energy, 0.2);
        material.k0 = 0.5;
        MaterialPoints points(material, start_on(grid), path.points, options);
        points.update(path.at_step(0));
        points.update(path.at_step(1));
        MaterialPoints restarted = MaterialPoints::unpack(points.pack());
        CHECK(restarted.material() == material);
        CHECK(restarted.options() == options);
        CHECK(restarted.shares_start(0) == points.shares_start(0));
        for (std::size_t step = 2; step < path.loads.size(); ++step) {
            points.update(path.at_step(step));
            restarted.update(path.at_step(step));
        }
        CHECK(restarted.pack() == points.pack());

        MaterialPoints elsewhere(material, start_on(grid), 2, options);
        for (const Index i : {1, 0}) {
            elsewhere.unpack_point(i, points.pack_point(10 + i));
            CHECK(grading_of(elsewhere, i) == grading_of(points, 10 + i));
        }
        elsewhere.assign(0, points, 12);
        CHECK(elsewhere.settled_at()[0] == points.settled_at()[12]);
        CHECK(elsewhere.pack_point(0) == points.pack_point(12));
        elsewhere.assign(0, MaterialPoints(material, start_on(grid), 1, options), 0);
        CHECK(elsewhere.shares_start(0));
    }
}

TEST_CASE("bytes that are not those of points are refused") {
    MaterialPoints points(Material{}, start_on(grid), 3);
    const Numbers load{1.0, 10.0, 100.0};
    points.update({load});
    const std::vector<unsigned char> bytes = points.pack();
    const auto refused = [](std::vector<unsigned char> changed, const char* finding) {
        CHECK_REFUSED(MaterialPoints::unpack(changed), (std::string("bytes ") + finding +
                                                        "; give what was written of a set of material points")
                                                           .c_str());
    };
    auto changed = bytes;
    changed[0] ^= 1U;
    refused(changed, "are no set of material points");
    changed = bytes;
    changed[8] = 9;
    refused(changed, "are of version 9, and this library reads 1");
    changed = bytes;
    changed[bytes.size() / 2] ^= 16U;
    refused(changed, "are damaged or cut short");
    changed.assign(bytes.begin(), bytes.end() - 9);
    refused(changed, "are damaged or cut short");
    refused({}, "are no set of material points");
    refused(points.pack_point(1), "are no set of material points");
    const std::string rule = "; give what was written of a material point";
    MaterialPoints other_grid(Material{}, start_on(LogGrid(-6.0, 0.3, 40)), 1);
    CHECK_REFUSED(other_grid.unpack_point(0, points.pack_point(1)),
                  ("bytes hold a point on another grid" + rule).c_str());
    MaterialPoints other_kind(Material{}, start_on(grid), 1, keeping(PointContents::gradings));
    CHECK_REFUSED(other_kind.unpack_point(0, points.pack_point(1)),
                  ("bytes hold a point with other options" + rule).c_str());
    MaterialPoints other_start(Material{},
                               comminute::mixed_fabric(comminute::power_law(2.2, 0.02, 1.0), grid), 1);
    CHECK_REFUSED(other_start.unpack_point(0, points.pack_point(1)),
                  ("bytes hold a point with another start" + rule).c_str());
}

TEST_CASE("a bad point keeps its begin state and spoils no other") {
    for (const MaterialPointsOptions& options : all_kinds) {
        MaterialPoints points(Material{}, start_on(grid), 4, options);
        MaterialPoints good = points;
        const Numbers first(4, 10.0);
        points.update({first});
        good.update({first});
        const Numbers load{200.0, helpers::not_a_number, 200.0, -2.5}, right{200.0, 0.0, 200.0, 0.0};
        const Numbers rate{0.0, 0.0, 1.5, 0.0}, right_rate(4, 0.0);
        const std::vector<unsigned char> remix{0, 1, 1, 1}, right_remix{0, 0, 0, 0};
        CHECK(!points.update({load, {remix.data(), 4}, rate}));
        const Numbers others{200.0, 0.0, 0.0, 0.0};
        CHECK(good.update({others, {right_remix.data(), 4}, right_rate}));
        CHECK(points.pack() == good.pack());
        const std::vector<PointStatus> status(points.status().begin(), points.status().end());
        CHECK(status == std::vector<PointStatus>{PointStatus::done, PointStatus::bad_load,
                                                 PointStatus::bad_rate, PointStatus::bad_load});
        CHECK(points.message(0).empty());
        CHECK(points.message(1) ==
              "stress_ratio[1] is nan; it must be a number of at least 0 (0 is no load)");
        CHECK(points.message(2) == "loading_rate[2] is 1.5; it must be between 0 and 1");
        char words[MaterialPoints::message_size];
        points.message(3, words);
        CHECK(std::string(words) ==
              "stress_ratio[3] is -2.5; it must be a number of at least 0 (0 is no load)");
        CHECK(points.update({right}));
        CHECK(points.status()[1] == PointStatus::done);
        CHECK(points.message(1).empty());
    }
}

TEST_CASE("merged points keep their mass") {
    const Numbers load{50.0, 400.0, 5.0};
    for (const MaterialPointsOptions& options : all_kinds) {
        const MaterialPoints points = [&] {
            MaterialPoints made(Material{}, start_on(grid), 3, options);
            made.update({load});
            return made;
        }();
        const Numbers one = grading_of(points, 0), other = grading_of(points, 1);
        for (const MergedLoad rule : {MergedLoad::smaller, MergedLoad::never}) {
            MaterialPoints merged = points;
            merged.merge(0, 1, 3.0, 1.0, rule);
            Numbers expected(one.size());
            for (std::size_t k = 0; k < one.size(); ++k) expected[k] = 0.75 * one[k] + 0.25 * other[k];
            const Numbers found = grading_of(merged, 0);
            const bool wide = options.numbers == PointNumbers::float64;
            CHECK(helpers::largest_difference(found, expected) < (wide ? 1e-15 : 1e-7));
            CHECK(std::abs(helpers::sum_of(found) - 1.0) < (wide ? 1e-15 : 1e-14));
            const bool states = options.contents == PointContents::states;
            CHECK(merged.settled_at()[0] == (states && rule == MergedLoad::smaller ? 50.0 : 0.0));
            CHECK(grading_of(merged, 1) == other);
            CHECK(merged.update({Numbers{600.0, 400.0, 5.0}}));
            CHECK(std::abs(helpers::sum_of(grading_of(merged, 0)) - 1.0) < 2e-14);
        }
    }
    MaterialPoints points(Material{}, start_on(grid), 2);
    CHECK_REFUSED(points.merge(0, 0, 1.0, 1.0), "j is 0; it must be another point than i");
    CHECK_REFUSED(points.merge(0, 2, 1.0, 1.0), "i is 2; it must be an index of a point");
    CHECK_REFUSED(points.merge(0, 1, -1.0, 1.0), "mass_i is -1; it must be a finite mass of at least 0");
    CHECK_REFUSED(points.merge(0, 1, 0.0, 0.0), "mass_i + mass_j is 0; it must be greater than 0 and finite");
}

TEST_CASE("merged points at rest under one load stay at rest") {
    MaterialPoints points(Material{}, start_on(grid), 2);
    const Numbers load{100.0, 100.0};
    points.update({load});
    const Numbers before = grading_of(points, 0);
    points.merge(0, 1, 1.0, 2.0);
    CHECK(points.settled_at()[0] == 100.0);
    CHECK(helpers::largest_difference(grading_of(points, 0), before) < 1e-16);
}

TEST_CASE("points share the start until they crush, and memory is used again") {
    constexpr Index count = 50;
    MaterialPoints points(Material{}, start_on(grid), count);
    const std::size_t at_start = points.memory();
    Numbers load(at(count), 0.5);
    points.update({load});
    CHECK(points.memory() == at_start);
    CHECK(points.shares_start(7));
    load[7] = 40.0;
    points.update({load});
    CHECK(!points.shares_start(7));
    CHECK(points.shares_start(8));
    const auto block = static_cast<std::size_t>(grid.bins() * grid.bins()) * sizeof(double);
    CHECK(points.memory() == at_start + block);
    for (int trial = 0; trial < 5; ++trial) {
        load[7] = 50.0 + trial;
        points.trial({load});
    }
    points.commit();
    CHECK(points.memory() == at_start + 2 * block);
}

TEST_CASE("a million updates ask for no memory") {
    constexpr Index count = 1000 / support::shortened;
    const LogGrid few(-4.0, 0.2, 12);
    for (const MaterialPointsOptions& options : all_kinds) {
        MaterialPoints points(Material{}, start_on(few), count, options);
        Numbers load(at(count));
        std::vector<unsigned char> remix(at(count));
        const auto step = [&](Index k) {
            for (Index i = 0; i < count; ++i) {
                load[at(i)] = std::pow(1.02, static_cast<double>((k + i) % 250));
                remix[at(i)] = (k + i) % 250 == 0;
            }
            points.update({load, {remix.data(), count}});
        };
        for (Index k = 0; k < 250; ++k) step(k);
        const std::size_t memory = points.memory();
        const long long before = support::allocations();
        for (Index k = 250; k < 500; ++k) step(k);
        CHECK(support::allocations() == before);
        CHECK(points.memory() == memory);
        CHECK(std::abs(helpers::sum_of(grading_of(points, 7)) - 1.0) < 1e-13);
    }
}

TEST_CASE("what does not fit is refused as a whole") {
    const Fabric start = start_on(grid);
    MaterialPoints points(Material{}, start, 3);
    const Numbers two(2, 1.0), three(3, 1.0);
    const std::vector<unsigned char> remix(2, 0);
    CHECK_THROWS_AS(points.update({two}), ShapeError);
    CHECK_THROWS_AS(points.update({three, {remix.data(), 2}}), ShapeError);
    CHECK_THROWS_AS(points.update({three, {nullptr, 0}, two}), ShapeError);
    CHECK_REFUSED(points.update({three}, 0), "threads is 0; it must be at least 1");
    CHECK_REFUSED(MaterialPoints(Material{}, start, 0), "count is 0; it must be at least 1");
    CHECK_REFUSED(points.message(3), "i is 3; it must be an index of a point");
    Material scattered;
    scattered.strength_scatter = true;
    CHECK_THROWS_AS(MaterialPoints(scattered, start, 1), ParameterError);
    const Fabric loaded = QuasiStatic(grid, Material{}).solve(start, 10.0);
    CHECK(MaterialPoints(Material{}, loaded, 1).settled_at()[0] == 10.0);
    CHECK_REFUSED(MaterialPoints(Material{}, loaded, 1, keeping(PointContents::gradings)),
                  "start has been loaded; points that keep gradings start from a mixed packing");
}
