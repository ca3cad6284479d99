// SPDX-License-Identifier: BSD-3-Clause
// The quasi-static solver: zones for its loads, choice of the path, parts of a solve (docs/theory/one_sweep.md,
// section 2).
#include "comminute/quasi_static.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "fabric/fabric_access.hpp"
#include "sweeping/band_sweep.hpp"
#include "sweeping/blend_sweep.hpp"
#include "sweeping/marginal.hpp"
#include "sweeping/mass_check.hpp"
#include "sweeping/point_sweep.hpp"

namespace comminute {

using namespace detail;

namespace {

std::string span_text(const LogGrid& grid) {
    return "from " + text(grid.psi_min()) + " to " + text(grid.psi_max()) + " in " +
           std::to_string(grid.bins()) + " bins";
}

}  // namespace

struct QuasiStatic::Work {
    LogGrid grid;
    Material material;
    QuasiStaticOptions options;
    FragmentPmf fragments;
    ExponentialSum sum;
    double leaves;  // 1 - f_0, share of one crush that leaves its bin
    CrushTable bin_by_bin;
    CrushTable by_sums;
    ActiveBand before;
    ActiveBand after;
    double load_before = 0.0;  // loads of these two bands
    double load_after = 0.0;
    double largest = 0.0;  // size that no grain of their state exceeds
    BandSweep sweep;
    BlendSweep blend;
    PointSweep points;
    Array<double> scratch;  // (N, N) the blend's state after a solve that wants the grading alone

    Work(const LogGrid& g, const Material& m, const QuasiStaticOptions& o)
        : grid(g),
          material(m),
          options(o),
          fragments(fragment_pmf(m.fragments, g.spacing(), g.bins(), o.scheme)),
          sum(exponential_sum(m.fragments, g.spacing(), fragments, o.scheme)),
          leaves(fragments.below[1]),
          bin_by_bin(CrushTable::make(fragments, {}, leaves)),
          by_sums(CrushTable::make(fragments, sum, leaves)),
          before(g, m, o.scheme),
          after(g, m, o.scheme),
          sweep(g.bins()),
          blend(fragments, o.loading_rate),
          points(g, m, fragments, o.loading_rate) {}

    // Zones cost as much as a small sweep, so they are kept from one solve to the next: for many states under the same
    // loads, and for a load path, whose next solve starts in the zone in which the last one ended.
    void set_loads(std::optional<double> settled_at, double stress_ratio, double no_grain_exceeds) {
        const double settled = settled_at.value_or(0.0);
        if (no_grain_exceeds != largest) {
            largest = no_grain_exceeds;
            before.set_load(load_before = settled, largest);
            after.set_load(load_after = stress_ratio, largest);
            return;
        }
        if (settled != load_before) {
            if (settled == load_after) {
                std::swap(before, after);
                std::swap(load_before, load_after);
            } else {
                before.set_load(load_before = settled, largest);
            }
        }
        if (stress_ratio != load_after) after.set_load(load_after = stress_ratio, largest);
    }

    const CrushTable& table() const {
        if (by_sums.terms == 0 || options.path == SolvePath::direct) return bin_by_bin;
        if (options.path == SolvePath::sums) return by_sums;
        Index widest = 0;
        for (Index m = 0; m < grid.bins(); ++m) widest = std::max(widest, after.last(m) + 1);
        return widest > by_sums.head + 2 ? by_sums : bin_by_bin;  // by measurement
    }

    /// Refuses a bare array with an entry in the zone that is no mass; a fabric has none.
    void require_masses(MatrixView<const double> state) const {
        if (const auto bad = first_bad_mass(state, after)) {
            const auto [i, j] = *bad;
            throw ParameterError(mass_fault(state(i, j), "state", {i, j}, true));
        }
    }

    /// Refuses a state whose crushed mass, a sum over the zone, overflows.
    static void require_finite_sum(double crushed) {
        if (std::isfinite(crushed)) return;
        throw ParameterError({.parameter = "state",
                              .finding = "adds up to more than a number can hold",
                              .rule = "it must be scaled to a total of 1"});
    }

    /// Brings the bins to rest.
    /// @param rows  (N) mass by grainsize before, replaced by that after; null where it is not wanted
    /// @param out   (N, N) state after; null where it is not wanted
    SolveReport settle(MatrixView<const double> state, const Arrivals& arrivals, std::vector<double>* rows,
                       MatrixView<double>* out) {
        SolveReport report;
        if (options.loading_rate > 0.0) {
            scratch.resize(out == nullptr ? grid.bins() * grid.bins() : 0);
            const MatrixView<double> to =
                out != nullptr ? *out : MatrixView<double>(scratch.data(), grid.bins(), grid.bins());
            blend.run(before, after, state, arrivals, to);
            require_finite_sum(blend.crushed() + blend.crushed_neighbour());
            if (rows != nullptr) *rows = row_sums(to);
            report.path = SolvePath::blend;
            report.crushed = blend.crushed();
            report.crushed_neighbour = blend.crushed_neighbour();
            return report;
        }
        const CrushTable& by = table();
        sweep.run(by, before, after, state, arrivals, out);
        require_finite_sum(sweep.crushed() + sweep.crushed_neighbour());
        if (out != nullptr) sweep.far_field(state, arrivals, *out);
        if (rows != nullptr) move_marginal(by, arrivals, sweep.crushed_rows(), *rows);
        report.path = by.terms > 0 ? SolvePath::sums : SolvePath::direct;
        report.terms = by.terms > 0 ? static_cast<Index>(sum.coefficient.size()) : 0;
        report.head = by.head;
        report.fit_error = by.terms > 0 ? sum.error : 0.0;
        report.crushed = sweep.crushed() / leaves;
        report.crushed_neighbour = sweep.crushed_neighbour() / leaves;
        return report;
    }

