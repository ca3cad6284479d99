// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "interrupt.hpp"
#include "words.hpp"

/// The arrays of a batch, held while it runs: (B, N, N) states, and a load of each or one for all.
class ManyStates {
  public:
    ManyStates(const py::object& states, const py::object& stress_ratio, const py::object& settled_at,
               comminute::Index bins)
        : states_(strict_array(states, shape_of(states, bins), "states")),
          stress_ratio_(loads(stress_ratio, "stress_ratio")) {
        if (!settled_at.is_none()) settled_at_ = loads(settled_at, "settled_at");
    }

    comminute::Index count() const { return states_.shape(0); }
    std::vector<py::ssize_t> shape() const { return {count(), states_.shape(1), states_.shape(2)}; }
    comminute::Batch batch() const {
        const comminute::VectorView<const double> never(nullptr, 0);
        return {{states_.data(), count(), states_.shape(1)},
                {stress_ratio_.data(), count()},
                settled_at_ ? comminute::VectorView<const double>(settled_at_->data(), count()) : never};
    }

  private:
    static std::vector<py::ssize_t> shape_of(const py::object& states, comminute::Index bins) {
        const bool stacked =
            py::isinstance<py::array>(states) && py::reinterpret_borrow<py::array>(states).ndim() == 3;
        return {stacked ? py::reinterpret_borrow<py::array>(states).shape(0) : 1, bins, bins};
    }

    py::array_t<double> loads(const py::object& given, const char* name) const {
        if (!py::isinstance<py::float_>(given) && !py::isinstance<py::int_>(given)) {
            return strict_array(given, {count()}, name, "the batch");
        }
        py::array_t<double> same(count());
        std::fill_n(same.mutable_data(), count(), given.cast<double>());
        return same;
    }

    py::array_t<double> states_;
    py::array_t<double> stress_ratio_;
    std::optional<py::array_t<double>> settled_at_;
};

/// A solver with its workspaces behind a lock, since the GIL does not guard them while it runs.
class Solver {
  public:
    explicit Solver(comminute::QuasiStatic solver) : solver_(std::move(solver)) {}

    const comminute::QuasiStatic& get() const { return solver_; }

    comminute::SolveReport report() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return report_;
    }

    comminute::Fabric solve(const comminute::Fabric& state, double stress_ratio,
                            std::optional<double> settled_at, const py::object& out) {
        if (!out.is_none())
            throw py::type_error("out belongs to an array; a Fabric is never changed in place");
        refuse_second_load(settled_at);
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return solver_.solve(state, stress_ratio, &report_);
    }

    py::array_t<double> solve_array(const py::object& state, double stress_ratio,
                                    std::optional<double> settled_at, const py::object& out) {
        const auto before = strict_array(state, shape(), "state");
        auto after = strict_out(out, shape(), "out");
        const auto from = matrix_in(before);
        const auto to = matrix_out(after);
        {
            const py::gil_scoped_release release;
            const std::lock_guard lock(mutex_);
            report_ = solver_.solve(from, stress_ratio, settled_at, to);
        }
        return after;
    }

    comminute::Marginal grading_after(const comminute::Fabric& state, double stress_ratio) {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        comminute::Marginal marginal = solver_.marginal(state, stress_ratio);
        report_ = marginal.report;
        return marginal;
    }

    std::vector<comminute::Marginal> gradings_after(const comminute::Fabric& state,
                                                    const std::vector<double>& stress_ratios) {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        std::vector<comminute::Marginal> marginals = solver_.marginals(state, stress_ratios);
        if (!marginals.empty()) report_ = marginals.back().report;
        return marginals;
    }

    py::array_t<double> marginal(const comminute::Fabric& state, double stress_ratio,
                                 std::optional<double> settled_at) {
        refuse_second_load(settled_at);
        return copied(grading_after(state, stress_ratio).grainsize);
    }

    py::array_t<double> marginal_of_array(const py::object& state, double stress_ratio,
                                          std::optional<double> settled_at) {
        const auto before = strict_array(state, shape(), "state");
        const auto from = matrix_in(before);
        py::array_t<double> after(solver_.grid().bins());
        const comminute::VectorView<double> to(after.mutable_data(), solver_.grid().bins());
        {
            const py::gil_scoped_release release;
            const std::lock_guard lock(mutex_);
            report_ = solver_.marginal(from, stress_ratio, settled_at, to);
        }
        return after;
    }

    py::array_t<double> solve_batch(const py::object& states, const py::object& stress_ratio,
                                    const py::object& settled_at, const py::object& out,
                                    comminute::Index threads, const std::string& bad_states) {
        const ManyStates given(states, stress_ratio, settled_at, solver_.grid().bins());
        auto after = strict_out(out, given.shape(), "out");
        const comminute::StackView<double> to(after.mutable_data(), given.count(), solver_.grid().bins());
        run_batch(given, threads, choice_of<BadStates>(bad_states),
                  [&](auto&&... rest) { batch_->solve(given.batch(), to, rest...); });
        return after;
    }

    py::array_t<double> marginal_batch(const py::object& states, const py::object& stress_ratio,
                                       const py::object& settled_at, const py::object& out,
                                       comminute::Index threads, const std::string& bad_states) {
        const ManyStates given(states, stress_ratio, settled_at, solver_.grid().bins());
        auto after = strict_out(out, {given.count(), solver_.grid().bins()}, "out");
        const comminute::MatrixView<double> to = matrix_out(after);
        run_batch(given, threads, choice_of<BadStates>(bad_states),
                  [&](auto&&... rest) { batch_->marginal(given.batch(), to, rest...); });
        return after;
    }

    std::vector<comminute::SolveReport> reports() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return reports_;
    }

    std::vector<double> settled_at() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return settled_at_;
    }

    std::map<comminute::Index, comminute::Fault> faults() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return batch_ ? batch_->faults() : std::map<comminute::Index, comminute::Fault>();
    }

  private:
    template <class Call>
    void run_batch(const ManyStates& given, comminute::Index threads, BadStates bad, const Call& call) {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        if (!batch_) batch_.emplace(solver_);
        const auto count = static_cast<std::size_t>(given.count());
        std::vector<comminute::SolveReport> reports(count);
        std::vector<double> settled(count);
        std::vector<comminute::StateStatus> status(bad == BadStates::keep ? count : 0);
        call(comminute::BatchOutcome{settled, reports, status},
             comminute::BatchOptions{threads, Interrupt()});
        reports_ = std::move(reports);
        settled_at_ = std::move(settled);
    }

    static void refuse_second_load(std::optional<double> settled_at) {
        if (settled_at) {
            throw comminute::ParameterError({.parameter = "settled_at",
                                             .value = comminute::text(*settled_at),
                                             .number = *settled_at,
                                             .rule = "a Fabric carries its own",
                                             .remedy = comminute::Remedy::leave_out});
        }
    }

    std::vector<py::ssize_t> shape() const { return {solver_.grid().bins(), solver_.grid().bins()}; }

    comminute::QuasiStatic solver_;
    std::optional<comminute::BatchSolver> batch_;
    std::mutex mutex_;
    comminute::SolveReport report_;
    std::vector<comminute::SolveReport> reports_;
    std::vector<double> settled_at_;
};
