// SPDX-License-Identifier: BSD-3-Clause
// Many states on several threads, each by the same sweep (docs/theory/one_sweep.md, section 14).
#include "comminute/batch.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <optional>
#include <string>
#include <utility>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "base/workers.hpp"
#include "zones/active_band.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr Index states_at_a_time =
    16;  // so many that threads seldom wait for each other, so few that they end together

std::optional<double> settled_at(const Batch& batch, Index b) {
    if (batch.settled_at.size() == 0) return std::nullopt;
    return batch.settled_at[b];
}

bool moves(const Batch& batch, Index b) {
    const std::optional<double> settled = settled_at(batch, b);
    return !settled || batch.stress_ratio[b] > *settled;
}

void require_count(Index found, Index count, const char* list) {
    require_entries(found, count, entry(list), "there are " + std::to_string(count) + " states");
}

void require_loads(VectorView<const double> loads, const char* list) {
    for (Index b = 0; b < loads.size(); ++b) {
        if (loads[b] >= 0.0) continue;
        throw ParameterError({.parameter = list,
                              .value = text(loads[b]),
                              .number = loads[b],
                              .rule = "it must be a number of at least 0 (0 is no load)",
                              .place = {entry(list, {b})}});
    }
}

template <class T>
void require_stack(StackView<T> stack, Index count, Index bins, const char* name) {
    if (stack.count() != count || stack.bins() != bins) {
        throw ShapeError(
            {.parameter = name,
             .finding = "holds " + std::to_string(stack.count()) + " states of shape " +
                        shape_text(stack.bins(), stack.bins()),
             .rule = "it must hold " + std::to_string(count) + " of shape " + shape_text(bins, bins)});
    }
    if (stack.stride() >= bins * bins) return;
    throw ShapeError({.parameter = name,
                      .value = std::to_string(stack.stride()),
                      .number = static_cast<double>(stack.stride()),
                      .finding = "has a stride of " + std::to_string(stack.stride()),
                      .rule = "states of " + std::to_string(bins * bins) + " numbers need at least that"});
}

// The same memory as a matrix with one row for each state, to compare it with other memory.
template <class T>
MatrixView<T> by_state(StackView<T> stack) {
    return {stack.data(), stack.count(), stack.bins() * stack.bins(), stack.stride()};
}

/// Search for entries in the crush zone that are not finite, before any state is written.
class FiniteCheck {
  public:
    FiniteCheck(const QuasiStatic& solver, const Batch& batch)
        : batch_(batch),
          largest_(solver.grid(), solver.material(), solver.options().scheme),
          begin_(solver.grid().bins()),
          end_(begin_.size()) {
        double load = 0.0;
        for (Index b = 0; b < batch.states.count(); ++b) {
            if (moves(batch, b)) load = std::max(load, batch.stress_ratio[b]);
        }
        largest_.set_load(load);
        for (Index m = 0; m < solver.grid().bins(); ++m) {
            const Index reach = m - largest_.last(m);
            begin_[m] = reach;
            for (Index i = reach; i <= m; ++i) end_[i] = m + 1;
        }
    }

    bool passes(Index b) const {
        // Zones are nested, so a state that is finite in the largest zone is finite in its own.
        if (!moves(batch_, b) || !first_bad(b, nullptr)) return true;
        const ActiveBand own = zone_of(b);
        return !first_bad(b, &own);
    }

    void refuse(Index b) const {
        const ActiveBand own = zone_of(b);
        const auto [i, j] = *first_bad(b, &own);
        require_finite(batch_.states[b](i, j), "states", {b, i, j});
    }

  private:
    ActiveBand zone_of(Index b) const {
        ActiveBand own = largest_;
        own.set_load(batch_.stress_ratio[b]);
        return own;
    }

    std::optional<std::pair<Index, Index>> first_bad(Index b, const ActiveBand* zone) const {
        const MatrixView<const double> state = batch_.states[b];
        for (Index i = 0; i < state.rows(); ++i) {
            for (Index j = begin_[i]; j < end_[i]; ++j) {
                if (std::isfinite(state(i, j))) continue;
                if (zone == nullptr || std::abs(i - j) <= zone->last(std::max(i, j))) return {{i, j}};
            }
        }
        return std::nullopt;
    }

    const Batch& batch_;
    ActiveBand largest_;
    Array<Index> begin_;  // (N) first column of the largest zone in each row
    Array<Index> end_;    // (N) one past the last
};

// Order of the states by their loads, before and after: those with the same two use the same zones, which cost as much as
// a small sweep.
Array<Index> by_load(const Batch& batch) {
    Array<Index> order(batch.states.count());
    std::iota(order.begin(), order.end(), Index{0});
    const auto loads = [&](Index b) {
        return std::pair(batch.stress_ratio[b], settled_at(batch, b).value_or(0.0));
    };
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return loads(a) < loads(b); });
    return order;
}

}  // namespace

