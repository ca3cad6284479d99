// SPDX-License-Identifier: BSD-3-Clause
// One sweep over the narrow bands of several problems, side by side (docs/theory/one_sweep.md, section 15).
#pragma once

#include "simd/narrow_band.hpp"
#include "spreading/crush_table.hpp"
#include "sweeping/outer_product.hpp"
#include "sweeping/zone_pair.hpp"

namespace comminute::detail {

/// One state, its zones, and what is wanted of it.
struct Problem {
    const ZonePair* zones = nullptr;
    MatrixView<const double> state = {nullptr, 0, 0};
    const Arrivals* arrivals = nullptr;  ///< mass from atoms and ridges
    MatrixView<double>* out = nullptr;   ///< (N, N) state after; null where it is not wanted
    std::vector<double>* grading =
        nullptr;  ///< (N) mass by grainsize before, replaced by that after; null where it is not wanted
    double crushed = 0.0;            ///< out: mass crushed in psi, counted each time that it leaves its bin
    double crushed_neighbour = 0.0;  ///< out: the same in psibar
};

/// Sweeps narrow bands cell by cell. Their arms are too short to fill registers, so up to `lanes` problems go side by side,
/// each in a lane of its own; the result of each is the same, to the bit, whatever lies beside it.
class NarrowSweep {
  public:
    explicit NarrowSweep(Index bins) : bins_(bins) {}
    /// Makes a workspace of its own.
    NarrowSweep(const NarrowSweep& other) : NarrowSweep(other.bins_) {}
    NarrowSweep& operator=(const NarrowSweep&) = delete;

    /// @param table     fragments of mass that crushes until it leaves its bin
    /// @param problems  1 to `lanes`, of narrow bands; `out` is wanted of all or of none, and so is `grading`
    void run(const CrushTable& table, VectorView<Problem> problems);

    /// Forgets the table at hand, whose numbers are about to change in their place.
    void forget_table() { table_ = nullptr; }

  private:
    static LaneArray with_margins(const Array<double>& shares);
    static void at_least(LaneArray& numbers, Index count);
    void begin(const CrushTable& table, VectorView<const Problem> problems);
    void set_shares(VectorView<const Problem> problems);
    void take_cells(VectorView<const Problem> problems);
    Index take_arrivals(VectorView<const Problem> problems);
    void part_lines(const LaneArray& together, double* parted, Index stride) const;
    void give_states(VectorView<const Problem> problems);
    void give_gradings(VectorView<const Problem> problems);

    Index bins_;
    Index side_by_side_ = 1;  // problems, or lanes with some of them empty
    Index width_ = 0;
    const CrushTable* table_ = nullptr;  // whose `mass` and `below` are at hand
    LaneArray mass_;                     // (N and two margins) as NarrowLanding wants them
    LaneArray mass_upwards_;
    LaneArray below_;
    Array<Index> reach_;  // (N)
    Array<Index> line_;   // (N)
    LaneArray settled_;   // (N, W + 1, side by side), and so on, as in NarrowBand
    LaneArray arrived_;
    LaneArray cells_;
    LaneArray down_;
    LaneArray along_;
    LaneArray psi_;
    LaneArray psibar_;
    LaneArray crushed_;
    LaneArray neighbour_;
    LaneArray lines_;     // (2, W + 1, side by side, stride) lines of each problem in one piece
    LaneArray sums_;      // (K, side by side)
    LaneArray gradings_;  // (N, side by side)
};

}  // namespace comminute::detail
