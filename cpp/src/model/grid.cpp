// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/grid.hpp"

#include <algorithm>
#include <cmath>

#include "comminute/error.hpp"

namespace comminute {

LogGrid::LogGrid(double psi_min, double psi_max, Index bins)
    : psi_min_(psi_min), psi_max_(psi_max), bins_(bins) {
    require(std::isfinite(psi_min), "psi_min", psi_min, "finite");
    require(std::isfinite(psi_max), "psi_max", psi_max, "finite");
    if (!(psi_min < psi_max)) {
        throw ParameterError({.parameter = "psi_min",
                              .value = text(psi_min),
                              .number = psi_min,
                              .finding = "is " + text(psi_min) + " and psi_max is " + text(psi_max),
                              .rule = "psi_min must be less than psi_max"});
    }
    require(bins >= 8, "bins", static_cast<double>(bins), "at least 8");
}

Index LogGrid::bin_of(double psi) const {
    const double top = edge(bins_);
    const double rounding = 1e-12 * std::max({1.0, std::abs(psi_min_), std::abs(psi_max_)});
    if (!(psi <= top + rounding)) {
        throw ParameterError({.parameter = "psi",
                              .value = text(psi),
                              .number = psi,
                              .subject = "a log size of " + text(psi),
                              .finding = "lies above the grid's top edge, " + text(top),
                              .remedy = Remedy::raise_psi_max});
    }
    const double bin = std::floor((psi - edge(0)) / spacing());
    return static_cast<Index>(std::clamp(bin, 0.0, static_cast<double>(bins_ - 1)));
}

}  // namespace comminute
