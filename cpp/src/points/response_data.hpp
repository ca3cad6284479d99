// SPDX-License-Identifier: BSD-3-Clause
// Columns of a response table and how they are read (docs/theory/response_tables.md).
#pragma once

#include <string>
#include <vector>

#include "comminute/response_table.hpp"
#include "points/monotone_cubic.hpp"

namespace comminute {

namespace detail {

/// Numbers over the loads, column by column, with their slopes.
struct ResponseColumns {
    std::vector<double> at;                   // (T) ln(stress ratio)
    std::vector<std::vector<double>> values;  // of each column (T)
    std::vector<std::vector<double>> slopes;

    void add(std::vector<double> at_loads) {
        slopes.push_back(monotone_slopes(at, at_loads));
        values.push_back(std::move(at_loads));
    }

    Reading read(Index column, const Interval& where) const {
        const std::vector<double>& value = values[static_cast<std::size_t>(column)];
        const std::vector<double>& slope = slopes[static_cast<std::size_t>(column)];
        return detail::read(
            at, where, [&](Index k) { return value[static_cast<std::size_t>(k)]; },
            [&](Index k) { return slope[static_cast<std::size_t>(k)]; });
    }

    friend bool operator==(const ResponseColumns& a, const ResponseColumns& b) {
        return a.at == b.at && a.values == b.values;
    }
};

/// A load in a table.
struct LoadPlace {
    ResponseStatus status;
    Interval where;
    double stress_ratio;
    bool before_all;  // below the first crush, where nothing changes with the load
};

/// Everything that a table has.
struct ResponseData {
    LogGrid grid;
    ResponseOptions options;
    double largest;
    double most;                     // stress ratio, the last of the loads
    std::vector<PointMass> exact;    // sizes of the start, fine to coarse; their masses are columns
    std::vector<Index> exact_bin;    // of each
    std::vector<std::string> names;  // of the scalars
    ResponseColumns columns;         // cdf of each bin, mass of each exact size, crushes, scalars

    ResponseData(const LogGrid& of_grid, const ResponseOptions& of_options, double of_largest, double of_most,
                 const std::vector<PointMass>& of_start);

    Index exact_column(std::size_t q) const { return grid.bins() + static_cast<Index>(q); }
    Index crushes_column() const { return grid.bins() + static_cast<Index>(exact.size()); }

    LoadPlace place_of(double stress_ratio) const noexcept;
    Response respond(Index column, double stress_ratio) const noexcept;
    /// Size that a share of the mass is finer than, read from the grading under a load.
    Response percentile(double share, const LoadPlace& place) const noexcept;
    std::size_t memory() const;

    friend bool operator==(const ResponseData& a, const ResponseData& b) {
        return a.grid == b.grid && a.options.tolerance == b.options.tolerance &&
               a.options.most_loads == b.options.most_loads && a.largest == b.largest && a.most == b.most &&
               a.exact == b.exact && a.names == b.names && a.columns == b.columns;
    }
};

}  // namespace detail

struct ResponseTable::Data : detail::ResponseData {
    using ResponseData::ResponseData;
};

}  // namespace comminute
