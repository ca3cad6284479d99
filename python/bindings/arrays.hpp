// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/numpy.h>

#include <string>
#include <vector>

#include "bindings.hpp"

/// Arrays are taken as they are or not at all: float64, C order, the right shape. No silent copy.

/// @throws TypeError for anything but a float64 array, ShapeError for another shape or order
py::array_t<double> strict_array(const py::object& object, const std::vector<py::ssize_t>& shape,
                                 const char* name, const char* needed_by = "the grid");

/// The same, and writeable; None makes a new array.
py::array_t<double> strict_out(const py::object& object, const std::vector<py::ssize_t>& shape,
                               const char* name);

inline comminute::MatrixView<const double> matrix_in(const py::array_t<double>& a) {
    return {a.data(), a.shape(0), a.shape(1)};
}

inline comminute::MatrixView<double> matrix_out(py::array_t<double>& a) {
    return {a.mutable_data(), a.shape(0), a.shape(1)};
}

/// A new array that owns a copy of the numbers.
inline py::array_t<double> copied(const std::vector<double>& values) {
    return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data());
}

/// A read-only view that keeps `owner` alive.
py::array_t<double> read_only_view(const double* data, const std::vector<py::ssize_t>& shape,
                                   const py::object& owner);

/// Numbers of any kind as an array of their own, for states that are stored.
template <class T>
py::array_t<T> array_of(const std::vector<T>& values) {
    return py::array_t<T>(static_cast<py::ssize_t>(values.size()), values.data());
}

template <class T>
std::vector<T> vector_of(const py::handle& object) {
    const auto array = object.cast<py::array_t<T, py::array::c_style>>();
    return {array.data(), array.data() + array.size()};
}
