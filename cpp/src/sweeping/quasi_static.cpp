// SPDX-License-Identifier: BSD-3-Clause
// The quasi-static solver of fabrics and bare arrays (docs/theory/one_sweep.md, section 2).
#include "comminute/quasi_static.hpp"

#include <algorithm>
#include <array>
#include <deque>
#include <utility>

#include "base/check.hpp"
#include "base/double_double.hpp"
#include "fabric/fabric_access.hpp"
#include "sweeping/marginal.hpp"
#include "sweeping/solver_work.hpp"

namespace comminute {

using namespace detail;

namespace {

std::string span_text(const LogGrid& grid) {
    return "from " + text(grid.psi_min()) + " to " + text(grid.psi_max()) + " in " +
           std::to_string(grid.bins()) + " bins";
}

/// Fabric on its way to rest under a load: its points are there already, and its bins are a task of the solver.
class FabricTask {
  public:
    FabricTask(SolverWork& work, const Fabric& state, double stress_ratio, MatrixView<double>* out)
        : points_(run(work.points(), state, stress_ratio)),
          arrivals_(work.points().arrivals()),
          crushed_(work.points().crushed()),
          crushed_neighbour_(work.points().crushed_neighbour()),
          rows_(state.parts().rows),
          task_{{state.settled_at().value_or(0.0), stress_ratio, state.largest()},
                state.probability(),
                &arrivals_,
                &rows_,
                out,
                {}} {}
    FabricTask(const FabricTask&) = delete;  // the task points into it
    FabricTask& operator=(const FabricTask&) = delete;

    Task& task() { return task_; }

    /// Gives all data of the fabric after but its bins, once the task is done.
    FabricParts parts(const Fabric& state, SolveReport& report) {
        require_finite_sum(task_.report);
        report = task_.report;
        report.crushed += crushed_;
        report.crushed_neighbour += crushed_neighbour_;
        FabricParts parts{state.grid(),
                          {},
                          std::move(points_.first),
                          std::move(points_.second),
                          task_.loads.stress_ratio,
                          state.mean(),
                          rows_,
                          std::move(rows_),
                          {},
                          state.largest()};
        for (const Ridge& ridge : parts.ridges) {
            if (ridge.exact != Axis::neighbour) continue;
            Line(parts.spread.data(), state.grid().bins()) +=
                ConstLine(ridge.mass.data(), state.grid().bins());
        }
        parts.points = with_sizes(exact_sizes(parts.atoms, parts.ridges), state.points());
        return parts;
    }

  private:
    using Points = std::pair<std::vector<Atom>, std::vector<Ridge>>;
    static Points run(PointSweep& points, const Fabric& state, double stress_ratio) {
        points.run(state, stress_ratio);
        return {points.atoms(), points.ridges()};
    }

