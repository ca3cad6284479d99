// SPDX-License-Identifier: BSD-3-Clause
// The law of three adjacent cells and one step of it under a rising load (docs/theory/three_cells.md, sections 3 and 4).
#pragma once

#include <vector>

#include "base/arrays.hpp"
#include "comminute/resolved.hpp"
#include "resolved/triple_tables.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {

/// Working memory of steps, of one thread.
struct TripleScratch {
    explicit TripleScratch(const TripleTables& tables);

    /// A node that is active or about to crush between a pair of neighbours.
    struct Active {
        Index node;
        double share;    ///< active share
        double crushes;  ///< mass that crushes in this step
    };

    Array<Index> first_of_pair;  // (pairs + 1) first entry of `active` of each pair (a, c), c <= a
    Array<Index> next_of_pair;   // (pairs)
    std::vector<Active> active;  // fine to coarse in each pair
    LaneArray limit;             // (N, stride) [b, a]: share of the pending mass that may crush at once
    LaneArray pending;           // (N, stride) [b, a]: pending mass of centres b beside a
    LaneArray pairs;             // (N, stride) [b, a]: mass of centres b beside a
    LaneArray crushing;          // (N, stride) [b, a]: of that what crushes
    LaneArray landed;            // (N, N, stride) [a, c, b]: fragments b of the cells between a and c
    std::vector<Index> written;  // rows of `landed` that are not 0
    LaneArray beside;            // (N, N, stride) [a, b, b']: fragments b' of the crushed cells b beside a
    LaneArray outcome;           // (N, stride) share of one crush that ends in each node, by active node
    Array<double> count;         // (N) crushes until then
    LaneArray around;         // (N, stride) [z, t]: mass of one centre between z and its crushing neighbour t
    LaneArray moved;          // (rows, stride) [z, b']: of that what has b' for b now
    LaneArray moved_pending;  // the same of pending mass, where strengths scatter
    LaneArray moved_endured;  // the same of hazards endured, where strengths scatter
    LaneArray factor;         // (N, stride)
    LaneArray leaves;         // (stride) share of each neighbour of a centre that crushes
    Array<Index> columns;     // neighbours that do
};

/// Mass of every triple. (N, N, N) of centre, left and right neighbour
struct Triples {
    const std::vector<double>& mass;
};

/// State of the law of three cells: settled and pending mass of every triple, centre by centre, and the load.
class TripleState {
  public:
    /// A random mixture.
    /// @param pmf      (N) share of each node
    /// @param endured  (N) hazard that its grains have endured; may be left out
    explicit TripleState(const TripleTables& tables, const std::vector<double>& pmf,
                         const std::vector<double>& endured = {});
    /// Counted triples.
    TripleState(const TripleTables& tables, Triples mass);
    /// A state as `record` gave it, in every bit: shares and reach follow from the load.
    TripleState(const TripleTables& tables, const TripleRecord& record);
    TripleRecord record(const TripleTables& tables) const;

    double level() const { return level_; }
    double crushes() const { return crushes_; }
    double avalanches() const { return avalanches_; }
    /// (N) mass by node.
    std::vector<double> pmf(const TripleTables& tables) const;
    /// (N) hazard that the settled mass of each node has endured, on average; empty unless strengths scatter.
    std::vector<double> endured(const TripleTables& tables) const;
    /// Settled and pending mass of one triple.
    double mass(const TripleTables& tables, Index b, Index a, Index c) const {
        const Index at = (b * tables.nodes() + a) * tables.stride() + c;
        return settled_[at] + pending_[at];
    }
    const LaneArray& settled() const { return settled_; }
    const LaneArray& pending() const { return pending_; }
    /// The same to change, for what moves grains between states: mirror symmetry and equal pairs are its to keep.
    LaneArray& settled() { return settled_; }
    LaneArray& pending() { return pending_; }
    /// (N, N, stride) active share of every triple under the load.
    const LaneArray& share() const { return share_; }
    /// Neighbours c of (b; a, c) for which that is not 0.
    Reach reach(const TripleTables& tables, Index b, Index a) const { return reach_[b * tables.nodes() + a]; }

    /// Raises the load: what the zone overruns is pending from then on.
    void overrun(const TripleTables& tables, double level);
    /// Raises the load by one step: what the zone overruns crushes, and then the neighbours see what has become of it.
    void step(const TripleTables& tables, double level, TripleScratch& scratch);
    /// Mass that the zone would overrun in a step to a load, or, where that is more, the root of the mass of adjacent cells
    /// that would both crush in it.
    double overrun_mass(const TripleTables& tables, double level) const;

  private:
    Index row(const TripleTables& tables, Index b, Index a) const {
        return (b * tables.nodes() + a) * tables.stride();
    }
    double pair_mass(const TripleTables& tables, Index b, Index a) const;
    /// Settled mass of an entry that an active share takes.
    double taken(Index at, double after) const;
    /// Mass that settles, and the hazard that it has borne, times it.
    struct Settling {
        double mass;
        double endured;
    };
    Settling settling_of(Index at, double arriving, double endured) const;
    template <class Mass>
    void move_neighbours(const TripleTables& tables, Index centre, TripleScratch& scratch, LaneArray& moved,
                         const Mass& mass) const;
    void count_pairs(const TripleTables& tables, TripleScratch& scratch) const;
    void release(const TripleTables& tables, TripleScratch& scratch);
    void crush_between_pairs(const TripleTables& tables, TripleScratch& scratch);
    void replace_sides(const TripleTables& tables, TripleScratch& scratch);
    void settle_landed(const TripleTables& tables, TripleScratch& scratch);

    LaneArray settled_;  // (N, N, stride)
    LaneArray pending_;  // (N, N, stride)
    LaneArray share_;    // (N, N, stride) active share under the load
    LaneArray own_;      // (N, N, stride) hazard endured by cells that have always been in their triple
    LaneArray
        endured_;  // (N, N, stride) hazard that settled mass has borne, times it; empty unless strengths scatter
    Array<Reach> reach_;  // (N, N) where that share is not 0
    double level_;
    double crushes_ = 0.0;
    double avalanches_ = 0.0;
};

}  // namespace comminute::detail
