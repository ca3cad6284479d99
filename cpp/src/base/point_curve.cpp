// SPDX-License-Identifier: BSD-3-Clause
#include "base/point_curve.hpp"

#include <algorithm>

namespace comminute::detail {

PlaceOnCurve first_at_least(VectorView<const double> finer, double share) {
    const Index last = finer.size() - 1;
    const Index upper = std::lower_bound(finer.begin(), finer.end(), share - share_rounding) - finer.begin();
    if (upper > last) return {last, 1.0};
    if (upper == 0) return {0, 1.0};
    const double below = finer[upper - 1];
    return {upper, std::clamp((share - below) / (finer[upper] - below), 0.0, 1.0)};
}

}  // namespace comminute::detail
