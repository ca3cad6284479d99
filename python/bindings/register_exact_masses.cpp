// SPDX-License-Identifier: BSD-3-Clause
#include <optional>

#include "arrays.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

Ridge make_ridge(const std::string& exact, double at, const py::object& mass, double above) {
    const auto bins = py::isinstance<py::array>(mass) ? py::cast<py::array>(mass).size() : 0;
    const auto m = strict_array(mass, {bins}, "mass");
    return {choice_of<Axis>(exact), at, std::vector<double>(m.data(), m.data() + m.size()), above};
}

py::iterator unpacked(const py::tuple& fields) {
    return py::iter(fields);
}

}  // namespace

void register_exact_masses(py::module_& m) {
    py::class_<PointMass>(m, "PointMass", R"doc(Mass at one exact log size; unpacks to (psi, mass).

Parameters
----------
psi : float
    Log size.
mass : float
    Share of the mass.
size : float, optional
    The size itself, in the material's unit: exp(psi) where it is left out. Curves jump there, since exp(ln s) is
    often another number than s.

Examples
--------
>>> import comminute as cm
>>> psi, mass = cm.mixed_fabric(cm.monodisperse(1.0), cm.LogGrid(-6.0, 0.0, 61)).points[0]
>>> psi, mass
(0.0, 1.0)
)doc")
        .def(py::init([](double psi, double mass, std::optional<double> size) {
                 return size ? PointMass{psi, mass, *size} : PointMass{psi, mass};
             }),
             py::arg("psi"), py::arg("mass"), py::arg("size") = py::none())
        .def_readonly("psi", &PointMass::psi, "Log size.")
        .def_readonly("mass", &PointMass::mass, "Share of the mass.")
        .def_readonly("size", &PointMass::size, "The size itself, in the material's unit.")
        .def("__iter__", [](const PointMass& p) { return unpacked(py::make_tuple(p.psi, p.mass)); })
        .def(
            "__eq__", [](const PointMass& a, const PointMass& b) { return a == b; }, py::is_operator())
        .def("__repr__",
             [](const PointMass& p) {
                 return repr_of("PointMass", "psi", p.psi, "mass", p.mass, "size", p.size);
             })
        .def(py::pickle([](const PointMass& p) { return py::make_tuple(p.psi, p.mass, p.size); },
                        [](const py::tuple& t) {
                            return PointMass{t[0].cast<double>(), t[1].cast<double>(), t[2].cast<double>()};
                        }));

    const auto make_atom = [](double psi, double psibar, double mass) { return Atom{psi, psibar, mass}; };
    py::class_<Atom>(m, "Atom",
                     R"doc(Mass at one exact place of the fabric; unpacks to (psi, psibar, mass).

Grains of one size among neighbours of one mean size. All of it crushes, or none.

Parameters
----------
psi, psibar : float
    Log grainsize and log neighbourhood grainsize.
mass : float
    Share of the mass.

Examples
--------
>>> import comminute as cm
>>> [psi, psibar, mass] = cm.mixed_fabric(cm.monodisperse(1.0), cm.LogGrid(-6.0, 0.0, 61)).atoms[0]
>>> psi, psibar, mass
(0.0, 0.0, 1.0)
)doc")
        .def(py::init(make_atom), py::arg("psi"), py::arg("psibar"), py::arg("mass"))
        .def(py::init([make_atom](const py::tuple& t) {
            if (t.size() != 3) throw py::type_error("an atom is (psi, psibar, mass)");
            return make_atom(t[0].cast<double>(), t[1].cast<double>(), t[2].cast<double>());
        }))
        .def_readonly("psi", &Atom::psi, "Log grainsize.")
        .def_readonly("psibar", &Atom::psibar, "Log neighbourhood grainsize.")
        .def_readonly("mass", &Atom::mass, "Share of the mass.")
        .def("__iter__", [](const Atom& a) { return unpacked(py::make_tuple(a.psi, a.psibar, a.mass)); })
        .def(
            "__eq__", [](const Atom& a, const Atom& b) { return a == b; }, py::is_operator())
        .def("__repr__",
             [](const Atom& a) { return repr_of("Atom", "psi", a.psi, "psibar", a.psibar, "mass", a.mass); })
        .def(py::pickle([](const Atom& a) { return py::make_tuple(a.psi, a.psibar, a.mass); },
                        [make_atom](const py::tuple& t) {
                            return make_atom(t[0].cast<double>(), t[1].cast<double>(), t[2].cast<double>());
                        }));
    py::implicitly_convertible<py::tuple, Atom>();

    py::class_<Ridge>(m, "Ridge",
                      R"doc(Mass with one of its two log sizes exact and the other spread over bins.

What becomes of an atom once one of its two grains has crushed, or of exact sizes mixed with a spread
grading.

Parameters
----------
exact : {"grain", "neighbour"}
    Which log size is exact: psi or psibar.
at : float
    Its value.
mass : ndarray (N,)
    Mass by bin of the other log size.
above : float
    Part of the mass in the bin that holds `at` that is larger than `at`.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-6.0, 0.0, 61)
>>> start = cm.mixed_fabric(cm.monodisperse(1.0), grid)
>>> after = cm.QuasiStatic(grid, cm.Material()).solve(start, 1.0)
>>> [(ridge.exact, ridge.at, float(ridge.mass.sum().round(12))) for ridge in after.ridges]
[('grain', 0.0, 0.5), ('neighbour', 0.0, 0.5)]
)doc")
        .def(py::init(&make_ridge), py::arg("exact"), py::arg("at"), py::arg("mass"), py::arg("above") = 0.0)
        .def_property_readonly(
            "exact", [](const Ridge& r) { return word_of(r.exact); }, "\"grain\" or \"neighbour\".")
        .def_readonly("at", &Ridge::at, "The exact log size.")
        .def_property_readonly(
            "mass", [](const Ridge& r) { return copied(r.mass); }, "(N,) mass by bin of the other log size.")
        .def_readonly("above", &Ridge::above,
                      "Of the mass in the bin that holds `at`: the part larger than `at`.")
        .def(
            "__eq__", [](const Ridge& a, const Ridge& b) { return a == b; }, py::is_operator())
        .def("__repr__",
             [](const Ridge& r) {
                 return repr_of("Ridge", "exact", word_of(r.exact), "at", r.at, "bins", r.mass.size());
             })
        .def(py::pickle(
            [](const Ridge& r) { return py::make_tuple(word_of(r.exact), r.at, copied(r.mass), r.above); },
            [](const py::tuple& t) {
                return make_ridge(t[0].cast<std::string>(), t[1].cast<double>(), t[2], t[3].cast<double>());
            }));
}
