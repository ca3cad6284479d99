// SPDX-License-Identifier: BSD-3-Clause
// One step of the slow rule, cell by cell where few cells hold mass (docs/theory/one_sweep.md, section 13).
#include "comminute/slow_update.hpp"

#include <algorithm>
#include <cmath>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "stepping/sum_step.hpp"
#include "zones/zone_runs.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr Index lifted_at_once = 1 << 15;  // masses, 256 KiB

}  // namespace

struct SlowUpdate::Work {
    SlowUpdateOptions options;
    Kernel kernel;
    ZoneRuns runs;
    SumStep by_sums;
    Array<double> fragments_reversed;

    /// The run of cells in one arm of a shell, from the first with mass to the last.
    struct Run {
        Index begin = 0;
        Index end = 0;
        Index length() const { return end - begin; }
    };
    /// A run taken out of row `shell`, waiting to be spread up its columns.
    struct Lifted {
        Index shell;
        Index begin;
        Index end;
        Index mass;  // where its masses start in lifted_mass
    };
    Array<Run> in_row;     // cells (m, j < m): psi crushes
    Array<Run> in_column;  // cells (i < m, m): psibar crushes
    Array<Lifted> lifted;
    Index lifted_runs = 0;
    Array<double> lifted_mass;
    Index lifted_cells = 0;
    StepReport report;

    Work(const LogGrid& grid, const Material& material, const SlowUpdateOptions& o)
        : options(o),
          kernel(grid, material, {KernelKind::slow, 0.0, o.scheme}),
          runs(grid, material),
          by_sums(kernel),
          fragments_reversed({kernel.fragments().mass.rbegin(), kernel.fragments().mass.rend()}),
          in_row(grid.bins()),
          in_column(grid.bins()),
          lifted(grid.bins()),
          lifted_mass(std::max(grid.bins(), lifted_at_once)) {}

    const CrushZones& zones() const { return runs.zones(); }
    const double* fragments() const { return kernel.fragments().mass.data(); }
    /// Share of a crush in bin m that lands in the fines bin.
    double to_fines(Index m) const { return at(kernel.fragments().below, m); }
    /// f_{m - c} for the bins c = 1 .. m - 1 of a line.
    ConstLine onto_line(Index m) const {
        return {fragments_reversed.data() + kernel.grid().bins() - m, m - 1};
    }

    void look(MatrixView<const double> p);
    bool sums_cost_less() const;
    void spread_along_rows(Index m, MatrixView<double> p);
    void lift_row(Index m, MatrixView<double> p);
    void spread_along_columns(MatrixView<double> p);
    void push(MatrixView<const double> p, MatrixView<double> out);
};

// Finds the active mass, and refuses what is not a number before anything has moved.
void SlowUpdate::Work::look(MatrixView<const double> p) {
    for (Index m = 1; m < p.rows(); ++m) {
        Run row{m, m};
        Run column{m, m};
        const Index first = m - zones().band(m);
        for (Index j = first; j < m; ++j) {
            const double by_psi = p(m, j);
            const double by_psibar = p(j, m);
            if (by_psi != 0.0) {
                require_finite(by_psi, "p", {m, j});
                if (row.begin == m) row.begin = j;
                row.end = j + 1;
                report.crushed += by_psi;
            }
            if (by_psibar != 0.0) {
                require_finite(by_psibar, "p", {j, m});
                if (column.begin == m) column.begin = j;
                column.end = j + 1;
                report.crushed_neighbour += by_psibar;
            }
        }
        if (first <= m) {
            require_finite(p(m, m), "p", {m, m});
            report.crushed += 0.5 * p(m, m);
            report.crushed_neighbour += 0.5 * p(m, m);
        }
        in_row[m] = row;
        in_column[m] = column;
    }
    report.active = report.crushed + report.crushed_neighbour;
}

// Tells whether cells by themselves, O(N) for each, cost more than K sums along all lines; by measurement a number of the one
// takes as long as five of the other.
bool SlowUpdate::Work::sums_cost_less() const {
    if (!by_sums.available()) return false;
    const auto bins = static_cast<double>(in_row.size());
    double pushes = 0.0;
    for (Index m = 0; m < in_row.size(); ++m) {
        pushes +=
            static_cast<double>(m) * static_cast<double>(in_row[m].length() + in_column[m].length() + 2);
    }
    return pushes > 0.2 * static_cast<double>(by_sums.terms()) * bins * bins;
}

