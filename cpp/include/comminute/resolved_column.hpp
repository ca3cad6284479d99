// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "comminute/column_drive.hpp"
#include "comminute/export.hpp"
#include "comminute/fabric.hpp"
#include "comminute/material.hpp"
#include "comminute/resolved.hpp"
#include "comminute/resolved_grid.hpp"

namespace comminute {

/// How a column of laws of three cells is made and run. The results do not depend on `threads`.
struct ResolvedColumnOptions {
    Mean mean = Mean::arithmetic;
    Partners partners = Partners::permuted;  ///< or shift, for comparison; locked columns have no such law
    double neighbour_length =
        0.0;  ///< [m of solid] >= 0, of which a grain's neighbours are apart; 0: the rows' distance
    double largest_mixing =
        0.02;  ///< in (0, 1], of a swap by mixing in one exchange, beyond which it is divided
    double largest_segregation = 0.1;  ///< in (0, 1], the same of segregation
    double tolerance =
        0.02;  ///< > 0, mass that a raise of the load may overrun, or that may crush, in one step
    double competition =
        0.3;             ///< in (0, 1], of the pending mass of new pairs, share whose partner is pending too
    double rest = 2e-4;  ///< > 0, active mass at which a row counts as at rest
    Index threads = 1;   ///< >= 1, at most so many rows are worked on at a time
};

/// Surroundings of the lowest or the highest row.
enum class ColumnEnd : unsigned char {
    closed,    ///< a wall
    periodic,  ///< the other end
    feed,      ///< grains of a given grading, which never run out
    outflow,   ///< nothing: rows leave as others are fed
};

/// Ends of a column. Both are periodic, or neither; a feed with a rate has an outflow at the other end.
struct ColumnEnds {
    ColumnEnd bottom = ColumnEnd::closed;
    ColumnEnd top = ColumnEnd::closed;
    std::vector<double> feed = {};  ///< (N) shares of the grains fed, by node
    double feed_rate =
        0.0;  ///< >= 0 [m of solid / s], at which rows of them, mixed at random, push the column on
};

/// Account of an advance of a `ResolvedColumn`.
struct ResolvedColumnReport {
    std::uint64_t exchanges = 0;       ///< into which it was divided
    double largest_probability = 0.0;  ///< of a swap of any pair of sizes that there was
    std::vector<double> inflow;        ///< (N) solid of each node that came in, less what left [m]
};

/// All that the future of a row depends on.
struct ResolvedRowRecord {
    std::vector<double> start;   ///< (N) of a row
    ResolvedRecord closed;       ///< of one that has never exchanged a grain
    TripleRecord open;           ///< of another
    std::vector<double> counts;  ///< (N) mass of each node times the crushes of its grains
    double load = 0.0;           ///< that stands; negative before the first
    double largest = 0.0;        ///< of the loads that stood
    bool has_met = false;        ///< whether a grain has been exchanged

    friend bool operator==(const ResolvedRowRecord& a, const ResolvedRowRecord& b) {
        return a.start == b.start && a.closed == b.closed && a.open == b.open && a.counts == b.counts &&
               a.load == b.load && a.largest == b.largest && a.has_met == b.has_met;
    }
};

/// All that the future of a column depends on beside its grid, material and options, for storage.
struct ResolvedColumnRecord {
    std::vector<ResolvedRowRecord> rows;  ///< bottom first
    std::uint64_t sweeps = 0;             ///< exchanges of a colour
    double fed = 0.0;                     ///< [m of solid] towards the next row

