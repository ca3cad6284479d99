// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/fabric.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "comminute/material.hpp"
#include "fabric/fabric_access.hpp"

namespace comminute {

using namespace detail;

namespace {

// An exact place inside the grid and above the fines bin, whose grains have no exact size.
void require_resolved(const LogGrid& grid, double psi, const char* list, std::size_t index,
                      const char* field) {
    if (psi >= grid.edge(1) && psi <= grid.edge(grid.bins())) return;
    throw ParameterError({.parameter = field,
                          .value = text(psi),
                          .number = psi,
                          .rule = "it must lie between " + text(grid.edge(1)) + " and " +
                                  text(grid.edge(grid.bins())) + ", inside the grid and above its fines bin",
                          .place = {entry(list, index)}});
}

double checked_total(const LogGrid& grid, const std::vector<Atom>& atoms) {
    double total = 0.0;
    for (std::size_t a = 0; a < atoms.size(); ++a) {
        require_resolved(grid, atoms[a].psi, "atoms", a, "psi");
        require_resolved(grid, atoms[a].psibar, "atoms", a, "psibar");
        if (!is_share(atoms[a].mass)) refuse_share(atoms[a].mass, {entry("atoms", a), entry("mass")});
        total += atoms[a].mass;
    }
    return total;
}

double checked_total(const LogGrid& grid, const std::vector<Ridge>& ridges) {
    double total = 0.0;
    for (std::size_t r = 0; r < ridges.size(); ++r) {
        const Ridge& ridge = ridges[r];
        require_resolved(grid, ridge.at, "ridges", r, "at");
        require_bins(static_cast<Index>(ridge.mass.size()), grid.bins(), entry("mass"), {entry("ridges", r)});
        for (std::size_t i = 0; i < ridge.mass.size(); ++i) {
            if (!is_share(ridge.mass[i])) refuse_share(ridge.mass[i], {entry("ridges", r), entry("mass", i)});
            total += ridge.mass[i];
        }
        const double in_bin = ridge.mass[static_cast<std::size_t>(grid.bin_of(ridge.at))];
        if (ridge.above >= 0.0 && ridge.above <= in_bin) continue;
        throw ParameterError(
            {.parameter = "above",
             .value = text(ridge.above),
             .number = ridge.above,
             .rule = "it must be between 0 and the mass in the bin that holds the exact size",
             .place = {entry("ridges", r)}});
    }
    return total;
}

}  // namespace

Fabric::Fabric(const LogGrid& grid, std::vector<double> probability, std::vector<Atom> atoms,
               std::optional<double> settled_at, Mean mean, std::vector<Ridge> ridges) {
    const Index bins = grid.bins();
    if (static_cast<Index>(probability.size()) != bins * bins) {
        throw ShapeError({.parameter = "probability",
                          .value = std::to_string(probability.size()),
                          .number = static_cast<double>(probability.size()),
                          .finding = "has " + std::to_string(probability.size()) + " entries",
                          .rule = "the grid needs shape " + shape_text(bins, bins)});
    }
    if (settled_at) require_stress_ratio(*settled_at);
    std::vector<double> rows(static_cast<std::size_t>(bins));
    for (Index i = 0; i < bins; ++i) {
        const ConstLine row(probability.data() + i * bins, bins);
        for (Index j = 0; j < bins; ++j) {
            if (!is_share(row[j])) refuse_share(row[j], {entry("probability", {i, j})});
        }
        rows[static_cast<std::size_t>(i)] = row.sum();
    }
    double total = std::accumulate(rows.begin(), rows.end(), 0.0);
    total += checked_total(grid, atoms) + checked_total(grid, ridges);
    require_whole(total,
                  atoms.empty() && ridges.empty() ? "probability" : "probability, atoms and ridges together");

    std::vector<double> spread = rows;
    for (const Ridge& ridge : ridges) {
        if (ridge.exact == Axis::neighbour) Line(spread.data(), bins) += ConstLine(ridge.mass.data(), bins);
    }
    std::vector<PointMass> points = exact_sizes(atoms, ridges);
    std::vector<double> grainsize = with_points(grid, spread, points);
    data_ = std::make_shared<const Data>(Data{grid, std::move(probability), std::move(atoms),
                                              std::move(ridges), settled_at, mean, std::move(rows),
                                              std::move(spread), std::move(points), std::move(grainsize)});
}

MatrixView<const double> Fabric::probability() const {
    return {data_->probability.data(), grid().bins(), grid().bins()};
}

std::vector<double> Fabric::neighbourhood() const {
    const Index bins = grid().bins();
    std::vector<double> pmf(static_cast<std::size_t>(bins), 0.0);
    for (Index i = 0; i < bins; ++i) Line(pmf.data(), bins) += ConstLine(probability().row(i), bins);
    for (const Atom& atom : atoms()) pmf[static_cast<std::size_t>(grid().bin_of(atom.psibar))] += atom.mass;
    for (const Ridge& ridge : ridges()) {
        const ConstLine mass(ridge.mass.data(), bins);
        if (ridge.exact == Axis::grain) {
            Line(pmf.data(), bins) += mass;
        } else {
            pmf[static_cast<std::size_t>(grid().bin_of(ridge.at))] += mass.sum();
        }
    }
    return pmf;
}

std::vector<double> Fabric::cdf() const {
    std::vector<double> finer(data_->grainsize.size());
    std::partial_sum(data_->grainsize.begin(), data_->grainsize.end(), finer.begin());
    return finer;
}

Fabric Fabric::binned() const {
    if (atoms().empty() && ridges().empty()) return *this;
    const Index bins = grid().bins();
    std::vector<double> p = data_->probability;
    const auto put = [&](Index i, Index j, double mass) {
        p[static_cast<std::size_t>(i * bins + j)] += mass;
    };
    for (const Atom& atom : atoms()) put(grid().bin_of(atom.psi), grid().bin_of(atom.psibar), atom.mass);
    for (const Ridge& ridge : ridges()) {
        const Index at = grid().bin_of(ridge.at);
        for (Index i = 0; i < bins; ++i) {
            const double mass = ridge.mass[static_cast<std::size_t>(i)];
            ridge.exact == Axis::grain ? put(at, i, mass) : put(i, at, mass);
        }
    }
    const std::vector<double>& marginal = data_->grainsize;
    return FabricAccess::make(
        {grid(), std::move(p), {}, {}, std::nullopt, mean(), marginal, marginal, {}, marginal});
}

CarriedMarginals Fabric::carried() const {
    return {data_->rows, data_->spread, data_->points};
}

Fabric Fabric::with_carried(CarriedMarginals marginals) const {
    const auto require_close = [](double given, double own, const char* list, std::size_t index,
                                  const char* field) {
        if (std::abs(given - own) <= 1e-9) return;
        Fault fault{
            .parameter = field,
            .value = text(given),
            .number = given,
            .rule = "the fabric has " + text(own) + " there, and takes back what `carried` gave of it alone",
            .place = {entry("marginals"), entry(list, index)}};
        throw ParameterError(fault);
    };
    const std::size_t bins = data_->rows.size();
    if (marginals.rows.size() != bins || marginals.spread.size() != bins ||
        marginals.points.size() != data_->points.size()) {
        throw ShapeError({.parameter = "marginals",
                          .subject = "the carried marginals",
                          .finding = "have " + std::to_string(marginals.rows.size()) + " and " +
                                     std::to_string(marginals.spread.size()) + " bins and " +
                                     std::to_string(marginals.points.size()) + " points",
                          .rule = "the fabric has " + std::to_string(bins) + " bins and " +
                                  std::to_string(data_->points.size()) + " points"});
    }
    for (std::size_t i = 0; i < bins; ++i) {
        require_close(marginals.rows[i], data_->rows[i], "rows", i, "rows");
        require_close(marginals.spread[i], data_->spread[i], "spread", i, "spread");
    }
    for (std::size_t a = 0; a < marginals.points.size(); ++a) {
        require_close(marginals.points[a].psi, data_->points[a].psi, "points", a, "psi");
        require_close(marginals.points[a].mass, data_->points[a].mass, "points", a, "mass");
    }
    Data data = *data_;
    data.rows = std::move(marginals.rows);
    data.spread = std::move(marginals.spread);
    data.points = std::move(marginals.points);
    data.grainsize = with_points(data.grid, data.spread, data.points);
    return Fabric(std::make_shared<const Data>(std::move(data)));
}

bool operator==(const Fabric& a, const Fabric& b) {
    return a.data_ == b.data_ ||
           (a.grid() == b.grid() && a.mean() == b.mean() && a.settled_at() == b.settled_at() &&
            a.data_->probability == b.data_->probability && a.atoms() == b.atoms() &&
            a.ridges() == b.ridges());
}

}  // namespace comminute
