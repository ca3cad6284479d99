// SPDX-License-Identifier: BSD-3-Clause
// The crush zone of grains whose strength is scattered (docs/theory/three_cells.md, section 6).
#pragma once

#include <array>

#include "comminute/view.hpp"

namespace comminute::detail {

/// Hazard that stands for certainty: of e^-37 less than rounding is left.
constexpr double most_hazard = 37.0;
/// ln of the least hazard that is looked at; a cell that has endured less is as good as new.
constexpr double least_log_hazard = -16.0;

/// -ln(1 - share), at most `most_hazard`: the hazard that a share of cells has not endured.
double hazard_of(double share);

/// Share of cells that a load crushes, 1 - exp(-C e^(-u^2 / 2)), over their contrast u, the log size less the
/// neighbourhood's in units of n / sqrt(w).
class ScatteredZone {
  public:
    /// @param log_hazard  ln C
    explicit ScatteredZone(double log_hazard);

    /// Share at one contrast.
    double at(double contrast) const;
    /// Mean share over a range of contrasts.
    double mean(double lower, double upper) const;
    /// Hazard that those cells of the range have endured which the load leaves whole, on average; `share` is what it crushes.
    double endured(double lower, double upper, double share) const;

  private:
    static constexpr Index knots = 65;
    using Table = std::array<double, knots>;
    double hazard(double contrast) const;
    /// Integral from 0 to a contrast, whose values at the knots and whose slopes there are given.
    double integral(double contrast, const Table& values, const Table& slopes) const;

    double log_hazard_;
    double certain_ = 0.0;  // contrast up to which all crush
    double spacing_ = 0.0;  // of the knots from there on, to where the hazard is the least
    Table share_{};
    Table share_integral_{};
    Table borne_{};  // hazard times the share that bears it
    Table borne_integral_{};
};

}  // namespace comminute::detail
