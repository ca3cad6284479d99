// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

void register_material(py::module_& m) {
    const Material standard;
    py::class_<Material>(m, "Material", R"doc(What the grains are: strength, fabric and fragments.

Immutable. The defaults are the paper's (Huang, Marks & Einav 2020, Section 2 and Fig. 3).

Parameters
----------
weibull_modulus : float
    w > 0, Weibull modulus of grain strength: a grain of size s among equals crushes at the stress
    ratio (s / reference_size)**(-3 / w).
fabric_width : float
    n > 0, how far in log size a neighbour may differ and still crush a grain (Eq. 2);
    math.inf switches the fabric off: size alone decides.
reference_size : float
    s_max > 0, in the unit of the sizes: a reference, not a bound.
fragments : WeibullFragments, PowerLawFragments, LogNormalFragments or TabulatedFragments
    Law of the size-reduction factor of one crush.
first_crush_stress : float, optional
    Stress at which a grain of reference_size among equals crushes. Needed only to speak in
    stresses, and sets their unit. It is not the stress at which a sample first crushes: with all
    grains smaller than reference_size that is larger.

Raises
------
ParameterError
    For a value outside its range; the message names it.

Examples
--------
>>> import comminute as cm
>>> sand = cm.Material(reference_size=2.0, first_crush_stress=1.2)
>>> sand.stress_ratio(12.0)
10.0
)doc")
        .def(py::init([](double w, double n, double s_max, FragmentLaw law, std::optional<double> stress,
                         bool scatter) {
                 Material material{w, n, s_max, law, stress, scatter};
                 material.validate();
                 return material;
             }),
             py::kw_only(), py::arg("weibull_modulus") = standard.weibull_modulus,
             py::arg("fabric_width") = standard.fabric_width,
             py::arg("reference_size") = standard.reference_size, py::arg("fragments") = standard.fragments,
             py::arg("first_crush_stress") = standard.first_crush_stress,
             py::arg("strength_scatter") = standard.strength_scatter)
        .def_readonly("weibull_modulus", &Material::weibull_modulus, "w, Weibull modulus of grain strength.")
        .def_readonly("fabric_width", &Material::fabric_width,
                      "n, how far a neighbour may differ in log size.")
        .def_readonly("reference_size", &Material::reference_size, "s_max, in the unit of the sizes.")
        .def_readonly("fragments", &Material::fragments, "Law of the size-reduction factor.")
        .def_readonly("first_crush_stress", &Material::first_crush_stress,
                      "Stress of stress ratio 1, or None.")
        .def_property_readonly("k", &Material::k, "k = 6 n**2 / w of the log-space stress function (Eq. 15).")
        .def("stress_ratio", py::vectorize(&Material::stress_ratio), py::arg("stress"),
             R"doc(Dimensionless load of a stress (scalar or array) in the unit of first_crush_stress.

Raises
------
ParameterError
    If first_crush_stress is not set, or for a negative or NaN stress.
)doc")
        .def(
            "__eq__", [](const Material& a, const Material& b) { return a == b; }, py::is_operator())
        .def("__repr__",
             [](const Material& x) {
                 return repr_of("Material", "weibull_modulus", x.weibull_modulus, "fabric_width",
                                x.fabric_width, "reference_size", x.reference_size, "fragments", x.fragments,
                                "first_crush_stress", x.first_crush_stress, "strength_scatter",
                                x.strength_scatter);
             })
        .def(py::pickle(
            [](const Material& x) {
                return py::make_tuple(x.weibull_modulus, x.fabric_width, x.reference_size, x.fragments,
                                      x.first_crush_stress, x.strength_scatter);
            },
            [](const py::tuple& t) {
                return Material{t[0].cast<double>(),
                                t[1].cast<double>(),
                                t[2].cast<double>(),
                                t[3].cast<FragmentLaw>(),
                                t[4].cast<std::optional<double>>(),
                                t[5].cast<bool>()};
            }));
}

void register_fragment_pmf(py::module_& m) {
    const KernelOptions defaults;
    m.def(
        "fragment_pmf",
        [](const FragmentLaw& law, double spacing, Index bins, const std::string& scheme) {
            return copied(comminute::fragment_pmf(law, spacing, bins, choice_of<Scheme>(scheme)).mass);
        },
        py::arg("fragments"), py::arg("spacing"), py::arg("bins"),
        py::arg("scheme") = word_of(defaults.scheme),
        R"doc(Share of the mass that one crush moves down by m bins.

Parameters
----------
fragments : WeibullFragments, PowerLawFragments, LogNormalFragments or TabulatedFragments
    The law.
spacing : float
    Bin width h > 0.
bins : int
    Number of shares N, at least 1.
scheme : {"conservative", "paper"}
    "conservative": finite volumes, mass uniform in its bin, shifted by R, lands by overlap; second
    order in h. "paper": f_m = P[-m h < R <= -(m-1) h], every crush moves at least one bin.

Returns
-------
ndarray (bins,)
    f_m for m = 0 ... bins - 1; what is missing from 1 falls further.

Raises
------
ParameterError
    For a law, spacing or number outside its range.

Examples
--------
>>> import math
>>> import comminute as cm
>>> cm.fragment_pmf(cm.PowerLawFragments(), math.log(2.0), 4, "paper").round(12)
array([0.   , 0.5  , 0.25 , 0.125])
)doc");
}

}  // namespace

void register_model(py::module_& m) {
    register_grid(m);
    register_fragment_laws(m);
    register_material(m);
    register_fragment_pmf(m);
}
