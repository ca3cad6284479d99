// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <tuple>

#include "bindings.hpp"

/// Numbers in one piece, copied where the array has gaps or runs backwards.
using Contiguous = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Points of a curve as Python has them: sizes, fractions finer, slope of the tail.
using Points = std::tuple<Contiguous, Contiguous, double>;

inline comminute::CurvePoints points_of(const Points& points) {
    const auto& [size, finer, tail_slope] = points;
    return {
        {size.data(), size.data() + size.size()}, {finer.data(), finer.data() + finer.size()}, tail_slope};
}
