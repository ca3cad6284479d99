// SPDX-License-Identifier: BSD-3-Clause
// Steps repeated until a state is at rest (docs/theory/one_sweep.md, section 13).
#include "comminute/settle.hpp"

#include <cmath>
#include <numeric>

#include "base/check.hpp"

namespace comminute {

using namespace detail;

namespace {

template <class Engine>
StepReport repeat(Engine& engine, MatrixView<double> state, double stress_ratio, Index steps,
                  const std::function<bool()>& go_on) {
    require(steps >= 0, "steps", static_cast<double>(steps), "at least 0 (0 means until at rest)");
    require_square(state, engine.kernel().grid().bins(), "state");
    double total = 0.0;
    for (Index i = 0; i < state.rows(); ++i)
        total = std::accumulate(state.row(i), state.row(i) + state.cols(), total);
    require(std::isfinite(total), "the total of the state", total, "finite, and so must every entry");
    StepReport sum;
    while ((steps == 0 || sum.steps < steps) && (!go_on || go_on())) {
        const StepReport step = engine.step(state, stress_ratio, state);
        sum.active = step.active;
        sum.crushed += step.crushed;
        sum.crushed_neighbour += step.crushed_neighbour;
        sum.terms = step.terms;
        ++sum.steps;
        if (steps == 0 && step.active <= rest_tolerance * total) break;
    }
    return sum;
}

}  // namespace

StepReport settle(SlowUpdate& engine, MatrixView<double> state, double stress_ratio, Index steps,
                  const std::function<bool()>& go_on) {
    return repeat(engine, state, stress_ratio, steps, go_on);
}

StepReport settle(FullConvolution& engine, MatrixView<double> state, double stress_ratio, Index steps,
                  const std::function<bool()>& go_on) {
    return repeat(engine, state, stress_ratio, steps, go_on);
}

}  // namespace comminute
