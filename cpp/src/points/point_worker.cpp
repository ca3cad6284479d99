// SPDX-License-Identifier: BSD-3-Clause
// Tasks of the points at hand (docs/guides/material_points.md).
#include "points/point_worker.hpp"

#include <algorithm>

namespace comminute::detail {

PointWorker::PointWorker(const LogGrid& grid, const Material& material, Scheme scheme)
    : grid_(grid),
      material_(material),
      scheme_(scheme),
      bins_(grid.bins()),
      states_(most * bins_ * bins_),
      gradings_(static_cast<std::size_t>(most), std::vector<double>(static_cast<std::size_t>(bins_))),
      both_(2 * most * bins_),
      neighbours_(bins_),
      crushed_(most) {
    tasks_.reserve(static_cast<std::size_t>(most));
    out_.reserve(static_cast<std::size_t>(most));
    place_.reserve(static_cast<std::size_t>(most));
}

void PointWorker::clear() {
    tasks_.clear();
    out_.clear();
    place_.clear();
    std::fill(crushed_.begin(), crushed_.end(), 0.0);
}

void PointWorker::add(Index place, const Loads& loads, MatrixView<const double> from,
                      const MatrixView<double>* out) {
    if (out != nullptr) out_.push_back(*out);
    place_.push_back(place);
    tasks_.push_back({loads,
                      from,
                      &none_,
                      out == nullptr ? &grading(place) : nullptr,
                      out == nullptr ? nullptr : &out_.back(),
                      {}});
}

void PointWorker::solve(double loading_rate) {
    if (tasks_.empty()) return;
    solver_of(loading_rate).settle(tasks_);
    for (std::size_t k = 0; k < tasks_.size(); ++k) crushed_[place_[k]] = tasks_[k].report.crushed;
}

SolverWork& PointWorker::solver_of(double loading_rate) {
    const auto found = std::find_if(solvers_.begin(), solvers_.end(), [&](const SolverWork& solver) {
        return solver.options.loading_rate == loading_rate;
    });
    if (found != solvers_.end()) return *found;
    if (solvers_.size() == most_rates) solvers_.pop_front();
    return solvers_.emplace_back(grid_, material_, QuasiStaticOptions{scheme_, loading_rate});
}

}  // namespace comminute::detail
