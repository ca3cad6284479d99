// SPDX-License-Identifier: BSD-3-Clause
// Everything that a quasi-static solver keeps from one solve to the next, and its choice of the sweep
// (docs/theory/one_sweep.md, sections 2 and 15).
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "comminute/quasi_static.hpp"
#include "sweeping/band_sweep.hpp"
#include "sweeping/blend_sweep.hpp"
#include "sweeping/narrow_sweep.hpp"
#include "sweeping/point_sweep.hpp"
#include "sweeping/zone_pair.hpp"

namespace comminute {

namespace detail {

/// Loads between which a solve takes a state.
struct Loads {
    double settled_at;    ///< under which the state is at rest; 0: none
    double stress_ratio;  ///< larger than that
    double largest;       ///< size that no grain exceeds; 0 where it is not known
};

/// Bins of one state to be brought to rest.
struct Task {
    Loads loads;
    MatrixView<const double> state;
    const Arrivals* arrivals;      ///< mass from atoms and ridges
    std::vector<double>* grading;  ///< (N) before, replaced by that after; null where it is not wanted
    MatrixView<double>* out;       ///< (N, N) state after; null where it is not wanted
    SolveReport report;            ///< out
};

/// Tables, zones and workspaces of a quasi-static solver.
class SolverWork {
  public:
    SolverWork(const LogGrid& grid, const Material& material, const QuasiStaticOptions& options);

    const LogGrid grid;
    const QuasiStaticOptions options;

    const Material& material() const { return material_; }
    /// Takes another material. Workspaces stay, and the tables of the fragments where their law does.
    void set_material(const Material& material);

    /// Brings bins to rest, the narrow bands among them side by side; the result of each task does not depend on the
    /// others. Masses whose sum overflows leave crushes that are not finite.
    /// @param tasks  `out` is wanted of all or of none, and so is `grading`
    void settle(VectorView<Task> tasks);
    /// Refuses a bare array with an entry in the zone that is no mass; a fabric has none.
    void require_masses(MatrixView<const double> state, const Loads& loads);
    /// Brings atoms and ridges to rest.
    PointSweep& points() { return points_; }

  private:
    ZonePair& zones_of(const Loads& loads, VectorView<Problem> taken);
    const CrushTable& table_for(Index width) const;
    void settle_alone(const ZonePair& zones, Task& task);
    void settle_narrow(VectorView<Task*> tasks, VectorView<Problem> problems);
    void blend(const ZonePair& zones, Task& task);
    SolveReport report_of(SolvePath path, const CrushTable& table) const;

    Material material_;
    FragmentPmf fragments_;
    ExponentialSum sum_;
    double leaves_;  // 1 - f_0, share of one crush that leaves its bin
    CrushTable bin_by_bin_;
    CrushTable by_sums_;
    std::deque<ZonePair> zones_;  // in places that stay; one for each problem that is solved beside others
    BandSweep sweep_;
    NarrowSweep narrow_;
    BlendSweep blend_;
    PointSweep points_;
    Array<double> scratch_;  // (N, N) the blend's state after a solve that wants the grading alone
};

/// Refuses a state whose crushed mass, a sum over the zone, overflows.
void require_finite_sum(const SolveReport& report);

}  // namespace detail

struct QuasiStatic::Work : detail::SolverWork {
    using SolverWork::SolverWork;
};

}  // namespace comminute
