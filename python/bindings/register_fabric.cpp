// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

std::vector<Atom> atoms_from(const py::object& list) {
    std::vector<Atom> atoms;
    for (const py::handle item : list) {
        try {
            atoms.push_back(item.cast<Atom>());
        } catch (const py::cast_error&) {
            throw py::type_error("atoms[" + std::to_string(atoms.size()) + "] is " +
                                 std::string(py::repr(item)) + "; it must be an Atom or (psi, psibar, mass)");
        }
    }
    return atoms;
}

Fabric make_fabric(const LogGrid& grid, const py::object& probability, const py::object& atoms,
                   std::optional<double> settled_at, const std::string& mean, std::vector<Ridge> ridges,
                   double largest) {
    const auto p = strict_array(probability, {grid.bins(), grid.bins()}, "probability");
    return {grid,
            std::vector<double>(p.data(), p.data() + p.size()),
            atoms_from(atoms),
            settled_at,
            choice_of<Mean>(mean),
            std::move(ridges),
            largest};
}

using Carried = std::tuple<py::array_t<double>, py::array_t<double>, std::vector<PointMass>, double>;

Carried carried_of(const Fabric& fabric) {
    const FabricParts& parts = fabric.parts();
    return {copied(parts.rows), copied(parts.spread), parts.points, parts.largest};
}

Fabric with_carried(const Fabric& fabric, const py::object& rows, const py::object& spread,
                    std::vector<PointMass> points, double largest) {
    const auto r = strict_array(rows, {fabric.grid().bins()}, "rows");
    const auto s = strict_array(spread, {fabric.grid().bins()}, "spread");
    FabricParts parts = fabric.parts();
    parts.rows.assign(r.data(), r.data() + r.size());
    parts.spread.assign(s.data(), s.data() + s.size());
    parts.points = std::move(points);
    parts.largest = largest;
    return Fabric::from_parts(std::move(parts));
}

}  // namespace

