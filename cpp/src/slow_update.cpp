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
      in_column_(static_cast<std::size_t>(grid.bins())),
      moving_(static_cast<std::size_t>(grid.bins())) {}

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

// Fragments of a shell's two arms land in shells already done, those of its diagonal cell in its own arms:
// with the shells in ascending order and the diagonal last, nothing that lands is spread again in the same
// step.
void SlowUpdate::spread_shell(Index m, MatrixView<double> p) {
    const auto at = static_cast<std::size_t>(m);
    const std::vector<double>& f = kernel_.fragments().mass;
    const double below = kernel_.fragments().below[at];
    // f_{m - c} for c = 1 .. m-1, so that a line is written in the order it lies in memory
    const ConstLine onto_line(fragments_reversed_.data() + p.rows() - m, m - 1);

    const Run row = in_row_[at];
    if (row.end > row.begin) {
        const Index cells = row.end - row.begin;
        Line moving(moving_.data(), cells);
        Line source(p.row(m) + row.begin, cells);
        moving = source;
        source = f[0] * moving;
        for (Index t = 1; t < m; ++t) {
            Line(p.row(m - t) + row.begin, cells) += f[static_cast<std::size_t>(t)] * moving;
        }
        Line(p.row(0) + row.begin, cells) += below * moving;
    }

    const Run column = in_column_[at];
    for (Index i = column.begin; i < column.end; ++i) {
        const double mass = p(i, m);
        if (mass == 0.0) continue;
        p(i, m) = f[0] * mass;
        Line(p.row(i) + 1, m - 1) += mass * onto_line;
        p(i, 0) += mass * below;
    }

    if (zones_.band(m) < 0 || p(m, m) == 0.0) return;
    const double half = 0.5 * p(m, m);
    p(m, m) = 2.0 * f[0] * half;
    Line(p.row(m) + 1, m - 1) += half * onto_line;
    p(m, 0) += half * below;
    for (Index i = 1; i < m; ++i) p(i, m) += half * f[static_cast<std::size_t>(m - i)];
    p(0, m) += half * below;
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
    for (Index m = 1; m < bins; ++m) spread_shell(m, out);
    return report_;
}

}  // namespace comminute
