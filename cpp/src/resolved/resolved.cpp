// SPDX-License-Identifier: BSD-3-Clause
// The clock of the three-cell law: steps, extrapolation, mixing (docs/theory/three_cells.md, section 5).
#include "comminute/resolved.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "base/check.hpp"
#include "base/workers.hpp"
#include "resolved/resolved_access.hpp"
#include "resolved/triple_joint.hpp"
#include "resolved/triple_state.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr double first_step = 0.01;   // of ln(stress ratio)
constexpr double least_step = 1e-7;   // which is taken however much the zone overruns
constexpr Index most_nodes = 100000;  // of the clock, far more than any path needs
constexpr double most_log_load = 700.0;

/// The coarse state and the fine one, at one node of the clock or at a load between two.
struct Both {
    TripleState coarse;
    TripleState fine;

    template <class F>
    double extrapolated(const F& of) const {
        return 2.0 * of(fine) - of(coarse);
    }
};

/// A place of the clock, ln(stress ratio), and the step that is tried first after it.
struct Node {
    double log_load;
    double hint;
};

}  // namespace

struct Resolved::Work {
    TripleTables tables;
    ResolvedOptions options;
    TripleScratch scratch;
    std::optional<TripleScratch> fine_scratch;  // where the fine state has a thread of its own
    Both clock;                                 // at the last node
    Both result;                                // at the largest load
    Node at;                                    // that node
    std::optional<Node> next;                   // and the one after it
    double settled_at = 0.0;
    Index nodes = 0;
    double crushes_before = 0.0;  // the last mixing
    double avalanches_before = 0.0;

    Work(const ResolvedGrid& grid, const Material& material, const ResolvedOptions& o,
         const std::function<TripleState(const TripleTables&)>& start)
        : tables(grid, material, o.mean),
          options(o),
          scratch(tables),
          clock{start(tables), start(tables)},
          result(clock),
          at{tables.log_stress_ratio(tables.lowest_level()), first_step} {
        if (options.threads > 1) fine_scratch.emplace(tables);
    }

    void restart(TripleState state) {
        clock = {state, std::move(state)};
        result = clock;
        at = {tables.log_stress_ratio(tables.lowest_level()), first_step};
        next.reset();
        settled_at = 0.0;
        nodes = 0;
    }

    /// The next node: as far as the coarse state's zone overruns no more than the tolerance, whatever loads are asked for.
    Node propose() const {
        double step = std::min(at.hint, options.max_step);
        double hardness = 0.0;
        while (true) {
            hardness =
                clock.coarse.overrun_mass(tables, tables.level(at.log_load + step)) / options.tolerance;
            if (!(hardness > 1.0) || step < least_step) break;
            step *= std::clamp(0.9 / hardness, 0.1, 0.8);
        }
        const double longer = hardness > 0.0 ? std::clamp(0.9 / hardness, 1.0, 4.0) : 4.0;
        return {at.log_load + step, step * longer};
    }

    /// Takes the coarse state to a load in one step and the fine one in two.
    void advance(Both& both, double log_load) {
        const auto coarse = [&] { both.coarse.step(tables, tables.level(log_load), scratch); };
        const auto fine = [&](TripleScratch& own) {
            both.fine.step(tables, tables.level(0.5 * (at.log_load + log_load)), own);
            both.fine.step(tables, tables.level(log_load), own);
        };
        if (options.threads < 2) {
            coarse();
            fine(scratch);
            return;
        }
        for_each_index(2, 2,
                       [&](std::size_t which, const std::function<bool()>&) {
                           which == 0 ? coarse() : fine(*fine_scratch);
                       },
                       {});
    }

    void load_to(double stress_ratio) {
        if (stress_ratio <= settled_at) return;
        const double log_load = std::log(stress_ratio);
        if (!next) next = propose();
        while (next->log_load <= log_load) {
            const Node reached = *next;
            advance(clock, reached.log_load);
            at = reached;
            if (++nodes > most_nodes) {
                throw ParameterError(
                    {.parameter = "tolerance",
                     .value = text(options.tolerance),
                     .number = options.tolerance,
                     .finding = "leads to more than " + std::to_string(most_nodes) + " steps",
                     .rule = "it must be greater"});
            }
            next = propose();
        }
        result = clock;
        if (log_load > at.log_load) advance(result, log_load);
        settled_at = stress_ratio;
    }

    std::vector<double> pmf() const {
        std::vector<double> mass = result.fine.pmf(tables);
        const std::vector<double> coarse = result.coarse.pmf(tables);
        for (std::size_t i = 0; i < mass.size(); ++i) mass[i] = 2.0 * mass[i] - coarse[i];
        return mass;
    }

