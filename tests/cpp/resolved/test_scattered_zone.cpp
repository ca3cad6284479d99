// SPDX-License-Identifier: BSD-3-Clause
// Means over the contrast of scattered strengths, against sums over many places, to a tenth of what a step is off by.
#include <doctest/doctest.h>

#include <cmath>

#include "resolved/scattered_zone.hpp"

using comminute::detail::hazard_of;
using comminute::detail::most_hazard;
using comminute::detail::ScatteredZone;

namespace {

struct Means {
    double share;
    double endured;
};

Means summed(double log_hazard, double lower, double upper) {
    constexpr int places = 20000;
    double share = 0.0;
    double borne = 0.0;
    for (int k = 0; k < places; ++k) {
        const double u = lower + (upper - lower) * (k + 0.5) / places;
        const double hazard = std::exp(log_hazard - 0.5 * u * u);
        share -= std::expm1(-hazard) / places;
        borne += hazard * std::exp(-hazard) / places;
    }
    return {share, borne / (1.0 - share)};
}

}  // namespace

TEST_CASE("means over the contrast are those of many places") {
    for (const double log_hazard : {-12.0, -2.0, 0.0, 1.5, 4.0, 12.0, 28.0, 300.0}) {
        const ScatteredZone zone(log_hazard);
        const double edge = std::sqrt(2.0 * std::fmax(log_hazard, 0.0));
        for (const double middle : {0.0, 0.4, edge - 0.3, edge, edge + 0.8}) {
            for (const double width : {0.02, 0.5, 3.0, 12.0}) {
                CAPTURE(log_hazard);
                CAPTURE(middle);
                CAPTURE(width);
                for (const double sign : {-1.0, 1.0}) {
                    const double lower = sign * middle - 0.5 * width;
                    const Means expected = summed(log_hazard, lower, lower + width);
                    const double share = zone.mean(lower, lower + width);
                    CHECK(std::abs(share - expected.share) < 1e-5);
                    if (1.0 - expected.share < 1e-3) continue;
                    const double endured = zone.endured(lower, lower + width, share);
                    CHECK(endured <= hazard_of(share));
                    if (width > 0.1) CHECK(endured == doctest::Approx(expected.endured).epsilon(2e-3));
                }
            }
        }
    }
}

TEST_CASE("a hazard is as large as its share tells, and no larger than certainty") {
    CHECK(hazard_of(0.0) == 0.0);
    CHECK(hazard_of(0.5) == doctest::Approx(std::log(2.0)).epsilon(1e-15));
    CHECK(hazard_of(1.0 - 1e-17) == most_hazard);
    CHECK(ScatteredZone(-20.0).mean(-1.0, 1.0) == 0.0);
    CHECK(ScatteredZone(0.0).at(0.0) == doctest::Approx(-std::expm1(-1.0)).epsilon(1e-15));
}
