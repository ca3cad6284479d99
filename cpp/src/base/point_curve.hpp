// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/view.hpp"

namespace comminute::detail {

/// Rounding that the shares of a curve are forgiven: they are sums, and their plateaus and their 1 are good to this.
constexpr double share_rounding = 1e-12;

/// A place on a curve given by points: a fraction of the way from point `upper` - 1 to point `upper`, or before the first
/// point where `upper` is 0.
struct PlaceOnCurve {
    Index upper;
    double fraction;
};

/// First place on a curve at which a share is reached, inf{x : F(x) >= share}: on a plateau its lower end, in a jump (two
/// points at one x) the jump, past the last point that point.
/// @param finer  (Q) shares at the points, Q >= 2, never falling
PlaceOnCurve first_at_least(VectorView<const double> finer, double share);

}  // namespace comminute::detail
