// SPDX-License-Identifier: BSD-3-Clause
#include "loops.hpp"

#include "multiversion.hpp"

namespace comminute {

COMMINUTE_MULTIVERSION void add_scaled(double factor, const double* from, double* to, Index count) {
    COMMINUTE_INDEPENDENT
    for (Index k = 0; k < count; ++k) to[k] += factor * from[k];
}

}  // namespace comminute
