// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/quasi_static.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "fabric/fabric_access.hpp"
#include "sweeping/blend_sweep.hpp"
#include "sweeping/point_sweep.hpp"

namespace comminute {

using namespace detail;

namespace {

std::vector<double> row_sums(MatrixView<const double> state) {
    std::vector<double> sums(static_cast<std::size_t>(state.rows()));
    for (Index i = 0; i < state.rows(); ++i) {
        sums[static_cast<std::size_t>(i)] = ConstLine(state.row(i), state.cols()).sum();
    }
    return sums;
}

// Takes the crushed mass out of each bin of a marginal and adds it where its fragments lie: one line of the sweep.
void move_fragments(const CrushTable& table, const std::vector<double>& crushed,
                    std::vector<double>& marginal) {
    for (std::size_t i = 0; i < marginal.size(); ++i) marginal[0] += crushed[i] * table.below[i];
    const Index bins = table.bins;
    Eigen::ArrayXd sums = Eigen::ArrayXd::Zero(table.terms);
    Index shell = 0;  // of a block
    for (Index i = bins - 1; i >= 1; --i, ++shell) {
        double landed = 0.0;
        for (Index m = std::min(table.head, bins - 1 - i); m >= 1; --m) {
            landed += table.mass[static_cast<std::size_t>(m)] * crushed[static_cast<std::size_t>(i + m)];
        }
        if (table.terms > 0) {
            if (shell == table.shells_a_block) {
                sums *= ConstLine(table.block_decay.data(), table.terms);
                sums = (sums.abs() > 1e-290).select(sums, 0.0);
                shell = 0;
            }
            const Index entering = i + table.head + 1;
            if (entering < bins) {
                sums += crushed[static_cast<std::size_t>(entering)] *
                        ConstLine(table.entering_at(shell), table.terms);
            }
            landed += (sums * ConstLine(table.falling_at(shell), table.terms)).sum();
        }
        // Where all of a bin crushes the difference is nothing, and what is below 0 is rounding.
        double& mass = marginal[static_cast<std::size_t>(i)];
        mass = std::max(mass + landed - crushed[static_cast<std::size_t>(i)], 0.0);
    }
}

std::string span_text(const LogGrid& grid) {
    return "from " + text(grid.psi_min()) + " to " + text(grid.psi_max()) + " in " +
           std::to_string(grid.bins()) + " bins";
}

}  // namespace

struct QuasiStatic::Work {
    LogGrid grid;
    Material material;
    Scheme scheme;
    double rate;
    SolvePath path;
    FragmentPmf fragments;
    ExponentialSum sum;
    double leaves;  // 1 - f_0, the share of one crush that leaves the bin
    CrushTable bin_by_bin;
    CrushTable by_sums;
    ActiveBand before;
    ActiveBand after;
    double load_before = 0.0;  // of the zones at hand
    double load_after = 0.0;
    BandSweep sweep;
    BlendSweep blend;
    PointSweep points;
    std::vector<double> scratch;  // a state that nobody asked for

    Work(const LogGrid& g, const Material& m, Scheme s, double loading_rate, SolvePath p)
        : grid(g),
          material(m),
          scheme(s),
          rate(loading_rate),
          path(p),
          fragments(fragment_pmf(m.fragments, g.spacing(), g.bins(), rule())),
          sum(exponential_sum(m.fragments, g.spacing(), fragments, rule())),
          leaves(fragments.below[1]),
          bin_by_bin(CrushTable::make(fragments, {}, leaves)),
          by_sums(CrushTable::make(fragments, sum, leaves)),
          before(g, m, s),
          after(g, m, s),
          sweep(g.bins()),
          blend(fragments, loading_rate),
          points(g, m, fragments, loading_rate) {}

    FragmentRule rule() const {
        return scheme == Scheme::paper ? FragmentRule::paper : FragmentRule::conservative;
    }

    // A zone costs as much as a small sweep, so what is at hand stays: the same loads for many states, or, where a state
    // goes on from the load before, the zone that it settled in.
    void set_loads(std::optional<double> settled_at, double stress_ratio) {
        const double settled = settled_at.value_or(0.0);
        if (settled != load_before) {
            if (settled == load_after) {
                std::swap(before, after);
                std::swap(load_before, load_after);
            } else {
                before.set_load(load_before = settled);
            }
        }
        if (stress_ratio != load_after) after.set_load(load_after = stress_ratio);
    }

