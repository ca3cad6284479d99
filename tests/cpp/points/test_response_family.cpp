// SPDX-License-Identifier: BSD-3-Clause
// Families of response tables: nodes, bytes, statuses, memory.
#include <doctest/doctest.h>

#include <cmath>
#include <thread>
#include <vector>

#include "comminute/response_family.hpp"
#include "support/allocations.hpp"
#include "support/helpers.hpp"

using comminute::FamilyOptions;
using comminute::FamilyResponse;
using comminute::LogGrid;
using comminute::Material;
using comminute::QuasiStatic;
using comminute::ResponseFamily;
using comminute::ResponseStatus;
using comminute::ResponseTable;
using comminute::ShapeError;

namespace {

const LogGrid grid(-6.0, 0.1, 48);

ResponseTable table_of(double dimension, double most = 50.0, double largest = 1.0) {
    const auto start = comminute::mixed_fabric(comminute::power_law(dimension, 0.02, largest), grid);
    return ResponseTable(QuasiStatic(grid, Material{}), start, most, {1e-3});
}

const ResponseFamily& family() {
    static const ResponseFamily made =
        ResponseFamily::refined({2.0, 2.7}, [](double dimension) { return table_of(dimension); }, {5e-3});
    return made;
}

}  // namespace

TEST_CASE("a refined family meets tables that it was not made of") {
    CHECK(family().values().size() > 2);
    CHECK(family().values().size() < 40);
    for (const double value : {2.013, 2.2222, 2.5001, 2.69}) {
        const ResponseTable table = table_of(value);
        for (const double load : {0.1, 1.0, 7.0, 50.0}) {
            for (comminute::Index bin = 0; bin < grid.bins(); ++bin) {
                const double mine = family().finer(bin, load, value).value;
                CHECK(std::abs(mine - table.finer(bin, load).value) < 7e-3);
            }
        }
    }
}

TEST_CASE("bytes of a family are whole, of their kind, and give it back") {
    const std::vector<unsigned char> bytes = family().to_bytes();
    CHECK(ResponseFamily::from_bytes(bytes) == family());
    std::vector<unsigned char> changed = bytes;
    changed[bytes.size() / 3] ^= 4U;
    CHECK_REFUSED(ResponseFamily::from_bytes(changed),
                  "bytes are damaged or cut short; give what was written of a response family");
    const std::vector<unsigned char> table = family().tables().front().to_bytes();
    CHECK_REFUSED(ResponseFamily::from_bytes(table),
                  "bytes are no response family; give what was written of a response family");
}

TEST_CASE("tables that do not belong together are refused") {
    const ResponseTable first = table_of(2.2);
    CHECK_THROWS_AS(ResponseFamily({1.0, 2.0}, {first}), ShapeError);
    CHECK_REFUSED(ResponseFamily({1.0}, {first}), "number of values is 1; it must be at least 2");
    CHECK_REFUSED(ResponseFamily({2.0, 2.0}, {first, first}),
                  "values[1] is 2; it must be greater than the one before");
    CHECK_THROWS_AS(ResponseFamily({1.0, helpers::not_a_number}, {first, first}), comminute::ParameterError);
    for (const ResponseTable& other : {table_of(2.2, 40.0), table_of(2.2, 50.0, 0.8)}) {
        CHECK_THROWS_AS(ResponseFamily({1.0, 2.0}, {first, other}), comminute::ParameterError);
    }
    const auto make = [](double dimension) { return table_of(dimension); };
    FamilyOptions few{1e-6, 4};
    CHECK_REFUSED(ResponseFamily::refined({2.0, 2.7}, make, few),
                  "tolerance takes more than 4 nodes; it must be greater, or most_nodes, or the range of "
                  "values smaller");
}

TEST_CASE("look-ups ask for no memory, never throw, and agree on many threads") {
    const long long before = support::allocations();
    double sum = 0.0;
    for (int k = 0; k < 1000; ++k) {
        const double load = 0.05 * k, value = 2.0 + 0.0007 * k;
        sum += family().percentile(50.0, load, value).value + family().crushes(load, value).value;
    }
    CHECK(support::allocations() == before);
    CHECK(std::isfinite(sum));
    for (const double value : {1.99, 2.71, helpers::not_a_number}) {
        const FamilyResponse found = family().crushes(10.0, value);
        CHECK(found.status == ResponseStatus::outside);
        CHECK(std::isnan(found.value));
        CHECK(family().points(10.0, value).empty());
    }
    CHECK(family().crushes(51.0, 2.3).status == ResponseStatus::above);
    CHECK(family().scalar(0, 1.0, 2.3).status == ResponseStatus::no_scalar);
    CHECK(family().finer(-1, 1.0, 2.3).status == ResponseStatus::no_scalar);
    CHECK(family().percentile(-1.0, 1.0, 2.3).status == ResponseStatus::no_scalar);
    std::vector<double> found(8);
    std::vector<std::thread> threads;
    for (double& one : found) {
        threads.emplace_back([&one] { one = family().percentile(50.0, 20.0, 2.31).value; });
    }
    for (std::thread& thread : threads) thread.join();
    for (const double one : found) CHECK(one == found.front());
}
