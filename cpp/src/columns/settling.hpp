// SPDX-License-Identifier: BSD-3-Clause
// Crushing of a row until it is at rest, pairs that have just met told from old ones (docs/theory/columns.md, section 3).
#pragma once

#include <array>
#include <vector>

#include "base/arrays.hpp"
#include "columns/fresh_pairs.hpp"
#include "resolved/triple_state.hpp"
#include "resolved/triple_tables.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {

/// Bounds of the crushes of one step, as shares of the row's mass.
struct SettlingRules {
    double tolerance;    ///< mass that crushes in one step, and mass of adjacent cells that both would
    double competition;  ///< share of the pending mass of new pairs whose partner is pending too
    double rest;         ///< pending mass that is left
};

/// A row of a column: its law and the crushes of its grains.
struct OpenRow {
    TripleState law;
    Array<double> counts;  ///< (N) mass of each node times the crushes that its grains have been through
};

/// Steps of one thread, with their working memory.
class Settling {
  public:
    Settling(const TripleTables& tables, const SettlingRules& rules);

    /// Crushes pending mass, each cell at the same rate, until the rest is left or until a time.
    /// @param fresh   new pairs; null where there are none
    /// @param hazard  crushes of a pending cell in that time; inf: until the rest is left
    /// @throws ParameterError where it does not come to an end
    void run(OpenRow& row, FreshPairs* fresh, double hazard) { crush(row, fresh, hazard, rules_.rest); }
    /// Crushes all pending mass but for rounding.
    void come_to_rest(OpenRow& row);
    /// Raises the load in steps that overrun no more than the tolerance, each followed by a step of crushes.
    void raise(OpenRow& row, double log_load, double max_step);

  private:
    static constexpr Index labels = 3;
    /// Label of a pair as its centre sees it: old, the centre is new, the neighbour is.
    static constexpr std::array<Index, kinds> left_label{0, 1, 2};
    static constexpr std::array<Index, kinds> right_label{0, 1, 0};
    /// The same pair seen from its other cell.
    static constexpr std::array<Index, labels> dual{0, 2, 1};
    using Pairs = std::array<LaneArray, labels>;  // (N, stride) [b, a] mass of centres b beside a, by label
    using Cells = std::array<LaneArray, kinds>;   // (N, N, stride)

    struct Active {
        Index node;
        double share;
        /// Mass that crushes between a and c: old pairs and new centres, in one of the two directions; a the new one, c it.
        std::array<double, 4> crushes;
    };
    static constexpr Index pair_of(Index a, Index c) {
        return a * (a + 1) / 2 + c;  // c <= a
    }
    Index place(Index b, Index a) const { return (b * nodes_ + a) * stride_; }
    void take(OpenRow& row, FreshPairs* fresh);
    void crush(OpenRow& row, FreshPairs* fresh, double hazard, double rest);
    double step(OpenRow& row, double hazard);
    double count_pending();
    void count_pairs();
    double released(double hazard);
    void compete(double theta);
    void release(double theta);
    void release_beside(Index b, Index a, double theta);
    void crush_between_pairs();
    void crush_between(Index a, Index c, Active* active, Index count);
    void count_crushes(OpenRow& row);
    void replace_neighbours(const TripleState& row);
    void set_factors(Index a, Index label);
    void move(Index a, Index kind, Index label, const LaneArray& lost, bool left, LaneArray& moved);
    void settle_moved(const TripleState& row, Index a, Index kind);
    void settle_landed();
    void turn(const double* from, double* to) const;
    void add_mirror(LaneArray& table);

    const TripleTables& tables_;
    SettlingRules rules_;
    Index nodes_;
    Index stride_;
    Index used_kinds_ = 1;
    const TripleState* row_ = nullptr;
    std::array<double*, kinds> settled_{};
    std::array<double*, kinds> pending_{};

    Pairs pairs_;
    Pairs waiting_;  // pending mass of them
    Pairs limit_;    // share of it that may crush at once
    Pairs sooner_;   // probability that the neighbour crushes before the centre
    Pairs crushing_;
    Pairs lost_;           // released mass of centres whose neighbour crushed first
    Pairs lost_either_;    // and whose other neighbour did
    LaneArray lost_left_;  // (N, N, stride) of the last kind, at the neighbour that crushed first
    Cells lost_right_;
    Array<Index> first_of_pair_;  // (pairs + 1)
    Array<Index> next_of_pair_;
    std::vector<Active> active_;
    Cells landed_;  // (N, N, stride) [a, c, b'] fragments of the centres between a and c
    std::vector<Index> written_;
    Array<unsigned char> lands_beside_;  // (N) whether any are beside a
    Cells beside_;       // (N, N, stride) [a, b, b'] by label: fragments b' of the crushed cells b beside a
    LaneArray outcome_;  // (N, stride)
    Array<double> visits_;
    Array<double> weighted_;        // visits, each with the crushes until then
    Array<double> weighted_nodes_;  // (N) the same over all pairs
    Array<double> went_on_;         // (N) of that what crushed again
    Array<double> crushed_;         // (N) mass of the grains of each node that crush
    Array<Index> columns_;
    LaneArray around_;
    LaneArray factor_;
    std::array<LaneArray, labels> leaves_;  // (stride)
    std::array<LaneArray, 2> moved_;        // (rows, stride) from the right, from the left
    LaneArray turned_;
};

}  // namespace comminute::detail
