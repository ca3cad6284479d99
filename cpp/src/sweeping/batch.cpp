// SPDX-License-Identifier: BSD-3-Clause
// Many states on several threads, each by the same sweep (docs/theory/one_sweep.md, section 14).
#include "comminute/batch.hpp"

#include <algorithm>
#include <atomic>
#include <limits>
#include <mutex>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>

#include "base/arrays.hpp"
#include "base/check.hpp"
#include "base/workers.hpp"
#include "sweeping/marginal.hpp"
#include "sweeping/mass_check.hpp"
#include "sweeping/solver_work.hpp"
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

double largest_of(const Batch& batch, Index b) {
    return batch.largest.size() == 0 ? 0.0 : batch.largest[b];
}

bool moves(const Batch& batch, Index b) {
    const std::optional<double> settled = settled_at(batch, b);
    return !settled || batch.stress_ratio[b] > *settled;
}

void require_count(Index found, Index count, const char* list) {
    require_entries(found, count, entry(list), "there are " + std::to_string(count) + " states");
}

bool is_load(double load) {
    return load >= 0.0;
}

Fault load_fault(double load, const char* list, Index b) {
    return {.parameter = list,
            .value = text(load),
            .number = load,
            .rule = "it must be a number of at least 0 (0 is no load)",
            .place = {entry(list, {b})}};
}

void require_loads(VectorView<const double> loads, const char* list) {
    for (Index b = 0; b < loads.size(); ++b) {
        if (!is_load(loads[b])) throw ParameterError(load_fault(loads[b], list, b));
    }
}

/// A reason not to solve a state, and its fault.
struct Bad {
    StateStatus status;
    Fault fault;
};

std::optional<Bad> bad_of(const Batch& batch, Index b) {
    if (!is_load(batch.stress_ratio[b])) {
        return Bad{StateStatus::bad_load, load_fault(batch.stress_ratio[b], "stress_ratio", b)};
    }
    if (const double settled = settled_at(batch, b).value_or(0.0); !is_load(settled)) {
        return Bad{StateStatus::bad_load, load_fault(settled, "settled_at", b)};
    }
    if (const auto bad = first_bad_mass(batch.states[b])) {
        const auto [i, j] = *bad;
        return Bad{StateStatus::bad_state, mass_fault(batch.states[b](i, j), "states", {b, i, j}, false)};
    }
    return std::nullopt;
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
    if (stack.stride() >= bins * bins || (std::is_const_v<T> && stack.stride() == 0)) return;
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

/// Search for entries in the crush zone that are no masses, before any state is written.
class ZoneCheck {
  public:
    ZoneCheck(const QuasiStatic& solver, const Batch& batch)
        : batch_(batch),
          largest_(solver.grid(), solver.material(), solver.options().scheme),
          extent_(solver.grid().bins()) {
        double load = 0.0;
        for (Index b = 0; b < batch.states.count(); ++b) {
            if (moves(batch, b)) load = std::max(load, batch.stress_ratio[b]);
        }
        largest_.set_load(load);
        extent_.set(largest_);
    }

    std::optional<Cell> first_bad(Index b) const {
        // Zones are nested, so a state that passes in the largest zone passes in its own.
        if (!moves(batch_, b) || !first_bad_mass(batch_.states[b], largest_, extent_)) return std::nullopt;
        ActiveBand own = largest_;
        own.set_load(batch_.stress_ratio[b], largest_of(batch_, b));
        ZoneExtent extent = extent_;
        extent.set(own);
        return first_bad_mass(batch_.states[b], own, extent);
    }

  private:
    const Batch& batch_;
    ActiveBand largest_;
    ZoneExtent extent_;
};

// Order of the states by their loads, before and after, and the size that no grain exceeds: those with the same three use the same zones, which cost as much as
// a small sweep.
Array<Index> by_load(const Batch& batch) {
    Array<Index> order(batch.states.count());
    std::iota(order.begin(), order.end(), Index{0});
    const auto comparable = [](double load) { return is_load(load) ? load : -1.0; };
    const auto loads = [&](Index b) {
        return std::tuple(comparable(batch.stress_ratio[b]), comparable(settled_at(batch, b).value_or(0.0)),
                          largest_of(batch, b));
    };
    std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return loads(a) < loads(b); });
    return order;
}

}  // namespace

BatchSolver::BatchSolver(QuasiStatic solver) {
    workers_.push_back(std::move(solver));
}

/// One call of a batch: its input, and the places of its results.
struct BatchSolver::Run {
    const Batch& batch;
    const BatchOutcome& outcome;
    StackView<double>* states;     // null where gradings are wanted
    MatrixView<double>* gradings;  // null where states are wanted
    std::mutex* of_faults;

    bool one_by_one() const { return outcome.status.size() > 0; }

    // The outcome of a state that is not solved.
    void leave_alone(Index b) const {
        const Index bins = batch.states.bins();
        if (gradings != nullptr) {
            std::fill_n(gradings->row(b), bins, std::numeric_limits<double>::quiet_NaN());
        } else if ((*states)[b].data() != batch.states[b].data()) {
            std::copy_n(batch.states[b].data(), bins * bins, (*states)[b].data());
        }
        finish(b, settled_at(batch, b).value_or(0.0), {});
    }
    void finish(Index b, double settled, const SolveReport& report) const {
        if (outcome.settled_at.size() > 0) outcome.settled_at[b] = settled;
        if (outcome.reports.size() > 0) outcome.reports[b] = report;
        if (one_by_one()) outcome.status[b] = StateStatus::at_rest;
    }
};

