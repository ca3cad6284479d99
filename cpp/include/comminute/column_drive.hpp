// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "comminute/view.hpp"

namespace comminute {

/// Which cell of the row above a cell may change places with.
enum class Partners : unsigned char {
    permuted,  ///< another at random for each cell and each exchange: swaps at adjacent cells have nothing in common
    shift,   ///< that at one random distance for all cells of a row: neighbours arrive together
    locked,  ///< always the same: grains that are swapped back meet their old neighbours
};

/// Rates that drive a column for a while. Lengths in metres of solid, times in seconds.
struct ColumnDrive {
    VectorView<const double> shear_rate = {nullptr, 0};  ///< (rows) >= 0, bottom first
    double mixing = 0.0;  ///< D >= 0, diffusivity of grains over the height [m2/s], and beside it
    /// D_0 >= 0: D_0 times the shear rate times the square of the mean size, which is in the material's unit: times the
    /// square of that unit in metres
    double shear_mixing = 0.0;
    double segregation =
        0.0;  ///< k_s >= 0 [m]: the velocity is k_s times the shear rate times (s / mean - 1)
    /// k_b >= 0, crushes of an active grain in a unit of shear strain; inf: at once
    double crush_rate = std::numeric_limits<double>::infinity();
};

}  // namespace comminute
