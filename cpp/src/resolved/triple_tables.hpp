// SPDX-License-Identifier: BSD-3-Clause
// Tables of nodes for a law of three cells: means of neighbours, fragments, and which triples are active
// (docs/theory/three_cells.md, sections 2 and 3).
#pragma once

#include <optional>

#include "base/arrays.hpp"
#include "comminute/fabric.hpp"
#include "comminute/material.hpp"
#include "comminute/resolved_grid.hpp"
#include "resolved/scattered_zone.hpp"
#include "simd/lanes.hpp"

namespace comminute::detail {

/// Neighbours c, first to last, of a centre and its other neighbour with which some of the triple is active.
struct Reach {
    Index first = 0;
    Index last = -1;
    bool empty() const { return last < first; }
};

/// Crush zone of one centre under one load.
struct CentreZone {
    double half_width = 0.0;  ///< of the log sizes of neighbourhoods; 0 where nothing is active
    std::optional<ScatteredZone> scattered;  ///< where strengths are
};

/// Immutable tables of one grid, material and mean, shared by the states of a run. All that depends on the two neighbours
/// is symmetric in them to the bit, so that a state stays symmetric.
class TripleTables {
  public:
    TripleTables(const ResolvedGrid& grid, const Material& material, Mean mean);

    const ResolvedGrid& grid() const { return grid_; }
    const Material& material() const { return material_; }
    Mean mean() const { return mean_; }
    Index nodes() const { return nodes_; }
    /// Numbers from one row of a node's table to the next.
    Index stride() const { return stride_; }

    /// g = 2 n^2 ln(stress ratio) of Eq. 15.
    double level(double log_stress_ratio) const;
    double log_stress_ratio(double level) const;
    /// Load below which nothing is active.
    double lowest_level() const { return lowest_level_; }

    /// (stride) share of the mass of node b that one crush leaves in each node b' <= b; rows sum to 1.
    const double* fragments(Index b) const { return fragments_.data() + b * stride_; }
    /// Log size of the neighbourhood of a cell between two nodes.
    double neighbourhood(Index a, Index c) const { return mean_size_[a * stride_ + c]; }
    /// Square of the width over which that is spread.
    double spread(Index a, Index c) const { return spread_[a * stride_ + c]; }

    /// Zone of a centre under a load.
    CentreZone zone(Index b, double level) const;
    /// Share of the triple (b; a, c) inside the zone of b; where strengths are scattered, of its cells that the load crushes.
    double share(Index b, Index a, Index c, double level, const CentreZone& zone) const;
    /// Hazard that those cells of the triple have endured which the load leaves whole, where strengths are scattered.
    double endured(Index b, Index a, Index c, const CentreZone& zone, double share) const;
    /// Neighbours c for which that share is not 0.
    Reach reach(Index b, Index a, double level, const CentreZone& zone) const;

    /// Calls visit(b, a, reach, zone) for every centre b that is active beside a under a load.
    template <class Visit>
    void for_each_reach(double level, const Visit& visit) const {
        for (Index b = 1; b < nodes_; ++b) {
            const CentreZone of_centre = zone(b, level);
            if (of_centre.half_width == 0.0) continue;
            for (Index a = 0; a < nodes_; ++a) visit(b, a, reach(b, a, level, of_centre), of_centre);
        }
    }

  private:
    bool all_exact(Index b, Index a, Index c) const {
        return grid_.exact(b) && grid_.exact(a) && grid_.exact(c);
    }
    double tie(Index b, Index a, Index c, double level) const;
    void set_fragments();

    ResolvedGrid grid_;
    Material material_;
    Mean mean_;
    Index nodes_;
    Index stride_;
    double floor_;       // (0.01 n)^2, least squared width of an edge of the zone
    double tie_length_;  // of g, over which triples of three exact sizes crush in random order
    double tie_slack_;   // by which a tie may be active beyond the zone's edge
    double early_;       // level by which scattered strengths begin to crush before the load that others bear
    double contrast_;    // units of scattered contrasts to a log size, sqrt(w) / n
    double lowest_level_;
    Array<double> strength_;  // (N) k (psi - ln reference size)
    Array<double> centre_;    // (N)
    Array<double> width_;     // (N)
    Array<double> widest_;    // (N) square of the largest width over which the mean with any other is spread
    LaneArray mean_size_;     // (N, stride)
    LaneArray spread_;        // (N, stride)
    LaneArray fragments_;     // (N, stride)
};

}  // namespace comminute::detail
