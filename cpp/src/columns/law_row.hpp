// SPDX-License-Identifier: BSD-3-Clause
// A row of a column: a closed packing until it first exchanges a grain, an open law from then on
// (docs/theory/columns.md, section 4).
#pragma once

#include <optional>
#include <vector>

#include "columns/settling.hpp"
#include "comminute/resolved_column.hpp"

namespace comminute::detail {

/// Everything that the rows of a column share.
struct ColumnTables {
    ColumnTables(const ResolvedGrid& grid, const Material& material, const ResolvedColumnOptions& options);

    TripleTables triples;
    ResolvedOptions closed;  ///< of a row that has exchanged nothing
    SettlingRules rules;
    std::vector<double> sizes;  ///< (N) mean size of each node
};

class LawRow {
  public:
    /// A random mixture at no load.
    LawRow(const ColumnTables& tables, const std::vector<double>& pmf);
    LawRow(const ColumnTables& tables, const ResolvedRowRecord& record);

    /// Load that stands, or nothing before the first.
    const std::optional<double>& load() const { return load_; }
    void load_to(const ColumnTables& tables, double stress_ratio, Settling& settling);
    void stand_under(const ColumnTables& tables, double stress_ratio, Settling& settling);
    /// Makes the row an open law, as which it takes part in exchanges.
    void open(const ColumnTables& tables, Settling& settling);
    OpenRow& law() { return *open_; }
    /// Largest stress ratio that the row has known.
    double largest_load() const { return largest_; }

    std::vector<double> pmf(const ColumnTables& tables) const;
    double crushes() const;
    double pending() const;
    /// Mass of the centre b between a and c, for as long as this row is unchanged.
    std::function<double(Index, Index, Index)> masses(const ColumnTables& tables) const;
    ResolvedRowRecord record(const ColumnTables& tables) const;

  private:
    void stand(double stress_ratio);
    Resolved closed_law(const ColumnTables& tables) const;
    void keep(const Resolved& law);

    ResolvedRecord closed_;           // of a law that is not open
    std::vector<double> start_;       // (N) of it
    std::vector<double> closed_pmf_;  // (N)
    double closed_crushes_ = 0.0;
    std::optional<OpenRow> open_;
    std::optional<double> load_;
    double largest_ = 0.0;  // of the loads that stood
};

}  // namespace comminute::detail
