// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/slow_update.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "check.hpp"

namespace comminute {
namespace {

using Line = Eigen::Map<Eigen::ArrayXd>;
using ConstLine = Eigen::Map<const Eigen::ArrayXd>;

constexpr Index lifted_at_once = 1 << 15;  // masses, 256 KiB

void require_finite(double mass, Index i, Index j) {
    if (std::isfinite(mass)) return;
    throw ParameterError("p[" + std::to_string(i) + ", " + std::to_string(j) + "] is " + text(mass) +
                         "; every entry inside the crush zone must be finite");
}

}  // namespace

SlowUpdate::SlowUpdate(const LogGrid& grid, const Material& material, FragmentRule rule)
    : kernel_(grid, material, KernelKind::slow, 0.0, rule),
      zones_(grid, material, 0.0),
      fragments_reversed_(kernel_.fragments().mass.rbegin(), kernel_.fragments().mass.rend()),
      in_row_(static_cast<std::size_t>(grid.bins())),
      in_column_(static_cast<std::size_t>(grid.bins())) {
    lifted_.resize(static_cast<std::size_t>(grid.bins()));
    lifted_mass_.resize(static_cast<std::size_t>(std::max(grid.bins(), lifted_at_once)));
}

// Finds the active mass, and refuses what is not a number before anything has moved.
void SlowUpdate::look(MatrixView<const double> p) {
    for (Index m = 1; m < p.rows(); ++m) {
        Run row{m, m};
        Run column{m, m};
        const Index first = m - zones_.band(m);
        for (Index j = first; j < m; ++j) {
            const double in_row = p(m, j);
            const double in_column = p(j, m);
            if (in_row != 0.0) {
                require_finite(in_row, m, j);
                if (row.begin == m) row.begin = j;
                row.end = j + 1;
                report_.crushed += in_row;
            }
            if (in_column != 0.0) {
                require_finite(in_column, j, m);
                if (column.begin == m) column.begin = j;
                column.end = j + 1;
                report_.crushed_neighbour += in_column;
            }
        }
        if (first <= m) {
            require_finite(p(m, m), m, m);
            report_.crushed += 0.5 * p(m, m);
            report_.crushed_neighbour += 0.5 * p(m, m);
        }
        in_row_[static_cast<std::size_t>(m)] = row;
        in_column_[static_cast<std::size_t>(m)] = column;
    }
    report_.active = report_.crushed + report_.crushed_neighbour;
}

// What crushes in psibar lands in its own row, which lies in memory as it is spread: done at once.
void SlowUpdate::spread_along_rows(Index m, MatrixView<double> p) {
    const auto at = static_cast<std::size_t>(m);
    const double f0 = kernel_.fragments().mass[0];
    const double below = kernel_.fragments().below[at];
    // f_{m - c} for c = 1 .. m-1
    const ConstLine onto_line(fragments_reversed_.data() + p.rows() - m, m - 1);
    for (Index i = in_column_[at].begin; i < in_column_[at].end; ++i) {
        const double mass = p(i, m);
        if (mass == 0.0) continue;
        p(i, m) = f0 * mass;
        Line(p.row(i) + 1, m - 1) += mass * onto_line;
        p(i, 0) += mass * below;
    }
}

// What crushes in psi is taken out of row m, the diagonal cell with half its mass; the other half goes along the row.
void SlowUpdate::lift_row(Index m, MatrixView<double> p) {
    const auto at = static_cast<std::size_t>(m);
    const double f0 = kernel_.fragments().mass[0];
    const double on_diagonal = zones_.band(m) < 0 ? 0.0 : p(m, m);
    Run run = in_row_[at];
    if (on_diagonal != 0.0) run = {run.end > run.begin ? run.begin : m, m + 1};
    if (run.end == run.begin) return;

    lifted_[lifted_runs_++] = {m, run.begin, run.end, lifted_cells_};
    std::copy(p.row(m) + run.begin, p.row(m) + run.end, lifted_mass_.begin() + lifted_cells_);
    lifted_cells_ += run.end - run.begin;
    for (Index j = run.begin; j < run.end; ++j) p(m, j) *= f0;
    if (on_diagonal == 0.0) return;
    const double half = 0.5 * on_diagonal;
    lifted_mass_[static_cast<std::size_t>(lifted_cells_ - 1)] = half;
    Line(p.row(m) + 1, m - 1) += half * ConstLine(fragments_reversed_.data() + p.rows() - m, m - 1);
    p(m, 0) += half * kernel_.fragments().below[at];
}

// Row after row of targets, so that the state is walked in the order it lies in memory, once for all lifted runs.
void SlowUpdate::spread_along_columns(MatrixView<double> p) {
    const std::vector<double>& f = kernel_.fragments().mass;
    const std::vector<double>& below = kernel_.fragments().below;
    const Lifted* first = lifted_.data();
    const Lifted* const end = first + lifted_runs_;
    for (Index r = 0; first != end; ++r) {
        while (first != end && first->shell <= r) ++first;
        double* row = p.row(r);
        for (const Lifted* run = first; run != end; ++run) {
            const double share = r == 0 ? below[static_cast<std::size_t>(run->shell)]
                                        : f[static_cast<std::size_t>(run->shell - r)];
            const double* mass = lifted_mass_.data() + run->mass;
            for (Index j = run->begin; j < run->end; ++j) row[j] += share * mass[j - run->begin];
        }
    }
    lifted_runs_ = 0;
    lifted_cells_ = 0;
}

StepReport SlowUpdate::step(MatrixView<const double> p, double stress_ratio, MatrixView<double> out) {
    const Index bins = kernel_.grid().bins();
    require_square(p, bins, "p");
    require_square(out, bins, "out");
    require_same_or_apart(p, out);
    zones_.set_load(stress_ratio);
    report_ = {};
    report_.steps = 1;
    look(p);
    if (out.data() != p.data()) {
        for (Index i = 0; i < bins; ++i) std::copy_n(p.row(i), bins, out.row(i));
    }
    // Fragments of a shell's arms land in lower shells, those of its diagonal cell in its own arms. With the shells in
    // ascending order, and a shell's arms taken out before anything lands in them, nothing is spread twice.
    for (Index m = 1; m < bins; ++m) {
        if (lifted_cells_ + m + 1 > static_cast<Index>(lifted_mass_.size())) {
            spread_along_columns(out);
        }
        spread_along_rows(m, out);
        lift_row(m, out);
    }
    spread_along_columns(out);
    return report_;
}

}  // namespace comminute
