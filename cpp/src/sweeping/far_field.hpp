// SPDX-License-Identifier: BSD-3-Clause
// The cells of the state outside the band, which only receive fragments (docs/theory/one_sweep.md, section 9).
#pragma once

#include "simd/sums.hpp"
#include "sweeping/lines_in_flight.hpp"
#include "sweeping/outer_product.hpp"

namespace comminute::detail {

/// Writes the state outside the band once a sweep has come to its end. Nothing crushes there, so the sums of a line, as
/// its own shell left them, give all the mass that lands on it.
class FarField {
  public:
    /// All of these must outlive it; the lines must have been swept with `keep_for_far_field`.
    FarField(const ShellWalk& walk, const LinesInFlight& columns, const LinesInFlight& rows);

    /// @param state  the state before
    /// @param out    all cells outside the band are written; may be `state` itself
    void write(MatrixView<const double> state, const Arrivals& arrivals, MatrixView<double> out);

  private:
    /// Rows of one tile, and columns of one block.
    struct Range {
        Index begin;
        Index end;
    };

    void begin();
    void turn_sums();
    void keep_and_land(Index i, MatrixView<const double> state, const Arrivals& arrivals, double* row) const;
    void near_left(Index i, double* row) const;
    void near_right(Index i, double* row) const;
    void far_left(Range rows, Range columns, MatrixView<double> out);
    void far_right(Range rows, Range columns, MatrixView<double> out);
    Index left_end(Index i) const;
    Index right_begin(Index i) const;

    const ShellWalk& walk_;
    const LinesInFlight& columns_;
    const LinesInFlight& rows_;
    Array<Index> right_;     // (N) the first column right of the band in each row
    Array<double> factors_;  // (K, rows_at_once) of the rows at hand
    Array<double> by_term_;  // (K, N) far sums of the columns
    Array<double> scaled_;   // (K, N) the same, decayed to the first column of their block
};

}  // namespace comminute::detail
