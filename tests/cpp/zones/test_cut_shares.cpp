// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "zones/active_band.hpp"
#include "zones/cut_shares.hpp"

using comminute::Index;
using comminute::detail::cut_share;
using comminute::detail::CutShell;

namespace {

// Share of the half-filled cell by counting points, at the midpoints of a fine net, that pass the test of the zone.
double counted(const CutShell& cut, Index distance) {
    constexpr int points = 1500;
    const double low = static_cast<double>(cut.shell) - 0.5;
    const double width = cut.top - low;
    const double partner_low = low - static_cast<double>(distance);
    const double partner_width = distance == 0 ? width : 1.0;
    int inside = 0;
    for (int a = 0; a < points; ++a) {
        for (int b = 0; b < points; ++b) {
            const double x = low + width * (a + 0.5) / points;
            const double y = partner_low + partner_width * (b + 0.5) / points;
            const double larger = std::max(x, y);
            const double square = cut.steepness * (larger - cut.tip);
            inside += larger >= cut.tip && (x - y) * (x - y) <= square ? 1 : 0;
        }
    }
    return inside / static_cast<double>(points) / static_cast<double>(points);
}

}  // namespace

TEST_CASE("shares of cut cells are the areas inside the zone") {
    for (const double top : {20.0, 19.7, 20.35}) {
        for (const double tip : {12.0, 19.4, 19.6, 19.95}) {
            for (const double steepness : {0.02, 0.7, 5.0, 300.0}) {
                const CutShell cut{tip, steepness, 20, top};
                for (const Index distance : {0, 1, 2, 4}) {
                    CAPTURE(top);
                    CAPTURE(tip);
                    CAPTURE(steepness);
                    CAPTURE(distance);
                    // points are counted to within one row or column of the net
                    CHECK(std::abs(cut_share(cut, distance) - counted(cut, distance)) < 2.0 / 1500.0);
                }
            }
        }
    }
}

TEST_CASE("the limits of cut cells: no load, any load, fabric off") {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    CHECK(cut_share({20.0, 1.0, 20, 20.0}, 0) == 0.0);
    CHECK(cut_share({20.2, 1.0, 20, 20.0}, 1) == 0.0);
    CHECK(cut_share({-infinity, 1.0, 20, 20.0}, 3) == 1.0);
    CHECK(cut_share({19.75, infinity, 20, 20.0}, 3) == 0.5);
    CHECK(cut_share({19.75, infinity, 20, 20.0}, 0) == 0.75);
    CHECK(cut_share({19.75, 0.0, 20, 20.0}, 0) == 0.0);
}

TEST_CASE("only the bin of the largest grain is cut, and only where that lies inside it") {
    const comminute::LogGrid grid(-6.0, 0.0, 61);
    comminute::Material material;
    material.fabric_width = 0.2;
    comminute::detail::ActiveBand whole(grid, material, comminute::Scheme::conservative);
    comminute::detail::ActiveBand cut(grid, material, comminute::Scheme::conservative);
    whole.set_load(4.0);
    cut.set_load(4.0, 1.0);
    bool differs = false;
    for (Index m = 0; m < 61; ++m) {
        for (Index d = 0; d <= m; ++d) {
            if (m < 60) CHECK(cut.share(m, d) == whole.share(m, d));
            if (m == 60) differs = differs || cut.share(m, d) != whole.share(m, d);
        }
    }
    CHECK(differs);
    cut.set_load(4.0, std::exp(grid.edge(61)));
    for (Index d = 0; d <= 60; ++d) CHECK(cut.share(60, d) == whole.share(60, d));
}
