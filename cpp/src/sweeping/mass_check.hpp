// SPDX-License-Identifier: BSD-3-Clause
// Search for entries of a state that are no masses, on which no solve may rest (docs/theory/one_sweep.md, section 14).
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "base/arrays.hpp"
#include "comminute/error.hpp"
#include "zones/active_band.hpp"

namespace comminute::detail {

/// Mass below 0 that rounding in a host may leave, which a state may have.
inline constexpr double negative_by_rounding = -1e-12;
/// Mass up to which no sum over a state overflows.
inline constexpr double most_summable = 1e200;

/// Indices of an entry.
using Cell = std::pair<Index, Index>;

/// Gives the first entry that is no mass, or more than sums can hold.
std::optional<Cell> first_bad_mass(MatrixView<const double> state);
/// Columns of each row between which a crush zone lies.
class ZoneExtent {
  public:
    explicit ZoneExtent(Index bins) : begin_(bins), end_(bins) {}
    void set(const ActiveBand& zone);

    Index begin(Index i) const { return begin_[i]; }
    Index end(Index i) const { return end_[i]; }

  private:
    Array<Index> begin_;  // (N)
    Array<Index> end_;
};

/// Gives the first entry inside a crush zone that is no mass.
std::optional<Cell> first_bad_mass(MatrixView<const double> state, const ActiveBand& zone,
                                   const ZoneExtent& extent);

/// Gives the fault of an entry that is no mass.
/// @param list   name of the state or the stack of states
/// @param index  indices of the entry there
/// @param zone   whether entries outside the crush zone are left out
Fault mass_fault(double entry, const char* list, std::vector<Index> index, bool zone);

}  // namespace comminute::detail