    /// Brings points and bins to rest. Returns all data of the fabric after but its bins, which go to `out`.
    FabricParts settle(const Fabric& state, double stress_ratio, MatrixView<double>* out,
                       SolveReport& report) {
        set_loads(state.settled_at(), stress_ratio, state.largest());
        points.run(state, stress_ratio);
        std::vector<double> rows = state.parts().rows;
        report = settle(state.probability(), points.arrivals(), &rows, out);
        report.crushed += points.crushed();
        report.crushed_neighbour += points.crushed_neighbour();

        FabricParts parts{grid, {}, points.atoms(), points.ridges(), stress_ratio, state.mean(), rows,
                          rows, {}, state.largest()};
        for (const Ridge& ridge : parts.ridges) {
            if (ridge.exact != Axis::neighbour) continue;
            Line(parts.spread.data(), grid.bins()) += ConstLine(ridge.mass.data(), grid.bins());
        }
        parts.points = with_sizes(exact_sizes(parts.atoms, parts.ridges), state.points());
        return parts;
    }

    Fabric known(const Fabric& state) const {
        if (state.grid() != grid) {
            throw ParameterError({.parameter = "state",
                                  .subject = "the fabric's grid",
                                  .finding = "runs " + span_text(state.grid()),
                                  .rule = "the solver's runs " + span_text(grid),
                                  .remedy = Remedy::use_same_grid});
        }
        return options.scheme == Scheme::paper ? state.binned() : state;
    }

    std::vector<double> new_state() const { return Array<double>(grid.bins() * grid.bins()).vector(); }
};

QuasiStatic::QuasiStatic(const LogGrid& grid, const Material& material, const QuasiStaticOptions& options) {
    const double loading_rate = options.loading_rate;
    const SolvePath path = options.path;
    material.validate();
    require(loading_rate >= 0.0 && loading_rate <= 1.0, "loading_rate", loading_rate, "between 0 and 1");
    if (path == SolvePath::blend || path == SolvePath::none) {
        throw ParameterError({.parameter = "path",
                              .value = path == SolvePath::blend ? "blend" : "none",
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
    return work_->material;
}
const QuasiStaticOptions& QuasiStatic::options() const {
    return work_->options;
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
    FabricParts parts = work_->settle(state, stress_ratio, &out, said);
    parts.probability = std::move(probability);
    return FabricAccess::make(std::move(parts));
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
    FabricParts parts = work_->settle(state, stress_ratio, nullptr, marginal.report);
    marginal.grainsize = with_points(grid(), std::move(parts.spread), parts.points);
    marginal.points = std::move(parts.points);
    return marginal;
}

SolveReport QuasiStatic::solve(MatrixView<const double> state, double stress_ratio,
                               std::optional<double> settled_at, MatrixView<double> out, double largest) {
    require_square(state, grid().bins(), "state");
    require_square(out, grid().bins(), "out");
    require_same_or_apart(state, out);
    require_stress_ratio(stress_ratio);
    if (settled_at) require_stress_ratio(*settled_at);
    require_largest(largest);
    if (settled_at && stress_ratio <= *settled_at) {
        for (Index i = 0; i < grid().bins() && out.data() != state.data(); ++i) {
            std::copy_n(state.row(i), grid().bins(), out.row(i));
        }
        return {};
    }
    work_->set_loads(settled_at, stress_ratio, largest);
    work_->require_masses(state);
    return work_->settle(state, {}, nullptr, &out);
}

SolveReport QuasiStatic::marginal(MatrixView<const double> state, double stress_ratio,
                                  std::optional<double> settled_at, VectorView<double> grainsize,
                                  double largest) {
    require_square(state, grid().bins(), "state");
    require_stress_ratio(stress_ratio);
    if (settled_at) require_stress_ratio(*settled_at);
    require_largest(largest);
    require_bins(grainsize.size(), grid().bins(), entry("grainsize"));
    std::vector<double> rows = row_sums(state);
    SolveReport report;
    if (!settled_at || stress_ratio > *settled_at) {
        work_->set_loads(settled_at, stress_ratio, largest);
        work_->require_masses(state);
        report = work_->settle(state, {}, &rows, nullptr);
    }
    std::copy(rows.begin(), rows.end(), grainsize.begin());
    return report;
}

}  // namespace comminute
