// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include "support/helpers.hpp"

using comminute::active_share;
using comminute::CrushZones;
using comminute::LogGrid;
using comminute::Material;
using comminute::ParameterError;
using comminute::ShapeError;
using comminute::Zone;
using helpers::at;
using helpers::Index;
using helpers::infinity;
using helpers::log_critical;
using helpers::log_uniform;
using helpers::material;
using helpers::random_material;

namespace {

LogGrid random_grid(std::mt19937_64& random, const Material& m, Index bins) {
    const double top = std::log(m.reference_size) + std::uniform_real_distribution<double>(-2.0, 2.0)(random);
    return {top - log_uniform(random, 0.5, 9.0), top, bins};
}

// Eqs. 52-55 at the centres; fines among fines never crush.
Zone zone_by_definition(const LogGrid& grid, const Material& m, double stress_ratio, Index i, Index j) {
    if (i == 0 && j == 0) return Zone::rest;
    const double load = std::log(stress_ratio);
    const bool grain = load >= log_critical(m, grid.centre(i), grid.centre(j));
    const bool neighbour = load >= log_critical(m, grid.centre(j), grid.centre(i));
    return static_cast<Zone>(2 * static_cast<int>(grain) + static_cast<int>(neighbour));
}

// Area share of a cell in which the larger grain crushes, from a million points spread evenly (the additive
// recurrence of the plastic number).
double share_by_counting(const LogGrid& grid, const Material& m, double stress_ratio, Index i, Index j) {
    const double load = std::log(stress_ratio);
    const double h = grid.spacing();
    const int points = 1000000;
    int inside = 0;
    double x = 0.5;
    double y = 0.5;
    for (int q = 0; q < points; ++q) {
        x += 0.7548776662466927600;
        y += 0.5698402909980532659;
        x -= std::floor(x);
        y -= std::floor(y);
        const double psi = grid.centre(i) + h * (x - 0.5);
        const double psibar = grid.centre(j) + h * (y - 0.5);
        if (load >= log_critical(m, std::max(psi, psibar), std::min(psi, psibar))) ++inside;
    }
    return static_cast<double>(inside) / points;
}

// The same as the integral over the larger grain's place t of the length that Eq. 15 covers in the smaller
// grain's cell, by the midpoint rule in the root of the distance to the zone's tip.
double share_by_integration(const LogGrid& grid, const Material& m, double stress_ratio, Index i, Index d) {
    const double h = grid.spacing();
    const double k = 6.0 * m.fabric_width * m.fabric_width / m.weibull_modulus;
    const double width_squared =
        2.0 * m.fabric_width * m.fabric_width *
        (std::log(stress_ratio) + 3.0 / m.weibull_modulus * (grid.centre(i) - std::log(m.reference_size)));
    const double onset = std::max(-width_squared / (k * h), -0.5);
    if (onset >= 0.5) return 0.0;
    const int points = 20000;
    double sum = 0.0;
    for (int q = 0; q < points; ++q) {
        const double v = (q + 0.5) / points;
        const double t = onset + (0.5 - onset) * v * v;
        const double width = std::sqrt(std::max(width_squared + k * h * t, 0.0)) / h;
        const double covered = d == 0
                                   ? 2.0 * std::min(width, t + 0.5)
                                   : std::min(std::max(0.5 - static_cast<double>(d) - t + width, 0.0), 1.0);
        sum += 2.0 * v * covered;
    }
    return (0.5 - onset) * sum / points;
}

}  // namespace

