// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/view.hpp"

namespace comminute {

/// to[k] += factor * from[k], k < count; the two do not overlap.
void add_scaled(double factor, const double* from, double* to, Index count);

}  // namespace comminute
