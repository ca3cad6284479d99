// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.hpp"

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
    register_resolved(m);
    register_points(m);
    register_lattice(m);
}