TEST_CASE("the critical stress ratio is Eq. 2, and Eq. 15 says the same in logarithms") {
    std::mt19937_64 random(21);
    for (int q = 0; q < 200; ++q) {
        const Material m = random_material(random);
        const double s = log_uniform(random, 0.1, 10.0);
        const double sbar =
            s * std::exp(std::uniform_real_distribution<double>(-5.0, 5.0)(random) * m.fabric_width);
        const double critical = comminute::critical_stress_ratio(m, s, sbar);
        const double psi = std::log(s);
        const double psibar = std::log(sbar);
        REQUIRE(std::log(critical) == doctest::Approx(log_critical(m, psi, psibar)).epsilon(1e-11));
        const double k = 6.0 * m.fabric_width * m.fabric_width / m.weibull_modulus;
        REQUIRE(m.k() == doctest::Approx(k).epsilon(1e-15));
        const double g = (psi - psibar) * (psi - psibar) - k * psi;
        REQUIRE(comminute::stress_function(m, psi, psibar) == doctest::Approx(g).epsilon(1e-14));
        REQUIRE(std::abs(comminute::logspace_load(m, critical) - g) <
                1e-13 * (std::abs(g) + k * (1.0 + std::abs(psi))));
        REQUIRE(comminute::stress_ratio_at(m, g) == doctest::Approx(critical).epsilon(1e-10));
    }
    CHECK(comminute::logspace_load(Material{}, 8.0) == doctest::Approx(0.005 * std::log(8.0)).epsilon(1e-14));
    CHECK(comminute::logspace_load(material(0.05, 3.0, 2.0), 8.0) ==
          doctest::Approx(0.005 * std::log(4.0)).epsilon(1e-14));
    CHECK(comminute::logspace_load(Material{}, 0.0) == -infinity);
    CHECK(comminute::stress_ratio_at(Material{}, -infinity) == 0.0);
    CHECK(comminute::critical_stress_ratio(material(infinity), 0.125, 1e-9) ==
          doctest::Approx(8.0).epsilon(1e-14));
}

TEST_CASE("the crush zones are those of Eqs. 52-55 at the bin centres") {
    std::mt19937_64 random(22);
    long found[4] = {0, 0, 0, 0};
    for (int q = 0; q < 300; ++q) {
        Material m = random_material(random);
        if (q % 10 == 0) m.fabric_width = infinity;
        const LogGrid grid = random_grid(random, m, std::uniform_int_distribution<Index>(8, 70)(random));
        const Index n = grid.bins();
        const double stress_ratio = log_uniform(random, 0.1, 1e5);
        const CrushZones zones(grid, m, stress_ratio);
        std::vector<std::uint8_t> filled(at(n * n));
        zones.fill({filled.data(), n, n});
        int wrong = 0;
        for (Index i = 0; i < n; ++i) {
            for (Index j = 0; j < n; ++j) {
                const Zone expected = zone_by_definition(grid, m, stress_ratio, i, j);
                const auto number = filled[at(i * n + j)];
                if (zones.at(i, j) != expected || number != static_cast<std::uint8_t>(expected)) ++wrong;
                if (expected == Zone::grain && i < j) ++wrong;  // the larger is the first to crush
                if (expected == Zone::neighbour && i > j) ++wrong;
                ++found[number];
            }
        }
        REQUIRE(wrong == 0);
    }
    for (const long cells : found) CHECK(cells > 1000);
}

TEST_CASE("the larger of two neighbours never needs the higher load") {
    std::mt19937_64 random(23);
    for (int q = 0; q < 500; ++q) {
        const Material m = random_material(random);
        const double small = log_uniform(random, 0.01, 1.0);
        const double large = small * log_uniform(random, 1.0, 3.0);
        REQUIRE(comminute::critical_stress_ratio(m, large, small) <=
                comminute::critical_stress_ratio(m, small, large));
    }
}