    const CrushTable& table() const {
        if (by_sums.terms == 0 || path == SolvePath::direct) return bin_by_bin;
        if (path == SolvePath::sums) return by_sums;
        Index widest = 0;
        for (Index m = 0; m < grid.bins(); ++m) widest = std::max(widest, after.last(m) + 1);
        return widest > by_sums.head + 2 ? by_sums : bin_by_bin;  // by measurement
    }

    /// Refuses a state whose crushed mass, a sum over the zone, is not finite, by the entry that makes it so.
    void require_finite_sum(MatrixView<const double> state, double crushed) const {
        if (std::isfinite(crushed)) return;
        for (Index i = 0; i < grid.bins(); ++i) {
            for (Index j = 0; j < grid.bins(); ++j) {
                if (std::abs(i - j) <= after.last(std::max(i, j)))
                    require_finite(state(i, j), "state", {i, j});
            }
        }
        throw ParameterError({.parameter = "state",
                              .finding = "adds up to more than a number can hold",
                              .rule = "it must be scaled to a total of 1"});
    }

    /// Brings the bins to rest. `rows`, where it is wanted, is their marginal before and after.
    SolveReport settle(MatrixView<const double> state, const std::vector<OuterProduct>& arrivals,
                       std::vector<double>* rows, MatrixView<double>* out) {
        SolveReport report;
        if (rate > 0.0) {
            scratch.resize(out == nullptr ? static_cast<std::size_t>(grid.bins() * grid.bins()) : 0);
            const MatrixView<double> to =
                out != nullptr ? *out : MatrixView<double>(scratch.data(), grid.bins(), grid.bins());
            blend.run(before, after, state, arrivals, to);
            require_finite_sum(state, blend.crushed() + blend.crushed_neighbour());
            if (rows != nullptr) *rows = row_sums(to);
            report.path = SolvePath::blend;
            report.crushed = blend.crushed();
            report.crushed_neighbour = blend.crushed_neighbour();
            return report;
        }
        const CrushTable& by = table();
        sweep.run(by, before, after, state, arrivals, out);
        require_finite_sum(state, sweep.crushed() + sweep.crushed_neighbour());
        if (out != nullptr) sweep.far_field(by, state, arrivals, *out);
        if (rows != nullptr) move_marginal(by, arrivals, *rows);
        report.path = by.terms > 0 ? SolvePath::sums : SolvePath::direct;
        report.terms = by.terms > 0 ? static_cast<Index>(sum.coefficient.size()) : 0;
        report.head = by.head;
        report.fit_error = by.terms > 0 ? sum.error : 0.0;
        report.crushed = sweep.crushed() / leaves;
        report.crushed_neighbour = sweep.crushed_neighbour() / leaves;
        return report;
    }

    void move_marginal(const CrushTable& by, const std::vector<OuterProduct>& arrivals,
                       std::vector<double>& rows) const {
        for (const OuterProduct& from : arrivals) {
            const double partners = std::accumulate(from.psibar.begin(), from.psibar.end(), 0.0);
            for (std::size_t i = 0; i < rows.size(); ++i) rows[i] += from.psi[i] * partners;
        }
        move_fragments(by, sweep.crushed_rows(), rows);
    }

    /// Everything but the numbers of the bins, which go to `out` where that is given.
    FabricAccess::Data settle(const Fabric& state, double stress_ratio, MatrixView<double>* out,
                              SolveReport& report) {
        set_loads(state.settled_at(), stress_ratio);
        points.run(state, stress_ratio);
        std::vector<double> rows = FabricAccess::rows(state);
        report = settle(state.probability(), points.arrivals(), &rows, out);
        report.crushed += points.crushed();
        report.crushed_neighbour += points.crushed_neighbour();

        FabricAccess::Data data{
            grid, {}, points.atoms(), points.ridges(), stress_ratio, state.mean(), rows, rows, {}, {}};
        for (const Ridge& ridge : data.ridges) {
            if (ridge.exact != Axis::neighbour) continue;
            Line(data.spread.data(), grid.bins()) += ConstLine(ridge.mass.data(), grid.bins());
        }
        data.points = exact_sizes(data.atoms, data.ridges);
        data.grainsize = with_points(grid, data.spread, data.points);
        return data;
    }