    Points points_;
    Arrivals arrivals_;
    double crushed_;
    double crushed_neighbour_;
    std::vector<double> rows_;
    Task task_;
};

/// The state as the solver's scheme takes it. Refuses one on another grid.
Fabric known(const SolverWork& work, const Fabric& state) {
    if (state.grid() != work.grid) {
        throw ParameterError({.parameter = "state",
                              .subject = "the fabric's grid",
                              .finding = "runs " + span_text(state.grid()),
                              .rule = "the solver's runs " + span_text(work.grid),
                              .remedy = Remedy::use_same_grid});
    }
    return work.options.scheme == Scheme::paper ? state.binned() : state;
}

Marginal unchanged(const Fabric& state) {
    return {{state.grainsize().begin(), state.grainsize().end()}, state.points(), {}};
}

void require_loads(double stress_ratio, std::optional<double> settled_at, double largest) {
    require_stress_ratio(stress_ratio);
    if (settled_at) require_stress_ratio(*settled_at);
    require_largest(largest);
}

SolveReport settle_array(SolverWork& work, const Loads& loads, MatrixView<const double> state,
                         std::vector<double>* rows, MatrixView<double>* out) {
    work.require_masses(state, loads);
    const Arrivals none;
    Task task{loads, state, &none, rows, out, {}};
    work.settle({&task, 1});
    require_finite_sum(task.report);
    return task.report;
}

bool at_rest(const Fabric& state, double stress_ratio) {
    return state.settled_at() && stress_ratio <= *state.settled_at();
}

Marginal marginal_of(FabricTask& done, const Fabric& state) {
    Marginal marginal;
    FabricParts parts = done.parts(state, marginal.report);
    marginal.grainsize = with_points(state.grid(), std::move(parts.spread), parts.points);
    marginal.points = std::move(parts.points);
    return marginal;
}

}  // namespace

double Marginal::mass_error() const {
    std::array<DoubleDouble, 4> totals{};  // side by side, since each addition waits for the one before
    for (std::size_t i = 0; i < grainsize.size(); ++i) totals[i % 4] = totals[i % 4] + grainsize[i];
    return ((totals[0] + totals[1]) + (totals[2] + totals[3])).high - 1.0;
}

QuasiStatic::QuasiStatic(const LogGrid& grid, const Material& material, const QuasiStaticOptions& options) {
    const double loading_rate = options.loading_rate;
    const SolvePath path = options.path;
    material.validate();
    require(loading_rate >= 0.0 && loading_rate <= 1.0, "loading_rate", loading_rate, "between 0 and 1");
    if (path == SolvePath::blend || path == SolvePath::narrow || path == SolvePath::none) {
        const char* const words[] = {"blend", "narrow", "none"};
        throw ParameterError({.parameter = "path",
                              .value = words[static_cast<int>(path) - static_cast<int>(SolvePath::blend)],
                              .rule = "a solve only reports that; it must be automatic, direct or sums"});
    }
    work_ = std::make_unique<Work>(grid, material, options);
}

QuasiStatic::~QuasiStatic() = default;
QuasiStatic::QuasiStatic(const QuasiStatic& other) : work_(std::make_unique<Work>(*other.work_)) {}
QuasiStatic& QuasiStatic::operator=(const QuasiStatic& other) {
    work_ = std::make_unique<Work>(*other.work_);  // this one may have been moved from
    return *this;
}
QuasiStatic::QuasiStatic(QuasiStatic&&) noexcept = default;
QuasiStatic& QuasiStatic::operator=(QuasiStatic&&) noexcept = default;

const LogGrid& QuasiStatic::grid() const {
    return work_->grid;
}
const Material& QuasiStatic::material() const {
    return work_->material();
}
void QuasiStatic::set_material(const Material& material) {
    material.validate();
    work_->set_material(material);
}
const QuasiStaticOptions& QuasiStatic::options() const {
    return work_->options;
}

Fabric QuasiStatic::solve(const Fabric& given, double stress_ratio, SolveReport* report) {
    require_stress_ratio(stress_ratio);
    Fabric state = known(*work_, given);
    SolveReport own;
    SolveReport& said = report != nullptr ? *report : own;
    said = {};
    if (at_rest(state, stress_ratio)) return state;
    std::vector<double> probability = Array<double>(grid().bins() * grid().bins()).vector();
    MatrixView<double> out(probability.data(), grid().bins(), grid().bins());
    FabricTask fabric(*work_, state, stress_ratio, &out);
    work_->settle({&fabric.task(), 1});
    FabricParts parts = fabric.parts(state, said);
    parts.probability = std::move(probability);
    return FabricAccess::make(std::move(parts));
}

Marginal QuasiStatic::marginal(const Fabric& given, double stress_ratio) {
    return std::move(marginals(given, {&stress_ratio, 1}).front());
}

std::vector<Marginal> QuasiStatic::marginals(const Fabric& given, VectorView<const double> stress_ratios) {
    for (const double stress_ratio : stress_ratios) require_stress_ratio(stress_ratio);
    const Fabric state = known(*work_, given);
    std::vector<Marginal> found;
    for (Index begin = 0; begin < stress_ratios.size(); begin += lanes) {
        const Index end = std::min(begin + lanes, stress_ratios.size());
        std::deque<FabricTask> fabrics;
        std::vector<Task> tasks;
        for (Index k = begin; k < end; ++k) {
            if (at_rest(state, stress_ratios[k])) continue;
            tasks.push_back(fabrics.emplace_back(*work_, state, stress_ratios[k], nullptr).task());
        }
        work_->settle(tasks);
        std::size_t next = 0;
        for (Index k = begin; k < end; ++k) {
            if (at_rest(state, stress_ratios[k])) {
                found.push_back(unchanged(state));
                continue;
            }
            fabrics[next].task().report = tasks[next].report;
            found.push_back(marginal_of(fabrics[next], state));
            ++next;
        }
    }
    return found;
}

SolveReport QuasiStatic::solve(MatrixView<const double> state, double stress_ratio,
                               std::optional<double> settled_at, MatrixView<double> out, double largest) {
    require_square(state, grid().bins(), "state");
    require_square(out, grid().bins(), "out");
    require_same_or_apart(state, out);
    require_loads(stress_ratio, settled_at, largest);
    if (settled_at && stress_ratio <= *settled_at) {
        for (Index i = 0; i < grid().bins() && out.data() != state.data(); ++i) {
            std::copy_n(state.row(i), grid().bins(), out.row(i));
        }
        return {};
    }
    return settle_array(*work_, {settled_at.value_or(0.0), stress_ratio, largest}, state, nullptr, &out);
}

SolveReport QuasiStatic::marginal(MatrixView<const double> state, double stress_ratio,
                                  std::optional<double> settled_at, VectorView<double> grainsize,
                                  double largest) {
    require_square(state, grid().bins(), "state");
    require_loads(stress_ratio, settled_at, largest);
    require_bins(grainsize.size(), grid().bins(), entry("grainsize"));
    std::vector<double> rows = row_sums(state);
    SolveReport report;
    if (!settled_at || stress_ratio > *settled_at) {
        report =
            settle_array(*work_, {settled_at.value_or(0.0), stress_ratio, largest}, state, &rows, nullptr);
    }
    std::copy(rows.begin(), rows.end(), grainsize.begin());
    return report;
}

}  // namespace comminute
