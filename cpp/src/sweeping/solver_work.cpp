// SPDX-License-Identifier: BSD-3-Clause
// Choice of the sweep, and the zones of the solves (docs/theory/one_sweep.md, sections 2 and 15).
#include "sweeping/solver_work.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "sweeping/marginal.hpp"
#include "sweeping/mass_check.hpp"

namespace comminute::detail {

SolverWork::SolverWork(const LogGrid& g, const Material& m, const QuasiStaticOptions& o)
    : grid(g),
      options(o),
      material_(m),
      fragments_(fragment_pmf(m.fragments, g.spacing(), g.bins(), o.scheme)),
      sum_(exponential_sum(m.fragments, g.spacing(), fragments_, o.scheme)),
      leaves_(fragments_.below[1]),
      bin_by_bin_(CrushTable::make(fragments_, {}, leaves_)),
      by_sums_(CrushTable::make(fragments_, sum_, leaves_)),
      sweep_(g.bins()),
      narrow_(g.bins()),
      blend_(fragments_, o.loading_rate),
      points_(g, m, fragments_, o.loading_rate) {}

void SolverWork::set_material(const Material& m) {
    const bool same_fragments = m.fragments == material_.fragments;
    material_ = m;
    if (!same_fragments) {
        fragments_ = fragment_pmf(m.fragments, grid.spacing(), grid.bins(), options.scheme);
        sum_ = exponential_sum(m.fragments, grid.spacing(), fragments_, options.scheme);
        leaves_ = fragments_.below[1];
        bin_by_bin_ = CrushTable::make(fragments_, {}, leaves_);
        by_sums_ = CrushTable::make(fragments_, sum_, leaves_);
        narrow_.forget_table();
        blend_ = BlendSweep(fragments_, options.loading_rate);
    }
    points_ = PointSweep(grid, m, fragments_, options.loading_rate);
    for (ZonePair& zones : zones_) zones.set_material(grid, m, options.scheme);
}

// Zones of these loads: those of an earlier solve where it had the same, else in the place of some that no problem at hand
// has taken.
ZonePair& SolverWork::zones_of(const Loads& loads, VectorView<Problem> taken) {
    const auto [settled_at, stress_ratio, largest] = loads;
    for (ZonePair& zones : zones_) {
        if (zones.is(settled_at, stress_ratio, largest)) return zones;
    }
    const auto is_free = [&](const ZonePair& zones) {
        return std::none_of(taken.begin(), taken.end(), [&](const Problem& p) { return p.zones == &zones; });
    };
    const auto found = std::find_if(zones_.begin(), zones_.end(), is_free);
    ZonePair& zones = found != zones_.end() ? *found : zones_.emplace_back(grid, material_, options.scheme);
    zones.set(settled_at, stress_ratio, largest);
    return zones;
}

const CrushTable& SolverWork::table_for(Index width) const {
    if (by_sums_.terms == 0 || options.path == SolvePath::direct) return bin_by_bin_;
    if (options.path == SolvePath::sums) return by_sums_;
    return width + 1 > by_sums_.head + 2 ? by_sums_ : bin_by_bin_;  // by measurement
}

SolveReport SolverWork::report_of(SolvePath path, const CrushTable& table) const {
    SolveReport report;
    report.path = path;
    report.head = table.head;
    if (table.terms == 0) return report;
    report.terms = static_cast<Index>(sum_.coefficient.size());
    report.fit_error = sum_.error;
    return report;
}

void SolverWork::blend(const ZonePair& zones, Task& task) {
    scratch_.resize(task.out == nullptr ? grid.bins() * grid.bins() : 0);
    const MatrixView<double> to =
        task.out != nullptr ? *task.out : MatrixView<double>(scratch_.data(), grid.bins(), grid.bins());
    blend_.run(zones.before(), zones.after(), task.state, *task.arrivals, to);
    if (task.grading != nullptr) *task.grading = row_sums(to);
    task.report = {};
    task.report.path = SolvePath::blend;
    task.report.crushed = blend_.crushed();
    task.report.crushed_neighbour = blend_.crushed_neighbour();
}

void SolverWork::settle_alone(const ZonePair& zones, Task& task) {
    if (options.loading_rate > 0.0) {
        blend(zones, task);
        return;
    }
    const CrushTable& by = table_for(zones.width());
    sweep_.run(by, zones.before(), zones.after(), task.state, *task.arrivals, task.out);
    if (task.out != nullptr) sweep_.far_field(task.state, *task.arrivals, *task.out);
    if (task.grading != nullptr) move_marginal(by, *task.arrivals, sweep_.crushed_rows(), *task.grading);
    task.report = report_of(by.terms > 0 ? SolvePath::sums : SolvePath::direct, by);
    task.report.crushed = sweep_.crushed() / leaves_;
    task.report.crushed_neighbour = sweep_.crushed_neighbour() / leaves_;
}

void SolverWork::settle_narrow(VectorView<Task*> tasks, VectorView<Problem> problems) {
    if (problems.size() == 0) return;
    const CrushTable& by = by_sums_.terms > 0 ? by_sums_ : bin_by_bin_;
    narrow_.run(by, problems);
    for (Index p = 0; p < problems.size(); ++p) {
        SolveReport& report = tasks[p]->report;
        report = report_of(SolvePath::narrow, by);
        report.crushed = problems[p].crushed / leaves_;
        report.crushed_neighbour = problems[p].crushed_neighbour / leaves_;
    }
}

void SolverWork::settle(VectorView<Task> tasks) {
    const bool any_narrow = options.loading_rate == 0.0 && options.path == SolvePath::automatic;
    std::array<Problem, lanes> problems;
    std::array<Task*, lanes> of;
    Index count = 0;
    const auto sweep_together = [&] {
        settle_narrow({of.data(), count}, {problems.data(), count});
        count = 0;
    };
    for (Task& task : tasks) {
        const ZonePair& zones = zones_of(task.loads, {problems.data(), count});
        if (any_narrow && zones.narrow()) {
            at(of, count) = &task;
            at(problems, count++) = {&zones, task.state, task.arrivals, task.out, task.grading};
            if (count == lanes) sweep_together();
        } else {
            settle_alone(zones, task);
        }
    }
    sweep_together();
}

void SolverWork::require_masses(MatrixView<const double> state, const Loads& loads) {
    ZonePair& zones = zones_of(loads, {nullptr, 0});
    if (const auto bad = first_bad_mass(state, zones.after(), zones.extent())) {
        const auto [i, j] = *bad;
        throw ParameterError(mass_fault(state(i, j), "state", {i, j}, true));
    }
}

void require_finite_sum(const SolveReport& report) {
    if (std::isfinite(report.crushed + report.crushed_neighbour)) return;
    throw ParameterError({.parameter = "state",
                          .finding = "adds up to more than a number can hold",
                          .rule = "it must be scaled to a total of 1"});
}

}  // namespace comminute::detail