// Mass that crushes in psibar lands in its own row, which lies in memory as it is spread: done at once.
void SlowUpdate::Work::spread_along_rows(Index m, MatrixView<double> p) {
    const double f0 = fragments()[0];
    for (Index i = in_column[m].begin; i < in_column[m].end; ++i) {
        const double mass = p(i, m);
        if (mass == 0.0) continue;
        p(i, m) = f0 * mass;
        Line(p.row(i) + 1, m - 1) += mass * onto_line(m);
        p(i, 0) += mass * to_fines(m);
    }
}

// Mass that crushes in psi is taken out of row m, the diagonal cell with half its mass; the other half goes along the row.
void SlowUpdate::Work::lift_row(Index m, MatrixView<double> p) {
    const double f0 = fragments()[0];
    const double on_diagonal = zones().band(m) < 0 ? 0.0 : p(m, m);
    Run run = in_row[m];
    if (on_diagonal != 0.0) run = {run.end > run.begin ? run.begin : m, m + 1};
    if (run.end == run.begin) return;

    lifted[lifted_runs++] = {m, run.begin, run.end, lifted_cells};
    std::copy(p.row(m) + run.begin, p.row(m) + run.end, lifted_mass.begin() + lifted_cells);
    lifted_cells += run.end - run.begin;
    for (Index j = run.begin; j < run.end; ++j) p(m, j) *= f0;
    if (on_diagonal == 0.0) return;
    const double half = 0.5 * on_diagonal;
    lifted_mass[lifted_cells - 1] = half;
    Line(p.row(m) + 1, m - 1) += half * onto_line(m);
    p(m, 0) += half * to_fines(m);
}

// Row after row of targets, so that the state is walked in the order it lies in memory, once for all lifted runs.
void SlowUpdate::Work::spread_along_columns(MatrixView<double> p) {
    const Lifted* first = lifted.data();
    const Lifted* const end = first + lifted_runs;
    for (Index r = 0; first != end; ++r) {
        while (first != end && first->shell <= r) ++first;
        double* row = p.row(r);
        for (const Lifted* run = first; run != end; ++run) {
            const double share = r == 0 ? to_fines(run->shell) : fragments()[run->shell - r];
            const double* mass = lifted_mass.data() + run->mass;
            for (Index j = run->begin; j < run->end; ++j) row[j] += share * mass[j - run->begin];
        }
    }
    lifted_runs = 0;
    lifted_cells = 0;
}

void SlowUpdate::Work::push(MatrixView<const double> p, MatrixView<double> out) {
    const Index bins = kernel.grid().bins();
    if (out.data() != p.data()) {
        for (Index i = 0; i < bins; ++i) std::copy_n(p.row(i), bins, out.row(i));
    }
    // Fragments of a shell's arms land in lower shells, those of its diagonal cell in its own arms. With the shells in
    // ascending order, and a shell's arms taken out before anything lands in them, nothing is spread twice.
    for (Index m = 1; m < bins; ++m) {
        if (lifted_cells + m + 1 > lifted_mass.size()) spread_along_columns(out);
        spread_along_rows(m, out);
        lift_row(m, out);
    }
    spread_along_columns(out);
}

SlowUpdate::SlowUpdate(const LogGrid& grid, const Material& material, const SlowUpdateOptions& options)
    : work_(std::make_unique<Work>(grid, material, options)) {}
SlowUpdate::~SlowUpdate() = default;
SlowUpdate::SlowUpdate(const SlowUpdate& other) : work_(std::make_unique<Work>(*other.work_)) {}
SlowUpdate& SlowUpdate::operator=(const SlowUpdate& other) {
    work_ = std::make_unique<Work>(*other.work_);  // this one may have been moved from
    return *this;
}
SlowUpdate::SlowUpdate(SlowUpdate&&) noexcept = default;
SlowUpdate& SlowUpdate::operator=(SlowUpdate&&) noexcept = default;

const LogGrid& SlowUpdate::grid() const {
    return kernel().grid();
}
const Material& SlowUpdate::material() const {
    return kernel().material();
}
const SlowUpdateOptions& SlowUpdate::options() const {
    return work_->options;
}
const Kernel& SlowUpdate::kernel() const {
    return work_->kernel;
}

StepReport SlowUpdate::step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out) {
    const Index bins = grid().bins();
    require_square(p, bins, "p");
    require_square(out, bins, "out");
    require_same_or_apart(p, out);
    work_->runs.set_load(stress_ratio);
    work_->report = {};
    work_->report.steps = 1;
    work_->look(p);
    if (work_->sums_cost_less()) return work_->by_sums.run(p, work_->kernel, work_->runs, out);
    work_->push(p, out);
    return work_->report;
}

}  // namespace comminute
