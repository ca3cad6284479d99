// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "simd/arms.hpp"
#include "simd/lanes.hpp"
#include "spreading/crush_table.hpp"
#include "zones/active_band.hpp"

namespace comminute::detail {

/// Mass that arrives from outside the bins, psi[i] * psibar[j] in cell (i, j).
struct OuterProduct {
    std::vector<double> psi;
    std::vector<double> psibar;
};

/// One sweep of the slow rule over the band of the zone, shell by shell from coarse to fine.
///
/// Shell m holds the cells whose larger index is m: (m, m), the arm (m, j < m) whose mass crushes in psi and falls down
/// column j, and the arm (i < m, m) whose mass crushes in psibar and falls along row i. When shell m has its turn, all
/// that lands in it has been pushed by shells above, but for the fragments of (m, m) in its own arms; and the cells of
/// an arm do not feed each other, so every inner loop runs along an arm.
///
/// What a line holds in flight is kept in two parts: K running sums, brought up to date once a block of shells, and the
/// masses of the last H shells, H the head of the table, which are added one by one.
class BandSweep {
  public:
    explicit BandSweep(Index bins);

    /// @param before  shares of the cells that were active when `state` settled
    /// @param after   shares that are active now, none smaller
    /// @param out     of which the cells in the band are written; null: marginals only
    void run(const CrushTable& table, const ActiveBand& before, const ActiveBand& after,
             MatrixView<const double> state, const std::vector<OuterProduct>& arrivals,
             MatrixView<double>* out);

    /// After a run with `out`: writes all cells outside the band, what was there and what landed there.
    void far_field(const CrushTable& table, MatrixView<const double> state,
                   const std::vector<OuterProduct>& arrivals, MatrixView<double> out);

    /// (N) mass crushed in psi out of each row, once for every time that it left its bin.
    const std::vector<double>& crushed_rows() const { return crushed_rows_; }
    double crushed() const { return crushed_; }
    double crushed_neighbour() const { return crushed_neighbour_; }

  private:
    /// What falls along the lines of one direction.
    struct Lines {
        LaneVector sums;  // (packs, K, lanes) of each line, as of the first shell of the current block
        std::vector<double> own;   // (K) those of the line whose shell has its turn, as of this shell
        LaneVector pushed;         // (shells kept, width) mass pushed onto a line from a shell
        LaneVector fines;          // (N) what falls below the grid
        std::vector<double> near;  // (N, K) the sums of each line at its own shell
        std::vector<double> far;   // (N, K) the same with the head, for places beyond it

        // Of what arrives from outside the bins, by place on a line of this direction and by line.
        std::vector<double> OuterProduct::*along = nullptr;
        std::vector<double> OuterProduct::*across = nullptr;

        // Of the current shell, by line.
        LaneVector landed;
        LaneVector besides;   // of that, what the sums do not give
        LaneVector entering;  // what enters the sums
    };

    /// Of a cell, what moves of the mass that was there before and of what has landed.
    struct Shares {
        double settled = 0.0;
        double arrived = 0.0;
    };

    void prepare(const CrushTable& table, const ActiveBand& after, bool whole_state);
    Index last_shell_of(const CrushTable& table, Index m) const;
    double arrive_on_diagonal(const CrushTable& table, Lines& lines, Index m) const;
    const double* arrive_besides(const CrushTable& table, Lines& lines, const Lines& other,
                                 const std::vector<OuterProduct>& arrivals, Index m);
    void arrive_from_head(const CrushTable& table, Lines& lines, const Lines& other, Index m);
    const double* entering_the_sums(const CrushTable& table, Lines& lines, Index m);
    double landed_in_fines(const CrushTable& table, const Lines& lines, const Lines& other,
                           const std::vector<OuterProduct>& arrivals, Index m) const;
    static double crush_cell(Shares share, double there, double landed, double* rest);
    double crush_diagonal(const CrushTable& table, Index m, double there, double landed, double* rest);
    double crush_fines(const CrushTable& table, Lines& lines, const Lines& other,
                       const std::vector<OuterProduct>& arrivals, Index m, double there, double* rest);
    Arm arm_of(const CrushTable& table, Lines& lines, const Lines& other,
               const std::vector<OuterProduct>& arrivals, Index m, const double* there, bool whole_state);
    Moved crush_arms_of(const CrushTable& table, const std::vector<OuterProduct>& arrivals, Index m,
                        const double* row, double* column, double* rest_row);
    void set_shares(const ActiveBand& before, const ActiveBand& after, Index m);
    void hand_on(const CrushTable& table, Lines& lines, Index m) const;
    void begin_block(const CrushTable& table, Index m);
    const double* row_of(MatrixView<const double> state, Index m);
    void take_columns(MatrixView<const double> state, Index begin, Index end);
    void give_columns(MatrixView<double> out, Index begin, Index end) const;
    void near_left(const CrushTable& table, Index i, double* row) const;
    void near_right(const CrushTable& table, Index i, double* row) const;
    void turn_far_sums(const CrushTable& table);
    void far_left(const CrushTable& table, Index begin_row, Index end_row, Index begin, Index end,
                  MatrixView<double> out);
    void far_right(const CrushTable& table, Index begin_row, Index end_row, Index begin, Index end,
                   MatrixView<double> out);
    Index left_end(const CrushTable& table, Index i) const;
    Index right_begin(const CrushTable& table, Index i) const;

    Index first(Index m) const { return first_[static_cast<std::size_t>(m)]; }
    /// Mass pushed from a shell onto a line, and on to the next line.
    double* pushed(Lines& lines, Index shell, Index line) const {
        return lines.pushed.data() + place_of(shell) + line;
    }
    const double* pushed(const Lines& lines, Index shell, Index line) const {
        return lines.pushed.data() + place_of(shell) + line;
    }
    Index place_of(Index shell) const {
        return by_line_ ? 0 : (shell % shells_kept_ + 1) * width_ - lanes_up(shell + 1);
    }

    Index bins_;
    Index column_stride_;
    Index width_ = 0;
    Index shells_kept_ = 0;
    bool by_line_ = false;      // of the masses pushed, the last shell's alone are kept
    Index block_shell_ = 0;     // of the current shell in its block
    std::vector<Index> first_;  // (N) the lowest line that anything has been pushed onto by a shell's turn
    Lines columns_;
    Lines rows_;
    std::vector<double> crushed_rows_;
    double crushed_ = 0.0;
    double crushed_neighbour_ = 0.0;

    // Of the current shell, by line.
    LaneVector part_;
    LaneVector settled_share_;  // of mass that was there before, where some of the shell was active then
    LaneVector arrived_share_;
    const double* settled_ = nullptr;  // the one or the other
    Index ones_from_ = 0;              // arrived shares are 1 from here up to the shell before
    Shares diagonal_;
    Shares fines_;
    LaneVector last_row_;
    LaneVector block_;             // a few columns of the state, each in one piece
    std::vector<Index> right_;     // (N) the first column above the band in each row
    std::vector<double> factors_;  // (K, 4) of the rows at hand
    std::vector<double> by_term_;  // (K, N) far sums of the columns
    std::vector<double> scaled_;   // (K, N) the same as seen from the first column of their block
};

}  // namespace comminute::detail
