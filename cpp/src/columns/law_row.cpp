// SPDX-License-Identifier: BSD-3-Clause
// Closed rows, open rows and their loads (docs/theory/columns.md, section 4).
#include "columns/law_row.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <string>

#include "base/check.hpp"
#include "resolved/resolved_access.hpp"
#include "simd/loops.hpp"

namespace comminute::detail {

ColumnTables::ColumnTables(const ResolvedGrid& grid, const Material& material,
                           const ResolvedColumnOptions& options)
    : triples(grid, material, options.mean),
      closed{options.mean, options.tolerance, ResolvedOptions{}.max_step, 1},
      rules{options.tolerance, options.competition, options.rest} {
    for (Index i = 0; i < grid.nodes(); ++i) {
        const double width = grid.width(i);
        const double size = std::exp(grid.upper(i));
        sizes.push_back(width > 0.0 ? -size * std::expm1(-width) / width : size);
    }
}

LawRow::LawRow(const ColumnTables& tables, const std::vector<double>& pmf) : start_(pmf) {
    keep(Resolved(tables.triples.grid(), tables.triples.material(), pmf, tables.closed));
}

LawRow::LawRow(const ColumnTables& tables, const ResolvedRowRecord& record) : start_(record.start) {
    const Index nodes = tables.triples.nodes();
    const auto require_nodes = [&](const std::vector<double>& values, Index wanted) {
        require_entries(static_cast<Index>(values.size()), wanted, entry("record"),
                        "the grid has " + std::to_string(nodes) + " nodes");
    };
    require_nodes(record.start, nodes);
    if (record.has_met) {
        require_nodes(record.counts, nodes);
        require_nodes(record.open.settled, nodes * nodes * nodes);
        require_nodes(record.open.pending, nodes * nodes * nodes);
    }
    if (record.load >= 0.0) load_ = record.load;
    largest_ = record.largest;
    if (record.has_met) {
        open_.emplace(OpenRow{TripleState(tables.triples, record.open), Array<double>(record.counts)});
    } else {
        keep(Resolved(tables.triples.grid(), tables.triples.material(), record.closed, tables.closed));
    }
}

Resolved LawRow::closed_law(const ColumnTables& tables) const {
    return {tables.triples.grid(), tables.triples.material(), closed_, tables.closed};
}

void LawRow::keep(const Resolved& law) {
    closed_ = law.record();
    closed_pmf_ = law.pmf();
    closed_crushes_ = law.crushes();
}

void LawRow::load_to(const ColumnTables& tables, double stress_ratio, Settling& settling) {
    stand(stress_ratio);
    if (!open_) {
        if (stress_ratio <= closed_.settled_at) return;
        Resolved closed = closed_law(tables);
        closed.load_to(stress_ratio);
        keep(closed);
        return;
    }
    settling.raise(*open_, std::log(stress_ratio), tables.closed.max_step);
}

void LawRow::stand_under(const ColumnTables& tables, double stress_ratio, Settling& settling) {
    stand(stress_ratio);
    open(tables, settling);
    TripleState& law = open_->law;
    const double level = tables.triples.level(std::log(stress_ratio));
    if (level > law.level()) law.overrun(tables.triples, level);
}

// The state of the finer steps lags behind its load by the avalanches of one step, which come to their end here; what is
// extrapolated has counted them. Of the closed law it is known how often its grains crushed, and not which; the crushes are
// given to the sizes of which there is more than at the start.
void LawRow::open(const ColumnTables& tables, Settling& settling) {
    if (open_) return;
    const Index nodes = tables.triples.nodes();
    open_.emplace(OpenRow{ResolvedAccess::fine(closed_law(tables)), Array<double>(nodes)});
    settling.come_to_rest(*open_);
    const std::vector<double> pmf = open_->law.pmf(tables.triples);
    Array<double>& counts = open_->counts;
    double more = 0.0;
    for (Index i = 0; i < nodes; ++i) more += counts[i] = std::max(at(pmf, i) - at(start_, i), 0.0);
    for (double& count : counts) count *= more > 0.0 ? closed_crushes_ / more : 0.0;
    closed_ = {};
}

void LawRow::stand(double stress_ratio) {
    load_ = stress_ratio;
    largest_ = std::max(largest_, stress_ratio);
}

std::vector<double> LawRow::pmf(const ColumnTables& tables) const {
    return open_ ? open_->law.pmf(tables.triples) : closed_pmf_;
}

double LawRow::crushes() const {
    return open_ ? std::accumulate(open_->counts.begin(), open_->counts.end(), 0.0) : closed_crushes_;
}

double LawRow::pending() const {
    return open_ ? sum(open_->law.pending().data(), open_->law.pending().size()) : 0.0;
}

std::function<double(Index, Index, Index)> LawRow::masses(const ColumnTables& tables) const {
    if (open_) {
        return
            [this, &tables](Index b, Index a, Index c) { return open_->law.mass(tables.triples, b, a, c); };
    }
    const auto cells = std::make_shared<std::vector<double>>(closed_law(tables).triples());
    const Index nodes = tables.triples.nodes();
    return [cells, nodes](Index b, Index a, Index c) { return at(*cells, (b * nodes + a) * nodes + c); };
}

ResolvedRowRecord LawRow::record(const ColumnTables& tables) const {
    ResolvedRowRecord record;
    record.start = start_;
    record.load = load_.value_or(-1.0);
    record.largest = largest_;
    record.has_met = open_.has_value();
    if (open_) {
        record.open = open_->law.record(tables.triples);
        record.counts = open_->counts.vector();
    } else {
        record.closed = closed_;
    }
    return record;
}

}  // namespace comminute::detail
