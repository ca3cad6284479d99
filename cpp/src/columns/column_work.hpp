// SPDX-License-Identifier: BSD-3-Clause
// The parts of a ResolvedColumn, and its way through a time (docs/theory/columns.md, sections 1 and 5).
#pragma once

#include <algorithm>
#include <atomic>
#include <deque>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "base/check.hpp"
#include "base/workers.hpp"
#include "columns/exchange.hpp"
#include "columns/law_row.hpp"

namespace comminute::detail {

/// Working memory of one thread.
struct Tools {
    explicit Tools(const ColumnTables& tables)
        : exchange(tables.triples), settling(tables.triples, tables.rules), fresh(tables.triples) {}
    Exchange exchange;
    Settling settling;
    FreshPairs fresh;
};

/// Composition of a row before an exchange.
struct Grains {
    std::vector<double> share;  ///< (N) sum 1
    std::vector<double> count;  ///< (N) mean crushes of the grains of each node
    double mean = 0.0;          ///< size
    double largest = 0.0;
    double smallest = 0.0;
};

/// A bond: the row above a row, or what stands for it, and the Q of its swaps.
struct Bond {
    const Grains* lower = nullptr;
    const Grains* upper = nullptr;
    double mixing = 0.0;
    double segregation = 0.0;  ///< over the difference of the two sizes

    Swaps swaps() const { return {mixing / (1.0 + mixing), segregation}; }
    double largest_segregation() const {
        return segregation * std::max(lower->largest - upper->smallest, 0.0);
    }
};

/// A column behind its public face.
struct ColumnWork {
    ResolvedColumnOptions options;
    double height;
    ColumnTables tables;
    std::deque<LawRow> rows;
    std::uint64_t sweeps = 0;
    double fed = 0.0;
    std::vector<std::unique_ptr<Tools>> idle;  // of threads
    std::mutex lock;                           // of them

    ColumnWork(const ResolvedGrid& grid, const Material& material, double h, const ResolvedColumnOptions& o)
        : options(o), height(h), tables(grid, material, o) {}
    ColumnWork(const ColumnWork& other)
        : options(other.options),
          height(other.height),
          tables(other.tables),
          rows(other.rows),
          sweeps(other.sweeps),
          fed(other.fed) {}

    Index count() const { return static_cast<Index>(rows.size()); }
    double dz() const { return height / static_cast<double>(count()); }
    double neighbour_length() const {
        return options.neighbour_length > 0.0 ? options.neighbour_length : dz();
    }

    /// Calls work(row, tools) for every row, some at a time; whether all were.
    template <class F>
    bool for_each_row(const F& work, const std::function<bool()>& go_on) {
        std::atomic<std::size_t> done = 0;
        for_each_index(
            rows.size(), static_cast<std::size_t>(options.threads),
            [&](std::size_t z, const std::function<bool()>& ask) {
                if (!ask()) return;
                std::unique_ptr<Tools> tools;
                {
                    const std::lock_guard guard(lock);
                    if (!idle.empty()) {
                        tools = std::move(idle.back());
                        idle.pop_back();
                    }
                }
                if (!tools) tools = std::make_unique<Tools>(tables);
                work(static_cast<Index>(z), *tools);
                const std::lock_guard guard(lock);
                idle.push_back(std::move(tools));
                ++done;
            },
            go_on);
        return done == rows.size();
    }
    std::vector<double> loads() const;

    LawRow& row(Index z) { return rows[static_cast<std::size_t>(z)]; }
    const LawRow& row(Index z) const { return rows[static_cast<std::size_t>(z)]; }
    const LawRow& checked(Index z) const {
        require(z >= 0 && z < count(), "row", static_cast<double>(z),
                "0 or more and less than the number of rows");
        return row(z);
    }

    Grains grains_of(const std::vector<double>& pmf, const Array<double>* counts) const;

    struct Driven {
        const ColumnDrive& drive;
        const ColumnEnds& ends;
        Grains feed;
    };
    std::vector<Grains> grains();
    Bond bond(const std::vector<Grains>& all, const Driven& driven, Index lower, double time) const;
    std::vector<Bond> bonds(const std::vector<Grains>& all, const Driven& driven, double time) const;
    double renewal(const Grains& grains, const Driven& driven, Index z, double time) const;
    double divided(const Driven& driven, double time, ResolvedColumnReport& report);
    void sweep(const Driven& driven, double time, Index colour, ResolvedColumnReport& report);
    void carry_counts(OpenRow& open, Swaps swaps, bool lower, const Grains& own, const Grains& other,
                      std::vector<double>* inflow) const;
    /// @throws ParameterError for a load at a place that is below the largest that a row coming there has known
    void require_no_fall(Index z, Index place, double load) const;
    void push(const Driven& driven, ResolvedColumnReport& report);
    void require_ends(const ColumnEnds& ends) const;
};

}  // namespace comminute::detail
