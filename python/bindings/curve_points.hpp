// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <tuple>

#include "bindings.hpp"

/// Points of a curve as Python has them: sizes, fractions finer, slope of the tail.
using Points = std::tuple<py::array_t<double>, py::array_t<double>, double>;

inline comminute::CurvePoints points_of(const Points& points) {
    const auto& [size, finer, tail_slope] = points;
    return {
        {size.data(), size.data() + size.size()}, {finer.data(), finer.data() + finer.size()}, tail_slope};
}
