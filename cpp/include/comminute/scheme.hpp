// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace comminute {

/// How the continuum becomes bins. The choice has two halves, the law of the fragments on the grid (see fragment_pmf) and
/// the test of what lies in the crush zone.
///
/// | | conservative | paper |
/// |---|---|---|
/// | fragments | finite volumes: mass uniform in its bin, shifted by R, lands by overlap; second order in the bin width | f_m = P[-m h < R <= -(m-1) h] (below Eq. 58): every crush moves at least one bin |
/// | zones in QuasiStatic and BatchSolver | a cell moves by the share of its area inside the zone, and exact sizes stay exact | a cell moves whole, by the test of its centre, and exact sizes go to bins |
/// | zones in Kernel, SlowUpdate and FullConvolution | a cell moves whole, by the test of its centre | the same |
///
/// A step cannot move a share of a cell: what stayed behind would meet the same zone again at the next step.
enum class Scheme {
    conservative,
    paper,
};

}  // namespace comminute
