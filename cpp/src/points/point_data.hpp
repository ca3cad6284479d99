// SPDX-License-Identifier: BSD-3-Clause
// Everything that material points keep (docs/guides/material_points.md).
#pragma once

#include <map>
#include <memory>
#include <vector>

#include "comminute/material_points.hpp"
#include "points/point_store.hpp"
#include "points/point_worker.hpp"

namespace comminute {

namespace detail {

constexpr Index shared = -1;  // in place of a block: the start, in memory that all points share

/// A state of a point: where its numbers are, and what is known of its past.
struct PointState {
    Index block = shared;
    double settled_at = 0.0;
    double loading_rate = 0.0;  // since the packing was mixed, where gradings are kept
    double largest = 0.0;       // size that no grain exceeds; 0 where it is not known
    double crushed = 0.0;       // mass crushed in psi since the packing was mixed, where gradings are kept
    bool mixed = false;         // anew since the start, of which it has its fabric until then
};

/// Points, their start, and the workers that take them through loads.
class PointData {
  public:
    PointData(const Material& material, const Fabric& start, Index count,
              const MaterialPointsOptions& options);
    /// Copies all but the workspaces.
    PointData(const PointData& other);
    PointData& operator=(const PointData&) = delete;

    Material material;
    LogGrid grid;
    MaterialPointsOptions options;
    Mean mean;
    double start_settled_at;
    double start_largest;
    LaneArray start;           // (N, N)
    Array<double> start_rows;  // (N) its grading

    PointStore store;
    Array<PointState> begin;       // (P)
    Array<PointState> end;         // (P) of the trial that waits
    Array<double> settled_at;      // (P) as views of the two show them
    Array<double> end_settled_at;  // (P)
    Array<double> crushed;         // (P) in the last step
    Array<PointStatus> status;     // (P)
    std::map<Index, Fault> faults;
    bool waits = false;  // a trial

    bool step(const PointLoads& loads, Index threads, bool in_place);
    void commit();
    void discard();

    bool keeps_states() const { return options.contents == PointContents::states; }
    /// Reads the numbers of a state: (N, N), or (N) twice. States in single precision are scaled to a total of 1.
    void read(const PointState& state, double* to) const;
    void read_grading(const PointState& state, VectorView<double> grainsize) const;
    /// Replaces the begin state of a point, whose block is taken where it shares the start.
    void replace(Index i, const double* numbers, const PointState& known);
    /// Gives the block of a point back, which shares the start from now on.
    void share_start(Index i, const PointState& known);
    Fabric fabric(Index i) const;
    void require_point(Index i) const;

  private:
    void require_fit(const PointLoads& loads, Index threads) const;
    void choose(const PointLoads& loads, bool in_place);
    bool judge(const PointLoads& loads, Index i);
    bool is_quiet(const PointState& state, double stress_ratio) const;
    void refuse(Index i, PointStatus why, Fault fault);
    void sweep(const PointLoads& loads, Index from, Index to, PointWorker& worker);
    void begin_step(const PointLoads& loads, Index i, Index place, PointWorker& worker);
    MatrixView<const double> begin_state(Index i, bool remix, MatrixView<double> out,
                                         PointWorker& worker) const;
    MatrixView<const double> begin_grading(Index i, bool remix, Index place, PointWorker& worker) const;
    void end_step(Index i, Index place, PointWorker& worker);

    MatrixView<const double> start_state() const { return {start.data(), grid.bins(), grid.bins()}; }

    Array<Index> moving_;  // points that the step moves, those with the same rate and loads side by side
    std::vector<std::unique_ptr<PointWorker>> workers_;
};

}  // namespace detail

struct MaterialPoints::Data : detail::PointData {
    using PointData::PointData;
};

}  // namespace comminute
