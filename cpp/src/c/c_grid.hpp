// SPDX-License-Identifier: BSD-3-Clause
// Grids from C.
#pragma once

#include "c/c_call.hpp"

namespace comminute::detail {

inline LogGrid grid_of(const comminute_grid* grid) {
    const comminute_grid& given = struct_of(grid, "grid");
    return {given.psi_min, given.psi_max, static_cast<Index>(given.bins)};
}

}  // namespace comminute::detail
