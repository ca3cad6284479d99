// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "comminute/export.hpp"
#include "comminute/view.hpp"

namespace comminute {

/// Evenly spaced bins of log grainsize psi = ln s, the same on both axes of the fabric.
///
/// Bin i spans `centre(i)` +- `spacing()`/2. Bin 0 is the *fines bin*: it stands for every size below its
/// upper edge, so no mass is ever dropped at the bottom; in crush tests and means it stands for its centre.
///
/// @throws ParameterError unless both ends are finite, psi_min < psi_max and bins >= 8.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 1.0, 351);
/// CHECK(grid.centre(300) == 0.0);
/// CHECK(grid.bin_of(-50.0) == 0);
/// @endcode
class COMMINUTE_API LogGrid {
  public:
    /// @param psi_min, psi_max  centres of the first and of the last bin, ln(size in the material's unit)
    LogGrid(double psi_min, double psi_max, Index bins);

    double psi_min() const { return psi_min_; }
    double psi_max() const { return psi_max_; }
    Index bins() const { return bins_; }
    double spacing() const { return (psi_max_ - psi_min_) / static_cast<double>(bins_ - 1); }

    /// Centre of bin i. Both ends are exact, and by the weighted mean so is a zero between them.
    double centre(Index i) const {
        if (i == 0) return psi_min_;
        if (i == bins_ - 1) return psi_max_;
        return (psi_min_ * static_cast<double>(bins_ - 1 - i) + psi_max_ * static_cast<double>(i)) /
               static_cast<double>(bins_ - 1);
    }

    /// Edge between the bins i-1 and i, for i = 0 .. bins. Edge 0 is nominal: the fines bin has no lower end.
    double edge(Index i) const { return centre(i) - 0.5 * spacing(); }

    /// The bin that holds psi; 0 for everything below the grid.
    /// @throws ParameterError if psi lies above the last edge (a rounding error is forgiven) or is NaN.
    Index bin_of(double psi) const;

    friend bool operator==(const LogGrid& a, const LogGrid& b) {
        return a.psi_min_ == b.psi_min_ && a.psi_max_ == b.psi_max_ && a.bins_ == b.bins_;
    }
    friend bool operator!=(const LogGrid& a, const LogGrid& b) { return !(a == b); }

  private:
    double psi_min_;
    double psi_max_;
    Index bins_;
};

}  // namespace comminute