void register_fabric(py::module_& m) {
    register_exact_masses(m);
    py::class_<Fabric>(m, "Fabric",
                       R"doc(The grainsize fabric: mass by log grainsize and log neighbourhood grainsize.

Most of it lies in bins. The point masses of a start stay exact until they crush, as atoms and ridges.
Immutable.

Parameters
----------
grid : LogGrid
probability : ndarray (N, N)
    Shares of the mass [psi, psibar], float64 in C order, at least 0. Copied.
atoms : sequence of Atom or (psi, psibar, mass)
    Exact masses on top of it, inside the grid and above its fines bin.
settled_at : float, optional
    Largest stress ratio under which this state is at rest; None: never loaded.
mean : {"arithmetic", "geometric"}
    How two neighbours make a neighbourhood grainsize (Eq. 48 or 65), for `remix`.
ridges : sequence of Ridge
    Half-exact masses on top of both.
largest : float
    Size that no grain exceeds, where curves end; 0 where it is not known.

Raises
------
TypeError, ShapeError, ParameterError
    For another dtype or shape, a negative entry, a place off the grid, or a total of all three other
    than 1 (to 1e-9); the message gives the place.

Examples
--------
>>> import numpy as np
>>> import comminute as cm
>>> fabric = cm.Fabric(cm.LogGrid(-6.0, 0.0, 16), np.full((16, 16), 1 / 256))
>>> fabric.grainsize()[:2]
array([0.0625, 0.0625])
)doc")
        .def(py::init(&make_fabric), py::arg("grid"), py::arg("probability"), py::arg("atoms") = py::tuple(),
             py::kw_only(), py::arg("settled_at") = py::none(), py::arg("mean") = "arithmetic",
             py::arg("ridges") = std::vector<Ridge>(), py::arg("largest") = 0.0)
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
            "(N, N) the mass in bins [psi, psibar], without atoms and ridges; a read-only view.")
        .def_property_readonly(
            "atoms", [](const Fabric& f) { return f.atoms(); }, "List of Atom: mass at exact places.")
        .def_property_readonly(
            "ridges", [](const Fabric& f) { return f.ridges(); }, "List of Ridge: half-exact mass.")
        .def_property_readonly(
            "points", [](const Fabric& f) { return f.points(); },
            "List of PointMass, fine to coarse: the exact sizes in `grainsize`, where its cdf jumps.")
        .def_property_readonly(
            "largest", [](const Fabric& f) { return f.largest(); },
            "Size that no grain exceeds, the largest of the start; 0 where it is not known.")
        .def(
            "grainsize",
            [](const Fabric& f) {
                return copied({f.grainsize().begin(), f.grainsize().end()});
            },
            "(N,) mass by grainsize, the marginal over psibar (Eq. 62); exact sizes are in their bins.")
        .def(
            "neighbourhood", [](const Fabric& f) { return copied(f.neighbourhood()); },
            "(N,) mass by neighbourhood grainsize, the marginal over psi.")
        .def(
            "cdf", [](const Fabric& f) { return copied(f.cdf()); },
            "(N,) mass fraction finer than the upper edge of each bin.")
        .def("_carried", &carried_of,
             "Marginals as an engine or a mixing handed them on, for `_with_carried`: mass by grainsize in "
             "bins, the "
             "same with the ridges that spread over psi, exact sizes, and the largest size.")
        .def("_with_carried", &with_carried, py::arg("rows"), py::arg("spread"), py::arg("points"),
             py::arg("largest") = 0.0,
             R"doc(The same fabric with the marginals that `_carried` gave.

A fabric made again from its parts sums its marginals anew, which differs in the last bit from those that
it was solved or mixed with. With them it is the same to that bit, and so is all that follows.

Examples
--------
>>> import comminute as cm
>>> fabric = cm.mixed_fabric(cm.power_law(2.5, 0.01, 1.0), cm.LogGrid(-6.0, 0.0, 61))
>>> again = cm.Fabric(fabric.grid, fabric.probability, mean=fabric.mean)._with_carried(*fabric._carried())
>>> cm.remix(again) == fabric
True
)doc")
        .def(
            "binned", &Fabric::binned,
            R"doc(The same with every atom and ridge in the bin that holds it, for engines that know bins only.

Never loaded (`settled_at` None) where that moved any mass, since bins are not tested as points are.

Examples
--------
>>> import comminute as cm
>>> fabric = cm.mixed_fabric(cm.monodisperse(1.0), cm.LogGrid(-6.0, 0.0, 61))
>>> float(fabric.probability.sum()), float(fabric.binned().probability.sum())
(0.0, 1.0)
)doc")
        .def(
            "__eq__", [](const Fabric& a, const Fabric& b) { return a == b; }, py::is_operator())
        .def("__repr__",
             [](const Fabric& f) {
                 return repr_of("Fabric", "grid", f.grid(), "atoms", f.atoms().size(), "ridges",
                                f.ridges().size(), "settled_at", f.settled_at(), "mean", word_of(f.mean()));
             })
        .def(py::pickle(
            [](const py::object& self) {
                const auto& f = self.cast<const Fabric&>();
                return py::make_tuple(f.grid(), self.attr("probability"), f.atoms(), f.settled_at(),
                                      word_of(f.mean()), f.ridges(), carried_of(f));
            },
            [](const py::tuple& t) {
                const Fabric fabric =
                    make_fabric(t[0].cast<LogGrid>(), t[1], t[2], t[3].cast<std::optional<double>>(),
                                t[4].cast<std::string>(), t[5].cast<std::vector<Ridge>>(), 0.0);
                const auto marginals = t[6].cast<py::tuple>();
                return with_carried(fabric, marginals[0], marginals[1],
                                    marginals[2].cast<std::vector<PointMass>>(), marginals[3].cast<double>());
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