TEST_CASE("crush zones grow with the load and do not depend on how it was reached") {
    std::mt19937_64 random(24);
    for (int q = 0; q < 40; ++q) {
        const Material m = random_material(random);
        const LogGrid grid = random_grid(random, m, 48);
        CrushZones zones(grid, m, 1e6);
        double stress_ratio = 0.0;
        std::vector<std::uint8_t> before(48 * 48, 0);
        std::vector<std::uint8_t> after(48 * 48, 9);
        for (int step = 0; step < 12; ++step) {
            zones.set_load(stress_ratio);
            CHECK(zones.stress_ratio() == stress_ratio);
            zones.fill({after.data(), 48, 48});
            std::vector<std::uint8_t> fresh(48 * 48);
            CrushZones(grid, m, stress_ratio).fill({fresh.data(), 48, 48});
            REQUIRE(after == fresh);
            int shrunk = 0;
            for (std::size_t c = 0; c < before.size(); ++c) shrunk += (before[c] & ~after[c]) != 0 ? 1 : 0;
            REQUIRE(shrunk == 0);
            before = after;
            stress_ratio = stress_ratio == 0.0 ? 0.01 : 4.0 * stress_ratio;
        }
    }
}

TEST_CASE("zones are closed: a grain exactly at its critical load crushes") {
    std::mt19937_64 random(25);
    for (int q = 0; q < 300; ++q) {
        const Material m = random_material(random);
        const double top = std::log(m.reference_size);
        const LogGrid grid(top - log_uniform(random, 1.0, 8.0), top, 40);
        REQUIRE(CrushZones(grid, m, 1.0).at(39, 39) == Zone::both);
        REQUIRE(CrushZones(grid, m, 1.0 - 1e-9).at(39, 39) == Zone::rest);
        // any other cell: its larger grain j = 39 beside a smaller one, at the load of Eq. 2 and just below
        const auto i = std::uniform_int_distribution<Index>(0, 38)(random);
        const double log_load = log_critical(m, grid.centre(39), grid.centre(i));
        if (log_load > 600.0) continue;
        const double stress_ratio = std::exp(log_load);
        REQUIRE(CrushZones(grid, m, stress_ratio).at(i, 39) == Zone::neighbour);
        REQUIRE(CrushZones(grid, m, stress_ratio).at(39, i) == Zone::grain);
        REQUIRE(CrushZones(grid, m, stress_ratio * (1.0 - 1e-9 * (1.0 + log_load))).at(39, i) == Zone::rest);
    }
}

TEST_CASE("no load crushes nothing, and a load below 1 only what is larger than the reference size") {
    const LogGrid grid(-4.0, 2.0, 61);
    for (const double n : {0.05, 3.0, infinity}) {
        const CrushZones none(grid, material(n), 0.0);
        const CrushZones some(grid, material(n), 0.5);
        for (Index m = 0; m < 61; ++m) {
            CHECK(none.band(m) == -1);
            CHECK(none.overlap(m) == -1);
            CHECK(none.half_width(grid.centre(m)) == -1.0);
            CHECK((some.at(m, m) == Zone::both) == (std::exp(grid.centre(m)) >= 2.0));
        }
        CHECK(none.distrusted_below() == -infinity);
    }
}

TEST_CASE("zones depend on sizes only through their ratio to the reference size") {
    const LogGrid grid(-5.0, 1.0, 80);
    const double shift = std::log(7.3);
    const CrushZones zones(grid, material(0.3, 2.2), 3.7);
    const CrushZones shifted(LogGrid(-5.0 + shift, 1.0 + shift, 80), material(0.3, 2.2, 7.3), 3.7);
    for (Index m = 0; m < 80; ++m) {
        CHECK(zones.band(m) == shifted.band(m));
        CHECK(zones.overlap(m) == shifted.overlap(m));
    }
}

TEST_CASE("the half-width of the zone is the root of Eq. 15") {
    const CrushZones zones(LogGrid(-6.0, 1.0, 64), Material{}, 100.0);
    const double g = 0.005 * std::log(100.0);
    for (const double psi : {-4.0, -1.0, 0.0, 1.0}) {
        CHECK(zones.half_width(psi) == doctest::Approx(std::sqrt(g + 0.005 * psi)).epsilon(1e-13));
    }
    CHECK(zones.half_width(-std::log(100.0) - 1e-9) == -1.0);
    CHECK(zones.half_width(-std::log(100.0) + 1e-9) >= 0.0);
    CHECK(CrushZones(LogGrid(-6.0, 1.0, 64), material(infinity), 100.0).half_width(0.0) == infinity);
}

