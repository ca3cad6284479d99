// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "comminute/fabric.hpp"

namespace comminute::detail {

/// Adds the law of psibar for two independent neighbours drawn from `grainsize` to `pmf`, as neighbourhood_pmf() gives it.
/// @param grainsize  (N)
/// @param pmf        (N)
void add_neighbourhoods(const LogGrid& grid, VectorView<const double> grainsize, Mean mean,
                        VectorView<double> pmf);

/// Mixes grains completely (Eq. 64), bins alone: p[i, j] = grainsize[i] times the share of the neighbourhoods in bin j.
/// @param neighbours  (N) scratch
/// @param out         (N, N)
void mix_bins(const LogGrid& grid, VectorView<const double> grainsize, Mean mean,
              VectorView<double> neighbours, MatrixView<double> out);

}  // namespace comminute::detail
