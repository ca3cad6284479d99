// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.hpp"

void tell_defaults(py::module_& m, const char* function, const py::dict& values) {
    const auto read_only = py::module_::import("types").attr("MappingProxyType");
    py::dict all;
    if (py::hasattr(m, "defaults")) all.attr("update")(m.attr("defaults"));
    all[function] = read_only(values);
    m.attr("defaults") = read_only(all);
}

PYBIND11_MODULE(_core, m) {
    m.doc() = "The C++ core of comminute; import comminute instead.";
    m.attr("__version__") = comminute::version;
    m.attr("has_fftw") = comminute::has_fftw();
    py::register_exception<comminute::ParameterError>(m, "ParameterError", PyExc_ValueError).attr("__doc__") =
        "A parameter outside its range; the message gives its value and the rule.";
    py::register_exception<comminute::ShapeError>(m, "ShapeError", PyExc_ValueError).attr("__doc__") =
        "An array whose shape, order or overlap does not fit; the message gives both shapes.";
    py::register_exception<comminute::UnavailableError>(m, "UnavailableError", PyExc_RuntimeError)
        .attr("__doc__") = "A part that this build leaves out; the message says how to get it.";
    register_model(m);
    register_zones(m);
    register_fabric(m);
    register_gradings(m);
    register_stepping(m);
    register_sweeping(m);
    register_lattice(m);
}
