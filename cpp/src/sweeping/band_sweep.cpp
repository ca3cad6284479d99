// SPDX-License-Identifier: BSD-3-Clause
// The order of one sweep: blocks of columns, shells, diagonal cell, arms (docs/theory/one_sweep.md, sections 5 and 8).
#include "sweeping/band_sweep.hpp"

#include <algorithm>

#include "simd/loops.hpp"

namespace comminute::detail {
namespace {

constexpr Index rows_ahead = 4;  // rows of the state asked for before their shells have their turn

}  // namespace

BandSweep::BandSweep(Index bins)
    : walk_(bins),
      columns_(walk_),
      rows_(walk_),
      shares_(walk_),
      arms_(walk_, shares_, columns_, rows_),
      state_columns_(walk_),
      far_field_(walk_, columns_, rows_),
      last_row_(bins + lanes),
      crushed_rows_(bins) {}

// Row m, readable to the end of the pack of its diagonal cell: a copy where it is the last row of the state.
const double* BandSweep::row_of(MatrixView<const double> state, Index m) {
    if (m + 1 < walk_.bins()) return state.row(m);
    std::copy_n(state.row(m), walk_.bins(), last_row_.begin());
    return last_row_.data();
}

// Half of what crushes among equals moves along either line. Returns that half.
double BandSweep::crush_diagonal(Index m, double there, const Arrivals& arrivals, double* rest) {
    double landed = columns_.arrive_on_diagonal(m) + rows_.arrive_on_diagonal(m);
    if (m == 0) landed = columns_.fines(0) + rows_.fines(0);
    for (const OuterProduct& from : arrivals) landed += from.psi[m] * from.psibar[m];
    const double half = 0.5 * shares_.diagonal().divide(there, landed, rest);
    for (LinesInFlight* lines : {&columns_, &rows_}) {
        *lines->pushed(m, m) = half;
        lines->fines()[m] += half * walk_.table().below[m];
    }
    return half;
}

void BandSweep::crush_shell(Index m, MatrixView<const double> state, const Arrivals& arrivals, double* rest) {
    const double* const row = row_of(state, m);
    const double half = crush_diagonal(m, row[m], arrivals, rest != nullptr ? rest + m : nullptr);
    const Moved moved = arms_.crush(m, row, state_columns_.column(m), rest);
    crushed_rows_[m] = half + moved.first;
    crushed_ += half + moved.first;
    crushed_neighbour_ += half + moved.second;
}

void BandSweep::run(const CrushTable& table, const ActiveBand& before, const ActiveBand& after,
                    MatrixView<const double> state, const Arrivals& arrivals, MatrixView<double>* out) {
    walk_.begin(table, after);
    for (LinesInFlight* lines : {&columns_, &rows_}) lines->begin(out != nullptr);
    shares_.begin();
    arms_.begin(arrivals);
    std::fill(crushed_rows_.begin(), crushed_rows_.end(), 0.0);
    crushed_ = crushed_neighbour_ = 0.0;
    for (Index end = walk_.bins(); end > 0; end -= std::min(end, StateColumns::shells)) {
        const Index begin = std::max(Index{0}, end - StateColumns::shells);
        state_columns_.take(state, begin, end);
        for (Index m = end - 1; m >= begin; --m) {
            if (walk_.next()) {
                for (LinesInFlight* lines : {&columns_, &rows_}) lines->begin_block(m);
            }
            if (m >= rows_ahead) fetch(state.row(m - rows_ahead) + walk_.first(m), m - walk_.first(m));
            shares_.set(before, after, m);
            crush_shell(m, state, arrivals, out != nullptr ? out->row(m) : nullptr);
            if (out != nullptr) {
                for (LinesInFlight* lines : {&columns_, &rows_}) lines->keep_for_far_field(m);
            }
        }
        if (out != nullptr) state_columns_.give(*out);
    }
}

}  // namespace comminute::detail