TEST_CASE("the active share of a cell is the area inside the zone, fabric narrow or wide") {
    const LogGrid grid(-4.0, 0.5, 46);
    for (const double n : {0.01, 0.05, 0.3, 1.5, 20.0, 300.0, infinity}) {
        const Material m = material(n, 2.0, 1.3);
        const double stress_ratio = 25.0;
        const Index at_tip = grid.bin_of(std::log(1.3) - 2.0 / 3.0 * std::log(stress_ratio));
        for (const Index i : {at_tip, at_tip + 9}) {
            const double width = CrushZones(grid, m, stress_ratio).half_width(grid.centre(i));
            const auto edge = static_cast<Index>(std::min(std::max(width, 0.0) / grid.spacing(), 12.0));
            for (const Index d : {Index{0}, edge + 1}) {
                // 1e-4: against exact areas a million points are good to 6e-5
                CHECK(std::abs(active_share(grid, m, stress_ratio, i, d) -
                               share_by_counting(grid, m, stress_ratio, i, i - d)) < 1e-4);
            }
        }
    }
    std::mt19937_64 random(27);
    int partly = 0;
    for (int q = 0; q < 600; ++q) {
        const Material m = material(log_uniform(random, 0.01, 300.0), log_uniform(random, 0.8, 12.0), 1.3);
        const auto i = std::uniform_int_distribution<Index>(4, 45)(random);
        const double stress_ratio =  // such that the tip lies within four bins of the cell, or anywhere
            std::exp(-3.0 / m.weibull_modulus * (grid.centre(i) - std::log(1.3)) +
                     std::uniform_real_distribution<double>(-0.05, q % 2 == 0 ? 0.4 : 8.0)(random));
        const double width = CrushZones(grid, m, stress_ratio).half_width(grid.centre(i)) / grid.spacing();
        const auto d = std::min(static_cast<Index>(std::min(std::max(width, 0.0), 99.0)) + q % 3, i);
        const double share = active_share(grid, m, stress_ratio, i, d);
        // 1e-6: the midpoint rule steps over the kinks of the covered length
        REQUIRE(std::abs(share - share_by_integration(grid, m, stress_ratio, i, d)) < 1e-6);
        if (share > 0.0 && share < 1.0) ++partly;
    }
    CHECK(partly > 200);
}

TEST_CASE("with the fabric off a cell's share is what lies above the critical size") {
    const LogGrid grid(-2.0, 0.0, 21);
    for (const double above : {-0.5, -0.3, 0.0, 0.2, 0.499}) {  // of the centre of bin 12, in bins
        const double stress_ratio = std::exp(-(grid.centre(12) + above * 0.1));
        const double below = above + 0.5;
        CHECK(active_share(grid, material(infinity), stress_ratio, 12, 0) ==
              doctest::Approx(1.0 - below * below).epsilon(1e-13));
        CHECK(active_share(grid, material(infinity), stress_ratio, 12, 1) ==
              doctest::Approx(1.0 - below).epsilon(1e-13));
        CHECK(active_share(grid, material(infinity), stress_ratio, 12, 12) ==
              doctest::Approx(1.0 - below).epsilon(1e-13));
        CHECK(active_share(grid, material(infinity), stress_ratio, 13, 7) == 1.0);
        CHECK(active_share(grid, material(infinity), stress_ratio, 11, 0) < 1e-14);
    }
}

