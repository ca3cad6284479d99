// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "simd/lanes.hpp"

namespace comminute::detail {

// Loops of the sweep over a narrow band, in which several problems lie side by side: number p of `problems`, which is 1 or
// `lanes`, comes last in every array. No problem's numbers depend on those beside it, nor on how many there are.

/// Largest distance |i - j| in a band that is swept cell by cell. In wider ones the cells of an arm fill registers, and
/// running sums do with fewer operations. By measurement.
inline constexpr Index widest_narrow_band = 10;
/// Numbers before and after a table of shares by distance that may be read, and are not used.
inline constexpr Index narrow_margin = lanes + widest_narrow_band;

/// Lines of mass that arrives as outer products, psi[q, i] psibar[q, j] in cell (i, j).
struct NarrowProducts {
    const double* psi;     ///< (products, N, problems)
    const double* psibar;  ///< (products, N, problems)
    Index products;
};

/// Cells of the band, and what moves along the lines from each of them.
struct NarrowBand {
    Index problems;
    Index bins;          ///< N
    Index width;         ///< W, largest distance |i - j| of a cell of the band
    const Index* reach;  ///< (N) largest distance at which any problem moves mass in a shell; -1: none
    const Index* line;   ///< (N) largest distance from which mass moves along a line of any problem; -1: none
    const double* mass;  ///< (N) share of moving mass that lands m bins down
    const double* below;  ///< (N) share of mass from bin m that falls below the grid
    const double*
        settled;  ///< (N, W + 1, problems) share that moves of the mass in a cell, by shell and distance
    const double* arrived;  ///< (N, W + 1, problems) share that moves on of the mass landing in a cell
    NarrowProducts landing;
    bool keep;          ///< whether the mass that stays is wanted
    double* cells;      ///< (N, 2 W + 1, problems) mass in (i, i - W .. i + W), replaced by what stays
    double* down;       ///< (N, W + 1, problems) out: mass of (j + d, j) that moves down column j
    double* along;      ///< (N, W + 1, problems) out: mass of (i, i + d) that moves along row i
    double* crushed;    ///< (N, problems) out: mass crushed in psi out of each row
    double* neighbour;  ///< (problems) out: mass crushed in psibar
};
/// Sweeps the band from coarse to fine. Where both shares of a cell are 0 nothing moves, whatever its mass.
void sweep_narrow(const NarrowBand& band);

/// Mass moving along the lines of one problem, to land outside its band.
struct NarrowLanding {
    Index bins;
    Index width;
    const double* mass;          ///< (N) as above, with a margin of zeros on either side
    const double* mass_upwards;  ///< (N) the same at N - 1 - m, with such margins too
    const double* below;         ///< (N) as above, with a margin
    const double* along;         ///< (W + 1, stride) mass of (i, i + d) at [d, i]
    const double* down;          ///< (W + 1, stride) mass of (j + d, j) at [d, j]
    Index stride;
    NarrowProducts landing;  ///< of this problem alone
};
/// out = state and all that lands there, in the cells outside the band; those inside lose their meaning. `out` may be
/// `state` itself.
void land_outside(const NarrowLanding& lines, MatrixView<const double> state, MatrixView<double> out);

/// Gradings before and after mass has crushed out of their bins.
struct NarrowGradings {
    Index problems;
    Index bins;
    Index head;              ///< H, largest reduction that is added bin by bin
    Index terms;             ///< K, number of running sums beyond it; 0: none
    Index shells_a_block;    ///< B
    const double* mass;      ///< (H + 1)
    const double* below;     ///< (N)
    const double* entering;  ///< (B, K) weights of entering mass
    const double* falling;   ///< (B, K) decay of the sums since the first bin of a block
    const double* decay;     ///< (K) decay of the sums over a block
    const double* crushed;   ///< (N, problems) mass crushed out of each bin
    double* sums;            ///< (K, problems) scratch
    double* grading;         ///< (N, problems) replaced
};
/// Lets the crushed mass leave its bins and land in those below.
void move_gradings(const NarrowGradings& gradings);

}  // namespace comminute::detail