    friend bool operator==(const ResolvedColumnRecord& a, const ResolvedColumnRecord& b) {
        return a.rows == b.rows && a.sweeps == b.sweeps && a.fed == b.fed;
    }
};

/// A column of rows that mix, segregate and crush (Section 8.3), each with the law of three adjacent cells: `ColumnLattice`
/// with infinitely many cells, free of noise.
///
/// The transport of that law needs no closure: whether a cell is exchanged depends on its own size and its partner's. What an
/// exchange puts side by side has no common history, and is kept apart from old pairs until the row is at rest. Crushing is
/// closed as in `Resolved`, and a column in which nothing is exchanged is one of those a row, to the bit. Active cells crush
/// in random order after an exchange, the weakest first while a load rises. The derivation stands in
/// docs/theory/columns.md.
///
/// Memory is 3 N^3 numbers a row, 4 before its first exchange, and 14 N^3 a thread.
///
/// @code{.cpp}
/// const comminute::Material sand;
/// const auto grid = comminute::ResolvedGrid::graded(sand.fabric_width, -8.0, {-0.5, 0.0}, {});
/// std::vector<double> rows(2 * static_cast<std::size_t>(grid.nodes()), 0.0);
/// rows[static_cast<std::size_t>(grid.nodes()) - 1] = 1.0;            // the bottom row of size 1
/// rows[rows.size() - 1] = 1.0;                                       // and the top one
/// comminute::ResolvedColumn column(grid, sand, {rows.data(), 2, grid.nodes()}, 0.02);
/// const std::vector<double> loads{8.0, 4.0}, shear{1.0, 1.0};
/// column.load_to(loads);
/// const double at_rest = column.crushes(0);
/// comminute::ColumnDrive drive;
/// drive.shear_rate = shear;
/// drive.mixing = 1e-6;
/// column.advance(10.0, drive);
/// CHECK(column.crushes(0) > at_rest);                                // new neighbours, new crushes
/// @endcode
class COMMINUTE_API ResolvedColumn {
  public:
    /// @param pmf     (rows, N) shares of the nodes, bottom first, two rows at least; each a random mixture at no load
    /// @param height  > 0, of all rows together [m of solid]
    /// @throws ShapeError, ParameterError as `Resolved`, and for strengths that are scattered
    ResolvedColumn(const ResolvedGrid& grid, const Material& material, MatrixView<const double> pmf,
                   double height, const ResolvedColumnOptions& options = {});
    /// Goes on, to the same bits, from where `record` was taken.
    /// @throws ShapeError for a record of another number of nodes
    ResolvedColumn(const ResolvedGrid& grid, const Material& material, const ResolvedColumnRecord& record,
                   double height, const ResolvedColumnOptions& options = {});
    ~ResolvedColumn();
    ResolvedColumn(const ResolvedColumn& other);
    ResolvedColumn& operator=(const ResolvedColumn& other);
    ResolvedColumn(ResolvedColumn&&) noexcept;
    ResolvedColumn& operator=(ResolvedColumn&&) noexcept;

    Index rows() const;
    const ResolvedGrid& grid() const;
    const Material& material() const;
    const ResolvedColumnOptions& options() const;
    double height() const;
    std::uint64_t sweeps() const;

    /// Takes each row to a load of its own, the weakest cell first where that is a raise. A lower load than before leaves
    /// everything as it is; under it nothing may be exchanged.
    /// @param stress_ratio  (rows) >= 0
    /// @param go_on  asked some times a second; if it answers false (or throws) the column stops there
    /// @return       whether it came to the end
    /// @throws ShapeError, ParameterError for loads that do not fit
    bool load_to(VectorView<const double> stress_ratio, const std::function<bool()>& go_on = {});
    /// Stands under loads without a crush: what they activate crushes as time goes on, at the drive's rate.
    bool stand_under(VectorView<const double> stress_ratio, const std::function<bool()>& go_on = {});

    /// Exchanges and crushes for a time, under the loads that stand.
    /// @throws ShapeError, ParameterError for a time, a drive or ends outside their range, a column without a load, and a
    ///         load below the largest that a row has known
    ResolvedColumnReport advance(double time, const ColumnDrive& drive, const ColumnEnds& ends = {},
                                 const std::function<bool()>& go_on = {});

    /// (N) mass by node. @throws ParameterError for a row that is none; so do the others
    std::vector<double> pmf(Index row) const;
    /// (N, N, N) mass of the centre b between a and c at [b, a, c].
    std::vector<double> triples(Index row) const;
    /// (bins, bins) mass by bins of log grainsize and log neighbourhood grainsize; see `Resolved::joint`.
    std::vector<double> joint(Index row, const LogGrid& bins) const;
    /// Mean number of crushes that a grain of the row has been through, wherever it was then.
    double crushes(Index row) const;
    /// Mean size by mass.
    double mean_size(Index row) const;
    /// Active mass that has not crushed yet.
    double pending(Index row) const;

    ResolvedColumnRecord record() const;

  private:
    struct Work;
    std::unique_ptr<Work> work_;
};

}  // namespace comminute
