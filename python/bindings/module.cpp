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
    register_errors(m);
    register_model(m);
    register_zones(m);
    register_fabric(m);
    register_gradings(m);
    register_stepping(m);
    register_sweeping(m);
    register_lattice(m);
}
