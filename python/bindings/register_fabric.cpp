// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

Fabric make_fabric(const LogGrid& grid, const py::object& probability, std::optional<double> settled_at,
                   const std::string& mean) {
    const auto p = strict_array(probability, {grid.bins(), grid.bins()}, "probability");
    return {grid, std::vector<double>(p.data(), p.data() + p.size()), settled_at, choice_of<Mean>(mean)};
}

}  // namespace

void register_fabric(py::module_& m) {
    py::class_<Fabric>(m, "Fabric",
                       R"doc(The grainsize fabric: mass by log grainsize and log neighbourhood grainsize.

Immutable.

Parameters
----------
grid : LogGrid
probability : ndarray (N, N)
    Shares of the mass [psi, psibar], float64 in C order, at least 0, adding up to 1 (to 1e-9).
    Copied.
settled_at : float, optional
    Largest stress ratio under which this state is at rest; None: never loaded.
mean : {"arithmetic", "geometric"}
    How two neighbours make a neighbourhood grainsize (Eq. 48 or 65), for `remix`.

Raises
------
TypeError, ShapeError, ParameterError
    For another dtype or shape, a negative entry, or another sum; the message gives the place.

Examples
--------
>>> import numpy as np
>>> import comminute as cm
>>> fabric = cm.Fabric(cm.LogGrid(-6.0, 0.0, 16), np.full((16, 16), 1 / 256))
>>> fabric.grainsize()[:2]
array([0.0625, 0.0625])
)doc")
        .def(py::init(&make_fabric), py::arg("grid"), py::arg("probability"), py::kw_only(),
             py::arg("settled_at") = py::none(), py::arg("mean") = "arithmetic")
        .def_property_readonly("grid", &Fabric::grid, "The LogGrid.")
        .def_property_readonly("settled_at", &Fabric::settled_at,
                               "Largest stress ratio under which this state is at rest; None: never loaded.")
        .def_property_readonly(
            "mean", [](const Fabric& f) { return word_of(f.mean()); }, "\"arithmetic\" or \"geometric\".")
        .def_property_readonly(
            "probability",
            [](const py::object& self) {
                const auto view = self.cast<const Fabric&>().probability();
                return read_only_view(view.data(), {view.rows(), view.cols()}, self);
            },
            "(N, N) shares of the mass [psi, psibar]; a read-only view.")
        .def(
            "grainsize",
            [](const Fabric& f) {
                return copied({f.grainsize().begin(), f.grainsize().end()});
            },
            "(N,) mass by grainsize, the marginal over psibar (Eq. 62).")
        .def(
            "neighbourhood", [](const Fabric& f) { return copied(f.neighbourhood()); },
            "(N,) mass by neighbourhood grainsize, the marginal over psi.")
        .def(
            "cdf", [](const Fabric& f) { return copied(f.cdf()); },
            "(N,) mass fraction finer than the upper edge of each bin.")
        .def(
            "__eq__", [](const Fabric& a, const Fabric& b) { return a == b; }, py::is_operator())
        .def("__repr__",
             [](const Fabric& f) {
                 return repr_of("Fabric", "grid", f.grid(), "settled_at", f.settled_at(), "mean",
                                word_of(f.mean()));
             })
        .def(py::pickle(
            [](const py::object& self) {
                const auto& f = self.cast<const Fabric&>();
                return py::make_tuple(f.grid(), self.attr("probability"), f.settled_at(), word_of(f.mean()));
            },
            [](const py::tuple& t) {
                return make_fabric(t[0].cast<LogGrid>(), t[1], t[2].cast<std::optional<double>>(),
                                   t[3].cast<std::string>());
            }));

    m.def(
        "neighbourhood_pmf",
        [](const LogGrid& grid, const py::object& grainsize, const std::string& mean) {
            const auto pmf = strict_array(grainsize, {grid.bins()}, "grainsize");
            return copied(neighbourhood_pmf(grid, VectorView<const double>(pmf.data(), pmf.size()),
                                            choice_of<Mean>(mean)));
        },
        py::arg("grid"), py::arg("grainsize"), py::kw_only(), py::arg("mean") = "arithmetic",
        R"doc(Law of the neighbourhood grainsize of two independent neighbours (Eqs. 48, 65, 66).

Bins act as points at their centres, the fines bin too. Each pair is shared between the two nearest
centres such that the mean is kept: E[sbar] = E[s], or E[psibar] = E[psi] for the geometric mean.

Parameters
----------
grid : LogGrid
grainsize : ndarray (N,)
    Mass by bin.
mean : {"arithmetic", "geometric"}

Returns
-------
ndarray (N,)

Raises
------
TypeError, ShapeError, ParameterError
    For another dtype, shape or word.

Examples
--------
>>> import numpy as np
>>> import comminute as cm
>>> grid = cm.LogGrid(-6.0, 0.0, 61)
>>> pmf = np.full(61, 1 / 61)
>>> neighbours = cm.neighbourhood_pmf(grid, pmf)
>>> bool(np.isclose(neighbours @ grid.sizes, pmf @ grid.sizes, rtol=1e-14))
True
)doc");
    m.def("remix", &remix, py::arg("fabric"),
          R"doc(The same grains, mixed anew: neighbours independent of the grain (Eq. 64).

Forgets the load (`settled_at` None), since grains meet new neighbours.

Examples
--------
>>> import comminute as cm
>>> fabric = cm.mixed_fabric(cm.monodisperse(1.0), cm.LogGrid(-6.0, 0.0, 61))
>>> cm.remix(fabric) == fabric
True
)doc",
          py::call_guard<py::gil_scoped_release>());
}
