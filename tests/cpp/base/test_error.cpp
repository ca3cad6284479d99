// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <set>
#include <string>
#include <vector>

#include "comminute/comminute.hpp"
#include "support/helpers.hpp"

using namespace comminute;

namespace {

template <class Error, class Call>
Fault fault_of(const Call& call) {
    try {
        call();
    } catch (const Error& error) {
        CHECK(error.what() == message(error.fault(), words_of(error.fault().remedy)));
        return error.fault();
    }
    FAIL("nothing was thrown");
    return {};
}

}  // namespace

TEST_CASE("a message is composed of place, parameter, value, rule and remedy") {
    const Fault bare{.parameter = "bins", .value = "4", .number = 4.0, .rule = "it must be at least 8"};
    CHECK(message(bare, "") == "bins is 4; it must be at least 8");
    CHECK(message(bare, "ask for more") == "bins is 4; it must be at least 8. Ask for more");
    Fault placed = bare;
    placed.place = {{"case.toml"}, {"grid"}};
    CHECK(message(placed, "") == "case.toml: grid: bins is 4; it must be at least 8");
    const Fault entry{.parameter = "state", .value = "nan", .place = {{"states", {3}}, {"state", {1, 2}}}};
    CHECK(message(entry, "scale it") == "states[3]: state[1, 2] is nan; scale it");
    const Fault whole{.parameter = "percent_finer",
                      .value = "40",
                      .subject = "40 % finer",
                      .finding = "stands already in",
                      .also = Place{"", {}, 2},
                      .place = {{"sand.csv", {}, 5, "percent_finer"}}};
    CHECK(message(whole, "") == "sand.csv row 5, column percent_finer: 40 % finer stands already in row 2");
    CHECK(message(within({"batch", {7}}, entry), "") == "batch[7]: states[3]: state[1, 2] is nan");
}

TEST_CASE("every kind of remedy has a name of its own and words") {
    std::set<std::string> names;
    for (const Remedy remedy : remedies()) {
        CHECK(!words_of(remedy).empty());
        CHECK(words_of(remedy).find("np.") == std::string::npos);
        names.insert(name_of(remedy));
    }
    CHECK(names.size() == remedies().size());
    CHECK(static_cast<int>(remedies().size()) ==
          static_cast<int>(Remedy::use_lattice_or_resolved));  // the last one
    CHECK(names.count("") == 0);
    CHECK(name_of(Remedy::none).empty());
    CHECK(words_of(Remedy::none).empty());
}

TEST_CASE("errors carry their parts") {
    const Fault load = fault_of<ParameterError>([] { require_stress_ratio(-1.0); });
    CHECK(load.parameter == "stress_ratio");
    CHECK(load.value == "-1");
    CHECK(load.number == -1.0);
    CHECK(load.rule == "it must be a number of at least 0 (0 is no load)");
    CHECK(load.place.empty());

    const Fault top = fault_of<ParameterError>([] { sieve_grading({0.5, 1.0}, {0.0, 90.0}); });
    CHECK(top.remedy == Remedy::extend_top);
    CHECK(top.number == 90.0);
    const Fault falls = fault_of<ParameterError>([] { sieve_grading({0.6, 0.3, 1.0}, {40.0, 50.0, 100.0}); });
    CHECK(falls.place == std::vector<Place>{{"", {}, 1}});
    CHECK(falls.remedy == Remedy::cumulate_retained);
    const Fault twice = fault_of<ParameterError>([] { sieve_grading({0.5, 2.0, 0.5}, {0.0, 100.0, 10.0}); });
    CHECK(twice.place == std::vector<Place>{{"", {}, 3}});
    CHECK(twice.also == Place{"", {}, 1});

    const LogGrid grid(-2.0, 0.0, 8);
    std::vector<double> shares(64, 1.0 / 64.0);
    shares[29] = helpers::not_a_number;
    const Fault share = fault_of<ParameterError>([&] { Fabric(grid, shares); });
    CHECK(share.place == std::vector<Place>{{"probability", {3, 5}}});
    shares[29] = 1.0 / 64.0;
    const Fault ridge = fault_of<ParameterError>([&] {
        std::vector<double> mass(8, 0.0);
        mass[4] = -1.0;
        Fabric(grid, shares, {}, {}, Mean::arithmetic, {{Axis::grain, -0.5, mass, 0.0}});
    });
    CHECK(ridge.place == std::vector<Place>{{"ridges", {0}}, {"mass", {4}}});
    CHECK(message(ridge, "") ==
          "ridges[0]: mass[4] is -1; a share of the mass must be finite and at least 0");
    const Fault total = fault_of<ParameterError>([&] { Fabric(grid, std::vector<double>(64, 1.0)); });
    CHECK(total.remedy == Remedy::normalise);

    const Fault shape = fault_of<ShapeError>([&] { Fabric(grid, std::vector<double>(63, 1.0)); });
    CHECK(shape.parameter == "probability");
    CHECK(shape.number == 63.0);

    QuasiStatic solver(LogGrid(-2.0, 0.0, 9), Material{});
    const Fault other = fault_of<ParameterError>([&] { solver.solve(Fabric(grid, shares), 2.0); });
    CHECK(other.remedy == Remedy::use_same_grid);
}

TEST_CASE("an error in one state of a batch is the solver's own, seen from the batch") {
    const LogGrid grid(-2.0, 0.0, 8);
    BatchSolver solver(QuasiStatic(grid, Material{}));
    std::vector<double> states(3 * 64, 1e308);
    std::vector<double> loads{0.0, 0.0, 400.0};
    const std::vector<double> never;
    const Fault fault = fault_of<ParameterError>([&] {
        solver.solve({{states.data(), 3, 8}, loads, {never.data(), 0}}, {states.data(), 3, 8}, {loads});
    });
    CHECK(fault.parameter == "state");
    CHECK(fault.place == std::vector<Place>{{"states", {2}}});
}
