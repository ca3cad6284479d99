// SPDX-License-Identifier: BSD-3-Clause
// Workspace of one thread that takes material points through loads (docs/guides/material_points.md).
#pragma once

#include <deque>
#include <vector>

#include "sweeping/solver_work.hpp"

namespace comminute::detail {

/// Solvers, one for each loading rate, and room for as many states as are solved side by side. Once it has seen a step of its
/// kind, another allocates nothing.
class PointWorker {
  public:
    static constexpr Index most = 2 * lanes;  // points at a time

    PointWorker(const LogGrid& grid, const Material& material, Scheme scheme);

    /// (N, N) state of the point at a place.
    MatrixView<double> state(Index place) { return {states_.data() + place * bins_ * bins_, bins_, bins_}; }
    /// (N) grading of the point at a place.
    std::vector<double>& grading(Index place) { return gradings_[static_cast<std::size_t>(place)]; }
    /// (2, N) gradings when the packing was last mixed, and now.
    double* both_gradings(Index place) { return both_.data() + 2 * place * bins_; }
    /// (N) scratch.
    VectorView<double> neighbours() { return {neighbours_.data(), bins_}; }

    /// Adds a task for the point at a place.
    /// @param out  null where the grading alone is wanted
    void add(Index place, const Loads& loads, MatrixView<const double> from, const MatrixView<double>* out);
    /// Solves what has been added, all at one loading rate. Then `crushed` tells the mass crushed in psi at a place.
    void solve(double loading_rate);
    double crushed(Index place) const { return crushed_[place]; }
    /// Forgets the tasks.
    void clear();

  private:
    static constexpr std::size_t most_rates = 16;
    SolverWork& solver_of(double loading_rate);

    LogGrid grid_;
    Material material_;
    Scheme scheme_;
    Index bins_;
    LaneArray states_;
    std::vector<std::vector<double>> gradings_;
    LaneArray both_;
    LaneArray neighbours_;
    Array<double> crushed_;
    const Arrivals none_;
    std::vector<Task> tasks_;
    std::vector<MatrixView<double>> out_;
    std::vector<Index> place_;
    std::deque<SolverWork> solvers_;
};

}  // namespace comminute::detail