BatchSolver::BatchSolver(QuasiStatic solver) {
    workers_.push_back(std::move(solver));
}

bool BatchSolver::solve(const Batch& batch, StackView<double> out, VectorView<SolveReport> reports,
                        const BatchOptions& options) {
    require_fit(batch, reports, options);
    require_stack(out, batch.states.count(), solver().grid().bins(), "out");
    if (out.count() > 0) require_same_or_apart(by_state(batch.states), by_state(out));
    return run(batch, options, [&](QuasiStatic& worker, Index b) {
        const SolveReport report =
            worker.solve(batch.states[b], batch.stress_ratio[b], settled_at(batch, b), out[b]);
        if (reports.size() > 0) reports[b] = report;
    });
}

bool BatchSolver::marginal(const Batch& batch, MatrixView<double> grainsize, VectorView<SolveReport> reports,
                           const BatchOptions& options) {
    const Index bins = solver().grid().bins();
    require_fit(batch, reports, options);
    if (grainsize.rows() != batch.states.count() || grainsize.cols() != bins || grainsize.stride() < bins) {
        throw ShapeError({.parameter = "grainsize",
                          .value = shape_text(grainsize.rows(), grainsize.cols()),
                          .finding = "has shape " + shape_text(grainsize.rows(), grainsize.cols()) +
                                     ", rows a stride of " + std::to_string(grainsize.stride()) + " apart",
                          .rule = "it must have " + shape_text(batch.states.count(), bins)});
    }
    if (grainsize.rows() > 0 && overlap(by_state(batch.states), grainsize)) {
        throw ShapeError(
            {.parameter = "grainsize", .finding = "overlaps the states", .remedy = Remedy::use_own_memory});
    }
    return run(batch, options, [&](QuasiStatic& worker, Index b) {
        const VectorView<double> to(grainsize.row(b), bins);
        const SolveReport report =
            worker.marginal(batch.states[b], batch.stress_ratio[b], settled_at(batch, b), to);
        if (reports.size() > 0) reports[b] = report;
    });
}

void BatchSolver::require_fit(const Batch& batch, VectorView<SolveReport> reports,
                              const BatchOptions& options) const {
    const Index count = batch.states.count();
    require(options.threads >= 1, "threads", static_cast<double>(options.threads), "at least 1");
    require_stack(batch.states, count, solver().grid().bins(), "states");
    require_count(batch.stress_ratio.size(), count, "stress_ratio");
    if (batch.settled_at.size() > 0) require_count(batch.settled_at.size(), count, "settled_at");
    if (reports.size() > 0) require_count(reports.size(), count, "reports");
    require_loads(batch.stress_ratio, "stress_ratio");
    require_loads(batch.settled_at, "settled_at");
}

bool BatchSolver::run(const Batch& batch, const BatchOptions& options, const Work& work) {
    const Index count = batch.states.count();
    const FiniteCheck check(solver(), batch);
    std::atomic<Index> refused{count};
    const bool looked = for_each_state(count, options, [&](QuasiStatic&, Index b) {
        if (check.passes(b)) return;
        Index first = refused;
        while (b < first && !refused.compare_exchange_weak(first, b)) {
        }
    });
    if (refused < count) check.refuse(refused);
    if (!looked) return false;
    const Array<Index> order = by_load(batch);
    return for_each_state(count, options, [&](QuasiStatic& worker, Index turn) {
        const Index b = order[turn];
        try {
            work(worker, b);
        } catch (const ParameterError& error) {
            throw ParameterError(within(entry("states", {b}), error.fault()));
        }
    });
}

// Threads fetch blocks of states when they are free, since states under a large load take longer.
bool BatchSolver::for_each_state(Index count, const BatchOptions& options, const Work& work) {
    const Index blocks = (count + states_at_a_time - 1) / states_at_a_time;
    const auto threads = static_cast<std::size_t>(std::clamp<Index>(blocks, 1, options.threads));
    while (workers_.size() < threads) workers_.push_back(workers_.front());
    std::atomic<Index> next{0};
    std::atomic<Index> done{0};
    for_each_index(
        threads, threads,
        [&](std::size_t thread, const std::function<bool()>& ask) {
            for (Index begin = 0; (begin = states_at_a_time * next++) < count;) {
                if (!ask()) return;
                const Index end = std::min(begin + states_at_a_time, count);
                for (Index b = begin; b < end; ++b) work(workers_[thread], b);
                done += end - begin;
            }
        },
        options.go_on);
    return done == count;
}

}  // namespace comminute