TEST_CASE("where the zone's width hardly varies across a cell its share has the closed form") {
    // A load of e^690 makes W^2 = 2 n^2 (690 + psi) constant across a cell of 1e-3 to 1.5e-6.
    const LogGrid grid(-0.02, 0.0, 21);
    const double stress_ratio = std::exp(690.0);
    for (double bins = 0.05; bins < 4.0; bins += 0.083) {
        const Material m = material(bins * 1e-3 / std::sqrt(2.0 * 690.0));
        for (Index d = 0; d < 5; ++d) {
            const double beyond = bins - static_cast<double>(d);
            double expected = 0.0;
            if (d == 0) {
                expected = bins < 1.0 ? 1.0 - (1.0 - bins) * (1.0 - bins) : 1.0;
            } else if (beyond > -1.0) {
                expected = beyond <= 0.0   ? 0.5 * (1.0 + beyond) * (1.0 + beyond)
                           : beyond <= 1.0 ? 1.0 - 0.5 * (1.0 - beyond) * (1.0 - beyond)
                                           : 1.0;
            }
            // centre(20) = 0; W varies by 1e-6 of itself over the cell
            CHECK(std::abs(active_share(grid, m, stress_ratio, 20, d) - expected) < 4e-6);
        }
    }
}

TEST_CASE("shares are 1 well inside the zone, 0 well outside, symmetric, and grow with the load") {
    std::mt19937_64 random(26);
    const Index n = 40;
    for (int q = 0; q < 60; ++q) {
        Material m = random_material(random);
        if (q % 10 == 0) m.fabric_width = infinity;
        const LogGrid grid = random_grid(random, m, n);
        const double h = grid.spacing();
        std::vector<double> before(at(n * n), 0.0);
        std::vector<double> share(at(n * n), helpers::not_a_number);
        for (const double stress_ratio : {0.0, 0.3, 1.0, 3.0, 40.0, 1e3, 1e7, infinity}) {
            active_share(grid, m, stress_ratio, {share.data(), n, n});
            CHECK(share[0] == 0.0);
            int wrong = 0;
            for (Index i = 0; i < n; ++i) {
                for (Index j = 0; j < n; ++j) {
                    const double phi = share[at(i * n + j)];
                    const Index larger = std::max(i, j);
                    const Index distance = larger - std::min(i, j);
                    if (!(phi >= before[at(i * n + j)] - 1e-14 && phi <= 1.0)) ++wrong;
                    if (phi != share[at(j * n + i)]) ++wrong;
                    if (phi != active_share(grid, m, stress_ratio, larger, distance)) ++wrong;
                    if (larger == 0) continue;
                    // the largest and the smallest critical load that any point of the cell may have
                    const double psi = grid.centre(larger);
                    const auto d = static_cast<double>(distance);
                    const double hardest = log_critical(m, psi - 0.5 * h, psi - (d + 1.5) * h);
                    const double easiest =
                        log_critical(m, psi + 0.5 * h, psi + (0.5 - std::max(d - 1.0, 0.0)) * h);
                    if (std::log(stress_ratio) > hardest && !(phi > 1.0 - 1e-13)) ++wrong;
                    if (std::log(stress_ratio) < easiest && phi != 0.0) ++wrong;
                }
            }
            REQUIRE(wrong == 0);
            before = share;
        }
    }
}

TEST_CASE("a fabric so narrow that its width squared is 0 has no zone under any load") {
    const LogGrid grid(-3.0, 0.0, 41);
    std::vector<double> share(at(41 * 41), 1.0);
    for (const double stress_ratio : {0.0, 1.0, 1e9, infinity}) {
        active_share(grid, material(1e-170), stress_ratio, {share.data(), 41, 41});
        CHECK(*std::max_element(share.begin(), share.end()) == 0.0);
    }
}

TEST_CASE("results are distrusted where the zone reaches the fines bin, up to two widths above it") {
    const Material m = material(0.2);
    const LogGrid grid(-3.0, 0.0, 121);
    CHECK(CrushZones(grid, m, 2.0).distrusted_below() == -infinity);
    for (const double stress_ratio : {40.0, 1e3, 1e6}) {
        const double limit = CrushZones(grid, m, stress_ratio).distrusted_below();
        double expected = -infinity;
        for (Index i = 1; i < 121; ++i) {
            const double psi = grid.centre(i);
            if (log_critical(m, psi, -3.0) <= std::log(stress_ratio)) {
                expected = -3.0 + 2.0 * std::sqrt(2.0 * 0.04 * (std::log(stress_ratio) + psi));
            }
        }
        CHECK(expected > -3.0);
        CHECK(limit == doctest::Approx(expected).epsilon(1e-12));
    }
    CHECK(CrushZones(grid, material(infinity), 1e6).distrusted_below() == -infinity);
}