    Fabric known(const Fabric& state) const {
        if (state.grid() != grid) {
            throw ParameterError({.parameter = "state",
                                  .subject = "the fabric's grid",
                                  .finding = "runs " + span_text(state.grid()),
                                  .rule = "the solver's runs " + span_text(grid),
                                  .remedy = Remedy::use_same_grid});
        }
        return scheme == Scheme::paper ? state.binned() : state;
    }

    std::vector<double> new_state() const {
        return std::vector<double>(static_cast<std::size_t>(grid.bins() * grid.bins()));
    }
};

QuasiStatic::QuasiStatic(const LogGrid& grid, const Material& material, Scheme scheme, double loading_rate,
                         SolvePath path) {
    material.validate();
    require(loading_rate >= 0.0 && loading_rate <= 1.0, "loading_rate", loading_rate, "between 0 and 1");
    if (path == SolvePath::blend || path == SolvePath::none) {
        throw ParameterError({.parameter = "path",
                              .value = path == SolvePath::blend ? "blend" : "none",
                              .rule = "a solve only reports that; it must be automatic, direct or sums"});
    }
    work_ = std::make_unique<Work>(grid, material, scheme, loading_rate, path);
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
    return work_->material;
}
Scheme QuasiStatic::scheme() const {
    return work_->scheme;
}
double QuasiStatic::loading_rate() const {
    return work_->rate;
}
SolvePath QuasiStatic::path() const {
    return work_->path;
}

Fabric QuasiStatic::solve(const Fabric& given, double stress_ratio, SolveReport* report) {
    require_stress_ratio(stress_ratio);
    Fabric state = work_->known(given);
    SolveReport own;
    SolveReport& said = report != nullptr ? *report : own;
    said = {};
    if (state.settled_at() && stress_ratio <= *state.settled_at()) return state;
    std::vector<double> probability = work_->new_state();
    MatrixView<double> out(probability.data(), grid().bins(), grid().bins());
    FabricAccess::Data data = work_->settle(state, stress_ratio, &out, said);
    data.probability = std::move(probability);
    return FabricAccess::make(std::move(data));
}

Marginal QuasiStatic::marginal(const Fabric& given, double stress_ratio) {
    require_stress_ratio(stress_ratio);
    const Fabric state = work_->known(given);
    Marginal marginal;
    if (state.settled_at() && stress_ratio <= *state.settled_at()) {
        marginal.grainsize.assign(state.grainsize().begin(), state.grainsize().end());
        marginal.points = state.points();
        return marginal;
    }
    FabricAccess::Data data = work_->settle(state, stress_ratio, nullptr, marginal.report);
    marginal.grainsize = std::move(data.grainsize);
    marginal.points = std::move(data.points);
    return marginal;
}

SolveReport QuasiStatic::solve(MatrixView<const double> state, double stress_ratio,
                               std::optional<double> settled_at, MatrixView<double> out) {
    require_square(state, grid().bins(), "state");
    require_square(out, grid().bins(), "out");
    require_same_or_apart(state, out);
    require_stress_ratio(stress_ratio);
    if (settled_at) require_stress_ratio(*settled_at);
    if (settled_at && stress_ratio <= *settled_at) {
        for (Index i = 0; i < grid().bins() && out.data() != state.data(); ++i) {
            std::copy_n(state.row(i), grid().bins(), out.row(i));
        }
        return {};
    }
    work_->set_loads(settled_at, stress_ratio);
    return work_->settle(state, {}, nullptr, &out);
}

SolveReport QuasiStatic::marginal(MatrixView<const double> state, double stress_ratio,
                                  std::optional<double> settled_at, VectorView<double> grainsize) {
    require_square(state, grid().bins(), "state");
    require_stress_ratio(stress_ratio);
    if (settled_at) require_stress_ratio(*settled_at);
    require_bins(grainsize.size(), grid().bins(), entry("grainsize"));
    std::vector<double> rows = row_sums(state);
    SolveReport report;
    if (!settled_at || stress_ratio > *settled_at) {
        work_->set_loads(settled_at, stress_ratio);
        report = work_->settle(state, {}, &rows, nullptr);
    }
    std::copy(rows.begin(), rows.end(), grainsize.begin());
    return report;
}

}  // namespace comminute
