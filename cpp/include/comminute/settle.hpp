// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "comminute/export.hpp"
#include "comminute/full_convolution.hpp"
#include "comminute/slow_update.hpp"

namespace comminute {

/// Share of the whole mass: a state is at rest under a load once less than this lies inside the zone.
inline constexpr double rest_tolerance = 1e-18;

/// Repeats an engine's step under one load until the state is at rest, or `steps` times.
///
/// @param state   (N, N), updated in place
/// @param steps   number of steps; 0 repeats until the state is at rest (see rest_tolerance)
/// @param go_on   called before each step; if it returns false the run stops there, with a valid state
/// @return        sums over the steps; `active` is the mass that the last step found inside the zone
/// @throws ParameterError for a negative number of steps, and all that the engine's step() throws
///
/// @code{.cpp}
/// comminute::LogGrid grid(-12.0, 0.0, 128);
/// comminute::SlowUpdate engine(grid, comminute::Material{});
/// std::vector<double> p(128 * 128, 0.0);
/// p.back() = 1.0;   // s = 1 among equals
/// auto report = comminute::settle(engine, {p.data(), 128, 128}, 8.0);
/// CHECK(report.steps > 1);
/// CHECK(report.active < 1e-18);
/// @endcode
COMMINUTE_API StepReport settle(SlowUpdate& engine, MatrixView<double> state, double stress_ratio,
                                Index steps = 0, const std::function<bool()>& go_on = {});
COMMINUTE_API StepReport settle(FullConvolution& engine, MatrixView<double> state, double stress_ratio,
                                Index steps = 0, const std::function<bool()>& go_on = {});

}  // namespace comminute
