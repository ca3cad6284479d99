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
        const double in_bin = at(ridge.mass, grid.bin_of(ridge.at));
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

// (N) marginal over psi of the mass in bins, every entry of which is looked at.
Array<double> checked_rows(const std::vector<double>& probability, Index bins) {
    if (static_cast<Index>(probability.size()) != bins * bins) {
        throw ShapeError({.parameter = "probability",
                          .value = std::to_string(probability.size()),
                          .number = static_cast<double>(probability.size()),
                          .finding = "has " + std::to_string(probability.size()) + " entries",
                          .rule = "the grid needs shape " + shape_text(bins, bins)});
    }
    Array<double> rows(bins);
    for (Index i = 0; i < bins; ++i) {
        const ConstLine row(probability.data() + i * bins, bins);
        for (Index j = 0; j < bins; ++j) {
            if (!is_share(row[j])) refuse_share(row[j], {entry("probability", {i, j})});
        }
        rows[i] = row.sum();
    }
    return rows;
}

// Fills in the marginals after a look at all the rest.
FabricParts checked(FabricParts parts) {
    const Index bins = parts.grid.bins();
    if (parts.settled_at) require_stress_ratio(*parts.settled_at);
    require_largest(parts.largest);
    Array<double> rows = checked_rows(parts.probability, bins);
    double total = std::accumulate(rows.begin(), rows.end(), 0.0);
    total += checked_total(parts.grid, parts.atoms) + checked_total(parts.grid, parts.ridges);
    require_whole(total, parts.atoms.empty() && parts.ridges.empty()
                             ? "probability"
                             : "probability, atoms and ridges together");
    parts.rows = rows.vector();
    parts.spread = std::move(rows).vector();
    for (const Ridge& ridge : parts.ridges) {
        if (ridge.exact == Axis::neighbour)
            Line(parts.spread.data(), bins) += ConstLine(ridge.mass.data(), bins);
    }
    parts.points = exact_sizes(parts.atoms, parts.ridges);
    return parts;
}

void require_close(double given, double own, const char* list, std::size_t index, const char* field) {
    if (std::abs(given - own) <= 1e-9) return;
    throw ParameterError(
        {.parameter = field,
         .value = text(given),
         .number = given,
         .rule = "the fabric has " + text(own) + " there, and takes back the marginals that it gave alone",
         .place = {entry("marginals"), entry(list, index)}});
}

void require_marginals_of(const FabricParts& stored, const FabricParts& own) {
    if (stored.rows.size() != own.rows.size() || stored.spread.size() != own.rows.size() ||
        stored.points.size() != own.points.size()) {
        throw ShapeError({.parameter = "marginals",
                          .subject = "the stored marginals",
                          .finding = "have " + std::to_string(stored.rows.size()) + " and " +
                                     std::to_string(stored.spread.size()) + " bins and " +
                                     std::to_string(stored.points.size()) + " points",
                          .rule = "the fabric has " + std::to_string(own.rows.size()) + " bins and " +
                                  std::to_string(own.points.size()) + " points"});
    }
    for (std::size_t i = 0; i < own.rows.size(); ++i) {
        require_close(stored.rows[i], own.rows[i], "rows", i, "rows");
        require_close(stored.spread[i], own.spread[i], "spread", i, "spread");
    }
    for (std::size_t a = 0; a < own.points.size(); ++a) {
        require_close(std::log(stored.points[a].size), own.points[a].psi, "points", a, "size");
        require_close(stored.points[a].psi, own.points[a].psi, "points", a, "psi");
        require_close(stored.points[a].mass, own.points[a].mass, "points", a, "mass");
    }
}

}  // namespace

Fabric::Fabric(const LogGrid& grid, std::vector<double> probability, std::vector<Atom> atoms,
               std::optional<double> settled_at, Mean mean, std::vector<Ridge> ridges, double largest)
    : Fabric(FabricAccess::make(checked({grid,
                                         std::move(probability),
                                         std::move(atoms),
                                         std::move(ridges),
                                         settled_at,
                                         mean,
                                         {},
                                         {},
                                         {},
                                         largest}))) {}

Fabric Fabric::from_parts(FabricParts parts) {
    FabricParts stored{parts.grid,
                       {},
                       {},
                       {},
                       {},
                       parts.mean,
                       std::move(parts.rows),
                       std::move(parts.spread),
                       std::move(parts.points),
                       0.0};
    FabricParts whole = checked(std::move(parts));
    require_marginals_of(stored, whole);
    whole.rows = std::move(stored.rows);
    whole.spread = std::move(stored.spread);
    whole.points = std::move(stored.points);
    return FabricAccess::make(std::move(whole));
}

MatrixView<const double> Fabric::probability() const {
    return {data_->probability.data(), grid().bins(), grid().bins()};
}

std::vector<double> Fabric::neighbourhood() const {
    const Index bins = grid().bins();
    Array<double> pmf(bins);
    for (Index i = 0; i < bins; ++i) Line(pmf.data(), bins) += ConstLine(probability().row(i), bins);
    for (const Atom& atom : atoms()) pmf[grid().bin_of(atom.psibar)] += atom.mass;
    for (const Ridge& ridge : ridges()) {
        const ConstLine mass(ridge.mass.data(), bins);
        if (ridge.exact == Axis::grain) {
            Line(pmf.data(), bins) += mass;
        } else {
            pmf[grid().bin_of(ridge.at)] += mass.sum();
        }
    }
    return std::move(pmf).vector();
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
    const MatrixView<double> cells(p.data(), bins, bins);
    const auto put = [&](Index i, Index j, double mass) { cells(i, j) += mass; };
    for (const Atom& atom : atoms()) put(grid().bin_of(atom.psi), grid().bin_of(atom.psibar), atom.mass);
    for (const Ridge& ridge : ridges()) {
        const Index own = grid().bin_of(ridge.at);
        const VectorView<const double> mass(ridge.mass);
        for (Index i = 0; i < bins; ++i) {
            ridge.exact == Axis::grain ? put(own, i, mass[i]) : put(i, own, mass[i]);
        }
    }
    const std::vector<double>& marginal = data_->grainsize;
    return FabricAccess::make(
        {grid(), std::move(p), {}, {}, std::nullopt, mean(), marginal, marginal, {}, 0.0});
}

bool operator==(const Fabric& a, const Fabric& b) {
    return a.data_ == b.data_ ||
           (a.grid() == b.grid() && a.mean() == b.mean() && a.settled_at() == b.settled_at() &&
            a.data_->probability == b.data_->probability && a.atoms() == b.atoms() &&
            a.ridges() == b.ridges() && a.largest() == b.largest());
}

}  // namespace comminute