bool BatchSolver::solve(const Batch& batch, StackView<double> out, const BatchOutcome& outcome,
                        const BatchOptions& options) {
    const Index bins = solver().grid().bins();
    require_fit(batch, outcome, options);
    require_count(outcome.settled_at.size(), batch.states.count(), "settled_at of the outcome");
    require_stack(out, batch.states.count(), bins, "out");
    if (out.count() > 0) require_same_or_apart(by_state(batch.states), by_state(out));
    std::mutex of_faults;
    return run({batch, outcome, &out, nullptr, &of_faults}, options);
}

bool BatchSolver::marginal(const Batch& batch, MatrixView<double> grainsize, const BatchOutcome& outcome,
                           const BatchOptions& options) {
    const Index bins = solver().grid().bins();
    require_fit(batch, outcome, options);
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
    std::mutex of_faults;
    return run({batch, outcome, nullptr, &grainsize, &of_faults}, options);
}

void BatchSolver::require_fit(const Batch& batch, const BatchOutcome& outcome,
                              const BatchOptions& options) const {
    const Index count = batch.states.count();
    require(options.threads >= 1, "threads", static_cast<double>(options.threads), "at least 1");
    require_stack(batch.states, count, solver().grid().bins(), "states");
    require_count(batch.stress_ratio.size(), count, "stress_ratio");
    if (batch.settled_at.size() > 0) require_count(batch.settled_at.size(), count, "settled_at");
    if (batch.largest.size() > 0) require_count(batch.largest.size(), count, "largest");
    for (const double largest : batch.largest) require_largest(largest);
    if (outcome.settled_at.size() > 0)
        require_count(outcome.settled_at.size(), count, "settled_at of the outcome");
    if (outcome.reports.size() > 0) require_count(outcome.reports.size(), count, "reports");
    if (outcome.status.size() > 0) require_count(outcome.status.size(), count, "status");
}

bool BatchSolver::refuse_bad(const Batch& batch, const BatchOptions& options) {
    require_loads(batch.stress_ratio, "stress_ratio");
    require_loads(batch.settled_at, "settled_at");
    const Index count = batch.states.count();
    const ZoneCheck check(solver(), batch);
    std::atomic<Index> refused{count};
    const bool looked = for_each_block(count, options, [&](QuasiStatic&, Index begin, Index end) {
        for (Index b = begin; b < end; ++b) {
            if (!check.first_bad(b)) continue;
            Index first = refused;
            while (b < first && !refused.compare_exchange_weak(first, b)) {
            }
        }
    });
    if (const Index b = refused; b < count) {
        const auto [i, j] = *check.first_bad(b);
        throw ParameterError(mass_fault(batch.states[b](i, j), "states", {b, i, j}, true));
    }
    return looked;
}

bool BatchSolver::run(const Run& run, const BatchOptions& options) {
    faults_.clear();
    std::fill(run.outcome.status.begin(), run.outcome.status.end(), StateStatus::waiting);
    if (!run.one_by_one() && !refuse_bad(run.batch, options)) return false;
    const Array<Index> order = by_load(run.batch);
    return for_each_block(run.batch.states.count(), options,
                          [&](QuasiStatic& worker, Index begin, Index end) {
                              solve_some(worker, run, {order.data() + begin, end - begin});
                          });
}

void BatchSolver::solve_some(QuasiStatic& worker, const Run& run, VectorView<const Index> states) {
    const Batch& batch = run.batch;
    const Index bins = batch.states.bins();
    const Arrivals none;
    std::vector<Task> tasks;
    std::vector<Index> of;
    std::vector<MatrixView<double>> out;
    std::vector<std::vector<double>> gradings;
    out.reserve(static_cast<std::size_t>(states.size()));
    gradings.reserve(static_cast<std::size_t>(states.size()));
    for (const Index b : states) {
        if (std::optional<Bad> bad = run.one_by_one() ? bad_of(batch, b) : std::nullopt) {
            run.leave_alone(b);
            run.outcome.status[b] = bad->status;
            const std::lock_guard lock(*run.of_faults);
            faults_.emplace(b, std::move(bad->fault));
            continue;
        }
        const double settled = settled_at(batch, b).value_or(0.0);
        if (run.gradings != nullptr) gradings.push_back(row_sums(batch.states[b]));
        if (!moves(batch, b)) {
            run.leave_alone(b);
            if (run.gradings != nullptr) std::copy_n(gradings.back().begin(), bins, run.gradings->row(b));
            continue;
        }
        if (run.states != nullptr) out.push_back((*run.states)[b]);
        of.push_back(b);
        tasks.push_back({{settled, batch.stress_ratio[b], largest_of(batch, b)},
                         batch.states[b],
                         &none,
                         run.gradings != nullptr ? &gradings.back() : nullptr,
                         run.states != nullptr ? &out.back() : nullptr,
                         {}});
    }
    worker.work_->settle(tasks);
    for (std::size_t k = 0; k < tasks.size(); ++k) {
        const Index b = of[k];
        try {
            require_finite_sum(tasks[k].report);
        } catch (const ParameterError& error) {
            throw ParameterError(within(entry("states", {b}), error.fault()));
        }
        if (run.gradings != nullptr) std::copy_n(tasks[k].grading->begin(), bins, run.gradings->row(b));
        run.finish(b, tasks[k].loads.stress_ratio, tasks[k].report);
    }
}

// Threads fetch blocks of states when they are free, since states under a large load take longer.
bool BatchSolver::for_each_block(Index count, const BatchOptions& options, const Work& work) {
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
                work(workers_[thread], begin, end);
                done += end - begin;
            }
        },
        options.go_on);
    return done == count;
}

}  // namespace comminute
