// SPDX-License-Identifier: BSD-3-Clause
// Calls through the C interface that ask for no memory; the hosts in tests/hosts call the rest of it.
#include <comminute.h>
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "support/allocations.hpp"
#include "support/helpers.hpp"

TEST_CASE("a million calls from C ask for no memory") {
    constexpr int64_t count = 500 / support::shortened;
    char message[COMMINUTE_MESSAGE_SIZE];
    comminute_material_options of_material;
    comminute_material_defaults(&of_material);
    comminute_material* material = nullptr;
    REQUIRE(comminute_material_create(&of_material, &material, message, sizeof message) == COMMINUTE_OK);
    comminute_grading* start = nullptr;
    REQUIRE(comminute_grading_power_law(2.5, 0.02, 1.0, &start, message, sizeof message) == COMMINUTE_OK);
    const comminute_grid grid{sizeof grid, -4.0, -0.1, 12};
    comminute_points_options of_points;
    comminute_points_defaults(&of_points);
    comminute_points* points = nullptr;
    REQUIRE(comminute_points_create(material, start, &grid, count, &of_points, &points, message,
                                    sizeof message) == COMMINUTE_OK);
    comminute_table_options of_table;
    comminute_table_defaults(&of_table);
    of_table.max_stress_ratio = 200.0;
    comminute_table* table = nullptr;
    REQUIRE(comminute_table_create(material, start, &grid, &of_table, &table, message, sizeof message) ==
            COMMINUTE_OK);
    comminute_grading_destroy(start);
    comminute_material_destroy(material);

    std::vector<double> load(count), size(count), slope(count), masses(12);
    std::vector<unsigned char> remix(count);
    int worst = COMMINUTE_OK;
    const auto step = [&](int k) {
        for (std::size_t i = 0; i < load.size(); ++i) {
            const int phase = (k + static_cast<int>(i)) % 200;
            load[i] = std::pow(1.025, phase);
            remix[i] = phase == 0;
        }
        const comminute_loads loads{sizeof loads, count, load.data(), remix.data(), nullptr};
        worst = std::max(worst, comminute_points_update(points, &loads, 1, message, sizeof message));
        worst = std::max(worst, comminute_table_percentile(table, 50.0, load.data(), count, size.data(),
                                                           slope.data(), message, sizeof message));
    };
    for (int k = 0; k < 200; ++k) step(k);
    const long long before = support::allocations();
    for (int k = 200; k < 400; ++k) step(k);
    for (int call = 0; call < 1000000 / support::shortened; ++call) {
        const auto point = static_cast<int64_t>(call % count);
        worst = std::max(
            worst, comminute_points_grading(points, point, 0, masses.data(), 12, message, sizeof message));
    }
    CHECK(support::allocations() == before);
    CHECK(worst == COMMINUTE_OK);
    CHECK(std::string(message).empty());
    comminute_points_destroy(points);
    comminute_table_destroy(table);
}

TEST_CASE("a clone from C goes its own way") {
    char message[COMMINUTE_MESSAGE_SIZE];
    comminute_material_options of_material;
    comminute_material_defaults(&of_material);
    comminute_material* material = nullptr;
    comminute_grading* start = nullptr;
    REQUIRE(comminute_material_create(&of_material, &material, message, sizeof message) == COMMINUTE_OK);
    REQUIRE(comminute_grading_lognormal(0.3, 0.5, 1.0, &start, message, sizeof message) == COMMINUTE_OK);
    const comminute_grid grid{sizeof grid, -5.0, -0.05, 40};
    comminute_points_options of_points;
    comminute_points_defaults(&of_points);
    of_points.numbers = COMMINUTE_FLOAT32;
    comminute_points *points = nullptr, *clone = nullptr;
    REQUIRE(comminute_points_create(material, start, &grid, 2, &of_points, &points, message,
                                    sizeof message) == COMMINUTE_OK);
    const double load[] = {30.0, 80.0};
    const comminute_loads loads{sizeof loads, 2, load, nullptr, nullptr};
    CHECK(comminute_points_trial(points, &loads, 2, message, sizeof message) == COMMINUTE_OK);
    double settled[2], end[2];
    CHECK(comminute_points_settled_at(points, 0, settled, 2, message, sizeof message) == COMMINUTE_OK);
    CHECK(comminute_points_settled_at(points, 1, end, 2, message, sizeof message) == COMMINUTE_OK);
    CHECK(settled[1] == 0.0);
    CHECK(end[1] == 80.0);
    CHECK(comminute_points_clone(points, &clone, message, sizeof message) == COMMINUTE_OK);
    CHECK(comminute_points_commit(points, message, sizeof message) == COMMINUTE_OK);
    CHECK(comminute_points_discard(clone, message, sizeof message) == COMMINUTE_OK);
    double crushed[2];
    CHECK(comminute_points_crushed(points, crushed, 2, message, sizeof message) == COMMINUTE_OK);
    CHECK(crushed[1] > crushed[0]);
    CHECK(comminute_points_merge(points, 0, 1, 1.0, 1.0, COMMINUTE_NEVER, message, sizeof message) ==
          COMMINUTE_OK);
    CHECK(comminute_points_settled_at(points, 0, settled, 2, message, sizeof message) == COMMINUTE_OK);
    CHECK(settled[0] == 0.0);
    CHECK(comminute_points_settled_at(clone, 0, settled, 2, message, sizeof message) == COMMINUTE_OK);
    CHECK(settled[1] == 0.0);
    comminute_points_destroy(points);
    comminute_points_destroy(clone);
    comminute_grading_destroy(start);
    comminute_material_destroy(material);
}