    double crushes() const {
        return crushes_before + result.extrapolated([](const TripleState& s) { return s.crushes(); });
    }
    double avalanches() const {
        return avalanches_before + result.extrapolated([](const TripleState& s) { return s.avalanches(); });
    }
};

namespace {

void require_options(const ResolvedOptions& options) {
    require(options.tolerance > 0.0, "tolerance", options.tolerance, "greater than 0");
    require(options.max_step > 0.0, "max_step", options.max_step, "greater than 0");
    require(options.threads == 1 || options.threads == 2, "threads", static_cast<double>(options.threads),
            "1 or 2, for the coarse and the fine state");
}

void require_shares(const std::vector<double>& values, const char* list) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!is_share(values[i])) refuse_share(values[i], {entry(list, i)});
    }
    require_whole(std::accumulate(values.begin(), values.end(), 0.0), list);
}

// Packings that differ by more than rounding left to right would have gradings that depend on which cell is asked for.
void require_alike(const std::vector<double>& triples, Index nodes) {
    constexpr double rounding = 1e-12;
    const auto mass = [&](Index b, Index a, Index c) { return at(triples, (b * nodes + a) * nodes + c); };
    for (Index a = 0; a < nodes; ++a) {
        for (Index b = 0; b < nodes; ++b) {
            double right = 0.0;
            double left = 0.0;
            for (Index c = 0; c < nodes; ++c) {
                right += mass(b, a, c);
                left += mass(a, b, c);
                const double turned = mass(b, c, a) - mass(b, a, c);
                if (std::abs(turned) <= rounding) continue;
                throw ParameterError(
                    {.parameter = "triples",
                     .value = text(mass(b, a, c)),
                     .number = mass(b, a, c),
                     .rule = "it must equal the entry with left and right neighbour exchanged, " +
                             text(mass(b, c, a)),
                     .place = {entry("triples", {b, a, c})}});
            }
            if (std::abs(right - left) <= rounding) continue;
            throw ParameterError({.parameter = "triples",
                                  .value = text(right),
                                  .number = right,
                                  .finding = "adds up to " + text(right) + " over the third cell",
                                  .rule = "it must add up to what the pair turned round does, " + text(left),
                                  .place = {entry("triples", {b, a})}});
        }
    }
}

}  // namespace

Resolved::Resolved(std::unique_ptr<Work> work) : work_(std::move(work)) {}

Resolved::Resolved(const ResolvedGrid& grid, const Material& material, const std::vector<double>& pmf,
                   const ResolvedOptions& options) {
    require_options(options);
    require_entries(static_cast<Index>(pmf.size()), grid.nodes(), entry("pmf"),
                    "the grid has " + std::to_string(grid.nodes()) + " nodes");
    require_shares(pmf, "pmf");
    work_ = std::make_unique<Work>(grid, material, options,
                                   [&](const TripleTables& tables) { return TripleState(tables, pmf); });
}

Resolved Resolved::of_triples(const ResolvedGrid& grid, const Material& material,
                              const std::vector<double>& triples, const ResolvedOptions& options) {
    require_options(options);
    const Index nodes = grid.nodes();
    require_entries(static_cast<Index>(triples.size()), nodes * nodes * nodes, entry("triples"),
                    "the grid has " + std::to_string(nodes) + " nodes");
    require_shares(triples, "triples");
    require_alike(triples, nodes);
    return Resolved(std::make_unique<Work>(grid, material, options, [&](const TripleTables& tables) {
        return TripleState(tables, Triples{triples});
    }));
}

Resolved::Resolved(const ResolvedGrid& grid, const Material& material, const ResolvedRecord& record,
                   const ResolvedOptions& options) {
    require_options(options);
    const Index nodes = grid.nodes();
    for (const TripleRecord* state : {&record.coarse, &record.fine}) {
        for (const std::vector<double>* mass : {&state->settled, &state->pending}) {
            require_entries(static_cast<Index>(mass->size()), nodes * nodes * nodes, entry("record"),
                            "the grid has " + std::to_string(nodes) + " nodes");
        }
    }
    work_ = std::make_unique<Work>(grid, material, options, [&](const TripleTables& tables) {
        return TripleState(tables, record.coarse);
    });
    work_->clock.fine = TripleState(work_->tables, record.fine);
    work_->result = work_->clock;
    work_->at = {record.log_load, record.hint};
    work_->nodes = record.nodes;
    work_->crushes_before = record.crushes_before;
    work_->avalanches_before = record.avalanches_before;
    work_->load_to(record.settled_at);
}

