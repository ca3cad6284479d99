// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>

#include "comminute/view.hpp"

namespace comminute::detail {

/// to[m] = exp(-decay m), m < count. From an exponential every few bins: multiplied up from bin to bin, the rounding of
/// one ratio would be that of the hundredth power a hundred times over.
inline void fill_powers(double decay, double* to, Index count) {
    std::array<double, 16> step;
    for (std::size_t m = 0; m < step.size(); ++m) step[m] = std::exp(-decay * static_cast<double>(m));
    for (Index m = 0; m < count;) {
        const double from = std::exp(-decay * static_cast<double>(m));
        for (std::size_t k = 0; k < step.size() && m < count; ++k, ++m) to[m] = from * step[k];
    }
}

}  // namespace comminute::detail
