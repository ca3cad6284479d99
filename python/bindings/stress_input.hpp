// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <functional>

#include "bindings.hpp"

/// A stress as Python gives it: tensors, p with q, or a vertical stress with k0. What is not given is None.
struct GivenStress {
    const char* name;   ///< parameter of the tensors
    py::object tensor;  ///< (..., 3, 3), or (..., 6): xx yy zz yz xz xy
    py::object p;
    py::object q;
    py::object vertical;
    py::object k0;
    bool compression_positive;  ///< in tensors; p, q and vertical always are
};

/// The ways of the core from a stress of each kind to a scalar: StressMeasure's or StressScale's.
struct WaysToScalar {
    std::function<void(comminute::MatrixView<const double>, comminute::VectorView<double>,
                       comminute::StressSign)>
        tensors;
    std::function<double(double p, double q)> pq;
    std::function<double(double vertical, double k0)> vertical;
};

/// Scalar of every stress: a float for one, else an array.
/// @throws ParameterError unless one kind is given whole, with finite numbers, symmetric tensors and k0 >= 0
/// @throws ShapeError for tensors of another shape, or pairs whose shapes do not fit
py::object scalar_of(const GivenStress& given, const WaysToScalar& ways);

/// Shape of tensors, whatever there is before: its last axes are 3, 3 or 6.
bool holds_tensors(const py::array& array);
