// SPDX-License-Identifier: BSD-3-Clause
// What a ResolvedColumn is made of, and how it goes through a time.
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
#include "columns/law_row.hpp"
#include "columns/exchange.hpp"

namespace comminute {

namespace detail {

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
    double largest_segregation() const { return segregation * std::max(lower->largest - upper->smallest, 0.0); }
};

}  // namespace detail

struct ResolvedColumn::Work {
    ResolvedColumnOptions options;
    double height;
    detail::ColumnTables tables;
    std::deque<detail::LawRow> rows;
    std::uint64_t sweeps = 0;
    double fed = 0.0;
    std::vector<std::unique_ptr<detail::Tools>> idle;  // of threads
    std::mutex lock;                           // of them

    Work(const ResolvedGrid& grid, const Material& material, double h, const ResolvedColumnOptions& o)
        : options(o), height(h), tables(grid, material, o) {}
    Work(const Work& other)
        : options(other.options),
          height(other.height),
          tables(other.tables),
          rows(other.rows),
          sweeps(other.sweeps),
          fed(other.fed) {}

    Index count() const { return static_cast<Index>(rows.size()); }
    double dz() const { return height / static_cast<double>(count()); }
    double neighbour_length() const { return options.neighbour_length > 0.0 ? options.neighbour_length : dz(); }

    /// Calls work(row, tools) for every row, some at a time; whether all were.
    template <class F>
    bool for_each_row(const F& work, const std::function<bool()>& go_on) {
        std::atomic<std::size_t> done = 0;
        detail::for_each_index(
            rows.size(), static_cast<std::size_t>(options.threads),
            [&](std::size_t z, const std::function<bool()>& ask) {
                if (!ask()) return;
                std::unique_ptr<detail::Tools> tools;
                {
                    const std::lock_guard guard(lock);
                    if (!idle.empty()) {
                        tools = std::move(idle.back());
                        idle.pop_back();
                    }
                }
                if (!tools) tools = std::make_unique<detail::Tools>(tables);
                work(static_cast<Index>(z), *tools);
                const std::lock_guard guard(lock);
                idle.push_back(std::move(tools));
                ++done;
            },
            go_on);
        return done == rows.size();
    }
    std::vector<double> loads() const;

    detail::LawRow& row(Index z) { return rows[static_cast<std::size_t>(z)]; }
    const detail::LawRow& row(Index z) const { return rows[static_cast<std::size_t>(z)]; }
    const detail::LawRow& checked(Index z) const {
        require(z >= 0 && z < count(), "row", static_cast<double>(z), "0 or more and less than the number of rows");
        return row(z);
    }

    detail::Grains grains_of(const std::vector<double>& pmf, const detail::Array<double>* counts) const;

    struct Driven {
        const ColumnDrive& drive;
        const ColumnEnds& ends;
        detail::Grains feed;
    };
    std::vector<detail::Grains> grains();
    detail::Bond bond(const std::vector<detail::Grains>& all, const Driven& driven, Index lower, double time) const;
    std::vector<detail::Bond> bonds(const std::vector<detail::Grains>& all, const Driven& driven, double time) const;
    double renewal(const detail::Grains& grains, const Driven& driven, Index z, double time) const;
    double divided(const Driven& driven, double time, ResolvedColumnReport& report);
    void sweep(const Driven& driven, double time, Index colour, ResolvedColumnReport& report);
    void carry_counts(detail::OpenRow& open, detail::Swaps swaps, bool lower, const detail::Grains& own,
                      const detail::Grains& other, std::vector<double>* inflow) const;
    void push(const Driven& driven, ResolvedColumnReport& report);
    void require_ends(const ColumnEnds& ends) const;
};

}  // namespace comminute