const TripleState& detail::ResolvedAccess::fine(const Resolved& law) {
    return law.work_->result.fine;
}

ResolvedRecord Resolved::record() const {
    const Work& w = *work_;
    return {w.clock.coarse.record(w.tables),
            w.clock.fine.record(w.tables),
            w.at.log_load,
            w.at.hint,
            w.settled_at,
            w.nodes,
            w.crushes_before,
            w.avalanches_before};
}

Resolved::~Resolved() = default;
Resolved::Resolved(const Resolved& other) : work_(std::make_unique<Work>(*other.work_)) {}
Resolved& Resolved::operator=(const Resolved& other) {
    work_ = std::make_unique<Work>(*other.work_);
    return *this;
}
Resolved::Resolved(Resolved&&) noexcept = default;
Resolved& Resolved::operator=(Resolved&&) noexcept = default;

const ResolvedGrid& Resolved::grid() const {
    return work_->tables.grid();
}
const Material& Resolved::material() const {
    return work_->tables.material();
}
const ResolvedOptions& Resolved::options() const {
    return work_->options;
}

void Resolved::load_to(double stress_ratio) {
    require(stress_ratio >= 0.0 && stress_ratio <= std::exp(most_log_load), "stress_ratio", stress_ratio,
            "at least 0 and at most e^700");
    work_->load_to(stress_ratio);
}

// The product of three shares has three times their rounding error, so that they are scaled to a sum of 1.
void Resolved::remix() {
    std::vector<double> pmf = work_->pmf();
    for (double& mass : pmf) mass = std::max(mass, 0.0);
    const double total = std::accumulate(pmf.begin(), pmf.end(), 0.0);
    for (double& mass : pmf) mass /= total;
    work_->crushes_before = work_->crushes();
    work_->avalanches_before = work_->avalanches();
    work_->restart(TripleState(work_->tables, pmf, work_->result.fine.endured(work_->tables)));
}

std::vector<double> Resolved::pmf() const {
    return work_->pmf();
}

std::vector<double> Resolved::triples() const {
    const Index nodes = grid().nodes();
    std::vector<double> mass;
    mass.reserve(static_cast<std::size_t>(nodes * nodes * nodes));
    for (Index b = 0; b < nodes; ++b) {
        for (Index a = 0; a < nodes; ++a) {
            for (Index c = 0; c < nodes; ++c) {
                mass.push_back(work_->result.extrapolated(
                    [&](const TripleState& s) { return s.mass(work_->tables, b, a, c); }));
            }
        }
    }
    return mass;
}

std::vector<double> Resolved::joint(const LogGrid& bins) const {
    const TripleTables& tables = work_->tables;
    return joint_of(tables, bins, [&](Index b, Index a, Index c) {
        return work_->result.extrapolated([&](const TripleState& s) { return s.mass(tables, b, a, c); });
    });
}

double Resolved::crushes() const {
    return work_->crushes();
}
double Resolved::avalanches() const {
    return work_->avalanches();
}

double Resolved::step_error() const {
    const std::vector<double> fine = work_->result.fine.pmf(work_->tables);
    const std::vector<double> coarse = work_->result.coarse.pmf(work_->tables);
    double difference = 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < fine.size(); ++i) {
        difference += fine[i] - coarse[i];
        worst = std::max(worst, std::abs(difference));
    }
    return worst;
}

double Resolved::settled_at() const {
    return work_->settled_at;
}
Index Resolved::steps() const {
    return 3 * work_->nodes;
}

std::vector<double> count_triples(VectorView<const double> psi, const ResolvedGrid& grid) {
    const Index cells = psi.size();
    const Index nodes = grid.nodes();
    require(cells >= 3, "cells", static_cast<double>(cells), "at least 3");
    std::vector<Index> node;
    for (Index i = 0; i < cells; ++i) {
        try {
            node.push_back(grid.node_of(psi[i]));
        } catch (const ParameterError& error) {
            throw ParameterError(within(entry("psi", {i}), error.fault()));
        }
    }
    std::vector<double> triples(static_cast<std::size_t>(nodes * nodes * nodes), 0.0);
    const double share = 0.5 / static_cast<double>(cells);
    for (Index i = 0; i < cells; ++i) {
        const Index a = at(node, (i + cells - 1) % cells);
        const Index b = at(node, i);
        const Index c = at(node, (i + 1) % cells);
        at(triples, (b * nodes + a) * nodes + c) += share;
        at(triples, (b * nodes + c) * nodes + a) += share;
    }
    return triples;
}

}  // namespace comminute
