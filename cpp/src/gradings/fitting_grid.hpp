// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "comminute/grading.hpp"

namespace comminute::detail {

/// Sizes that a grid has to hold, as log sizes.
struct SizeRange {
    double top;     ///< largest grain
    double finest;  ///< grains below this may go to the fines bin
    /// Exact sizes, which are to lie on bin centres; null for a spread grading, which ends at the last edge instead.
    const PointMasses* points = nullptr;
    /// Distance below the top at which the density jumps most, which is to lie on an edge; 0 where it does not jump.
    double jump = 0.0;
    /// Bin width that the sizes and the fragments need; see comminute::needed_spacing.
    double needed = std::numeric_limits<double>::infinity();
};

/// Range of sizes spread evenly in ln s between two sizes, which may be equal.
SizeRange spread_between(double smallest, double largest);

/// Grid over a range of sizes; see comminute::fitting_grid. @throws ParameterError as that does
LogGrid grid_over(const SizeRange& sizes, const Material& material, double max_stress_ratio,
                  const GridOptions& options);

}  // namespace comminute::detail
