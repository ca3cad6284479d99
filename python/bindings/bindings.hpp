// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <string>

#include "comminute/comminute.hpp"

namespace py = pybind11;

void register_errors(py::module_& m);

/// The ParameterError of a fault, not raised.
py::object parameter_error(const comminute::Fault& fault);

// One function for each room of the library that Python sees, in the order of the rooms.
void register_model(py::module_& m);
void register_zones(py::module_& m);
void register_fabric(py::module_& m);
void register_gradings(py::module_& m);
void register_stepping(py::module_& m);
void register_sweeping(py::module_& m);
void register_resolved(py::module_& m);
void register_points(py::module_& m);
void register_lattice(py::module_& m);

/// Adds the defaults of a function's parameters to `_core.defaults`. Python reads them there, since the signature of a
/// bound function tells them in its text only.
void tell_defaults(py::module_& m, const char* function, const py::dict& values);

/// Python's own text of a value, for reprs: repr_of("Material", "weibull_modulus", 3.0, ...).
template <class... Fields>
std::string repr_of(const char* type, const Fields&... fields) {
    const py::tuple parts = py::make_tuple(fields...);
    std::string out = std::string(type) + "(";
    for (std::size_t f = 0; f + 1 < parts.size(); f += 2) {
        out +=
            (f == 0 ? "" : ", ") + std::string(py::str(parts[f])) + "=" + std::string(py::repr(parts[f + 1]));
    }
    return out + ")";
}
