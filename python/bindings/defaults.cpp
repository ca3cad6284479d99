// SPDX-License-Identifier: BSD-3-Clause
#include "bindings.hpp"

void tell_defaults(py::module_& m, const char* function, const py::dict& values) {
    const auto read_only = py::module_::import("types").attr("MappingProxyType");
    py::dict all;
    if (py::hasattr(m, "defaults")) all.attr("update")(m.attr("defaults"));
    all[function] = read_only(values);
    m.attr("defaults") = read_only(all);
}