TEST_CASE("even the narrowest fabric crushes only grains among their equals") {
    const LogGrid grid(-1.0, 0.0, 11);
    for (const double n : {1e-3, 1e-9, 1e-100, 1e-160, 1e-300}) {
        CHECK(CrushZones(grid, material(n), 2.0).at(10, 10) == Zone::both);
        CHECK(CrushZones(grid, material(n), 2.0).at(10, 9) == Zone::rest);
    }
}

TEST_CASE("the criterion refuses what has no meaning, naming value and rule") {
    const LogGrid grid(-1.0, 0.0, 8);
    const char* load_text = "stress_ratio is -1; it must be a number of at least 0 (0 is no load)";
    CHECK_REFUSED(CrushZones(grid, Material{}, -1.0), load_text);
    CHECK_REFUSED(active_share(grid, Material{}, -1.0, 3, 0), load_text);
    CHECK_REFUSED(comminute::logspace_load(Material{}, -1.0), load_text);
    CHECK_REFUSED(CrushZones(grid, Material{}, helpers::not_a_number),
                  "stress_ratio is nan; it must be a number of at least 0 (0 is no load)");
    CHECK_REFUSED(CrushZones(grid, material(0.0), 1.0),
                  "fabric_width is 0; it must be greater than 0 (inf switches the fabric off)");
    CHECK_REFUSED(CrushZones(grid, material(1.0, -3.0), 1.0),
                  "weibull_modulus is -3; it must be greater than 0 and finite");
    CHECK_REFUSED(CrushZones(grid, material(1.0, 3.0, 0.0), 1.0),
                  "reference_size is 0; it must be greater than 0 and finite");
    CHECK_REFUSED(comminute::stress_function(material(infinity), 0.0, 0.0),
                  "fabric_width is inf; it must be finite here: g of Eq. 15 has no value where the fabric "
                  "is off");
    CHECK_REFUSED(comminute::critical_stress_ratio(Material{}, 0.0, 1.0),
                  "size is 0; it must be greater than 0");
    CHECK_REFUSED(comminute::critical_stress_ratio(Material{}, 1.0, helpers::not_a_number),
                  "neighbour_size is nan; it must be greater than 0");
    CHECK_REFUSED(active_share(grid, Material{}, 1.0, 8, 0), "m is 8; it must be a bin of the grid");
    CHECK_REFUSED(active_share(grid, Material{}, 1.0, 3, 4), "distance is 4; it must be between 0 and m");
    std::vector<std::uint8_t> bytes(72);
    std::vector<double> numbers(72);
    CHECK_THROWS_WITH_AS(CrushZones(grid, Material{}, 1.0).fill({bytes.data(), 8, 9}),
                         "zones has shape (8, 9); the grid needs (8, 8)", ShapeError);
    CHECK_THROWS_WITH_AS(active_share(grid, Material{}, 1.0, {numbers.data(), 9, 8}),
                         "share has shape (9, 8); the grid needs (8, 8)", ShapeError);
}

TEST_CASE("a stress becomes a stress ratio only where the first crushing stress is known") {
    Material m;
    CHECK_REFUSED(
        m.stress_ratio(2.0),
        "stress is 2; it needs first_crush_stress, which is not set. Set it on the Material, or give "
        "stress_ratio");
    m.first_crush_stress = 0.5;
    CHECK(m.stress_ratio(2.0) == 4.0);
    CHECK_REFUSED(m.stress_ratio(-2.0), "stress is -2; it must be a number of at least 0");
    m.first_crush_stress = 0.0;
    CHECK_REFUSED(m.validate(), "first_crush_stress is 0; it must be greater than 0 and finite");
}
