// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "rooms.hpp"

namespace {

using comminute::Index;
using comminute::LogGrid;

py::array_t<double> centres(const LogGrid& grid) {
    py::array_t<double> out(grid.bins());
    for (Index i = 0; i < grid.bins(); ++i) out.mutable_at(i) = grid.centre(i);
    return out;
}

py::array_t<double> edges(const LogGrid& grid) {
    py::array_t<double> out(grid.bins() + 1);
    for (Index i = 0; i <= grid.bins(); ++i) out.mutable_at(i) = grid.edge(i);
    return out;
}

py::object exponential(const py::array_t<double>& a) {
    return py::module_::import("numpy").attr("exp")(a);
}

}  // namespace

void register_grid(py::module_& m) {
    py::class_<LogGrid>(m, "LogGrid", R"doc(Evenly spaced bins of log grainsize psi = ln s.

The same bins serve both axes of the fabric. Bin 0 is the *fines bin*: it stands for every size
below its upper edge, so that no mass is ever dropped; in crush tests and means it stands for its
centre's size.

Parameters
----------
psi_min, psi_max : float
    Centres of the first and of the last bin, ln(size), size in the material's unit.
bins : int
    Number of bins N, at least 8.

Raises
------
ParameterError
    Unless both ends are finite, psi_min < psi_max and bins >= 8.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-6.0, 1.0, 351)
>>> grid.spacing
0.02
>>> grid.centres[300]
np.float64(0.0)
)doc")
        .def(py::init<double, double, Index>(), py::arg("psi_min"), py::arg("psi_max"), py::arg("bins"))
        .def_property_readonly("psi_min", &LogGrid::psi_min, "Centre of the first bin.")
        .def_property_readonly("psi_max", &LogGrid::psi_max, "Centre of the last bin.")
        .def_property_readonly("bins", &LogGrid::bins, "Number of bins, N.")
        .def_property_readonly("spacing", &LogGrid::spacing, "Bin width h in psi.")
        .def_property_readonly("centres", &centres, "(N,) centres of the bins, psi.")
        .def_property_readonly(
            "edges", &edges,
            "(N + 1,) edges of the bins, psi; the first is nominal, the fines bin has no lower end.")
        .def_property_readonly(
            "sizes", [](const LogGrid& g) { return exponential(centres(g)); }, "(N,) sizes at the centres.")
        .def_property_readonly(
            "edge_sizes", [](const LogGrid& g) { return exponential(edges(g)); },
            "(N + 1,) sizes at the edges.")
        .def("bin_of", &LogGrid::bin_of, py::arg("psi"), R"doc(Index of the bin that holds a log size.

Everything below the grid lies in bin 0.

Raises
------
ParameterError
    For a log size above the last edge, or NaN.
)doc")
        .def(
            "__eq__", [](const LogGrid& a, const LogGrid& b) { return a == b; }, py::is_operator())
        .def("__hash__",
             [](const LogGrid& g) { return py::hash(py::make_tuple(g.psi_min(), g.psi_max(), g.bins())); })
        .def("__repr__",
             [](const LogGrid& g) {
                 return repr_of("LogGrid", "psi_min", g.psi_min(), "psi_max", g.psi_max(), "bins", g.bins());
             })
        .def(py::pickle([](const LogGrid& g) { return py::make_tuple(g.psi_min(), g.psi_max(), g.bins()); },
                        [](const py::tuple& t) {
                            return LogGrid(t[0].cast<double>(), t[1].cast<double>(), t[2].cast<Index>());
                        }));
}
