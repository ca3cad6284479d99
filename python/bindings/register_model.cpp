// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "rooms.hpp"
#include "stress_input.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

/// A measure by name, or made already.
using NamedMeasure = std::variant<std::string, StressMeasure>;

std::optional<StressMeasure> measure_of(const std::optional<NamedMeasure>& given,
                                        std::optional<double> poisson) {
    if (!given) {
        if (!poisson) return std::nullopt;
        throw ParameterError({.parameter = "poisson",
                              .value = text(*poisson),
                              .number = poisson,
                              .rule = "it belongs to a stress measure, which is not set",
                              .remedy = Remedy::set_stress_measure});
    }
    if (const auto* name = std::get_if<std::string>(&*given)) {
        return StressMeasure(choice_of<StressKind>(*name), poisson);
    }
    if (poisson) {
        throw ParameterError({.parameter = "poisson",
                              .value = text(*poisson),
                              .number = poisson,
                              .rule = "the StressMeasure brings its own",
                              .remedy = Remedy::leave_out});
    }
    return std::get<StressMeasure>(*given);
}

/// Tells whether stresses are tensors: numbers have one axis at most, or any shape where there is no measure.
bool are_tensors(const Material& material, const py::object& stress) {
    if (!material.stress_measure) return false;
    const auto array = py::array::ensure(stress);
    if (!array) {
        PyErr_Clear();
        return false;
    }
    return array.ndim() >= 2;
}

py::object stress_ratio(const Material& material, const py::object& stress, const py::object& p,
                        const py::object& q, const py::object& vertical, const py::object& k0,
                        bool compression_positive) {
    const bool other = !p.is_none() || !q.is_none() || !vertical.is_none() || !k0.is_none();
    if (!other && !stress.is_none() && !are_tensors(material, stress)) {
        if (!compression_positive) {
            throw ParameterError({.parameter = "compression_positive",
                                  .value = "False",
                                  .rule = "it is for tensors; numbers are positive in compression"});
        }
        return py::vectorize([&](double number) { return material.stress_ratio(number); })(
            py::array_t<double>(stress));
    }
    const StressScale scale = material.stress_scale();
    const WaysToScalar ways{
        [&](MatrixView<const double> sigma, VectorView<double> out, StressSign sign) {
            scale.stress_ratio(sigma, out, sign);
        },
        [&](double mean, double shear) { return scale.stress_ratio_pq(mean, shear); },
        [&](double number, double ratio) { return scale.stress_ratio_vertical(number, ratio); }};
    const bool own = !vertical.is_none() && k0.is_none() && material.k0;
    return scalar_of(
        {"stress", stress, p, q, vertical, own ? py::float_(*material.k0) : k0, compression_positive}, ways);
}

py::tuple material_fields(const Material& x) {
    return py::make_tuple(x.weibull_modulus, x.fabric_width, x.reference_size, x.fragments,
                          x.first_crush_stress, x.stress_measure, x.k0, x.strength_scatter);
}

std::string material_text(const Material& x) {
    std::string said = repr_of("Material", "weibull_modulus", x.weibull_modulus, "fabric_width",
                               x.fabric_width, "reference_size", x.reference_size, "fragments", x.fragments,
                               "first_crush_stress", x.first_crush_stress);
    const auto add = [&said](const std::string& field) { said.insert(said.size() - 1, ", " + field); };
    if (x.stress_measure) {
        add("stress_measure=" + py::repr(py::cast(x.stress_measure)).cast<std::string>());
        add("k0=" + py::repr(py::cast(x.k0)).cast<std::string>());
    }
    if (x.strength_scatter) add("strength_scatter=True");
    return said;
}

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
stress_measure : StressMeasure or str, optional
    Measure by which stress tensors compare, and that first_crush_stress is a value of: "largest" or
    "vertical", "mean", "octahedral", "energy". Needed for stresses that are no single numbers.
k0 : float, optional
    Ratio of the horizontal to the vertical stress, >= 0. Given, first_crush_stress was found as a
    vertical stress without lateral strain (an oedometer), and so is every stress given as a number.
poisson : float, optional
    Poisson's ratio of the packing, in [0, 0.5), for a measure given by name; only "energy" uses it.
strength_scatter : bool
    Whether each grain, and each fragment anew, has a strength of its own: a factor of its critical
    load, drawn from the Weibull law of modulus w and scale 1. For `Lattice` and the resolved closure.

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

Found in an oedometer as a vertical stress of 12 MPa; an isotropic 12 MPa does more to the grains:

>>> sand = cm.Material(first_crush_stress=12.0, stress_measure="energy", poisson=0.2, k0=0.5)
>>> sand.stress_ratio(12.0), round(sand.stress_ratio(p=12.0, q=0.0), 2)
(1.0, 1.34)
)doc")
        .def(py::init([](double w, double n, double s_max, FragmentLaw law, std::optional<double> stress,
                         const std::optional<NamedMeasure>& measure, std::optional<double> k0,
                         std::optional<double> poisson, bool scatter) {
                 Material material{w, n, s_max, law, stress, measure_of(measure, poisson), k0, scatter};
                 material.validate();
                 return material;
             }),
             py::kw_only(), py::arg("weibull_modulus") = standard.weibull_modulus,
             py::arg("fabric_width") = standard.fabric_width,
             py::arg("reference_size") = standard.reference_size, py::arg("fragments") = standard.fragments,
             py::arg("first_crush_stress") = standard.first_crush_stress,
             py::arg("stress_measure") = py::none(), py::arg("k0") = standard.k0,
             py::arg("poisson") = py::none(), py::arg("strength_scatter") = standard.strength_scatter)
        .def_readonly("weibull_modulus", &Material::weibull_modulus, "w, Weibull modulus of grain strength.")
        .def_readonly("fabric_width", &Material::fabric_width,
                      "n, how far a neighbour may differ in log size.")
        .def_readonly("reference_size", &Material::reference_size, "s_max, in the unit of the sizes.")
        .def_readonly("fragments", &Material::fragments, "Law of the size-reduction factor.")
        .def_readonly("first_crush_stress", &Material::first_crush_stress,
                      "Stress of stress ratio 1, or None.")
        .def_readonly("stress_measure", &Material::stress_measure,
                      "Measure by which tensors compare, or None.")
        .def_readonly("k0", &Material::k0, "K0 of the test in which first_crush_stress was found, or None.")
        .def_readonly("strength_scatter", &Material::strength_scatter,
                      "Whether each grain and fragment has a strength of its own.")
        .def_property_readonly("k", &Material::k, "k = 6 n**2 / w of the log-space stress function (Eq. 15).")
        .def("stress_ratio", &stress_ratio, py::arg("stress") = py::none(), py::kw_only(),
             py::arg("p") = py::none(), py::arg("q") = py::none(), py::arg("vertical") = py::none(),
             py::arg("k0") = py::none(), py::arg("compression_positive") = true,
             R"doc(Dimensionless load of a stress: its measure over that of the first crush.

Parameters
----------
stress : float or array_like, optional
    Numbers that are quoted as first_crush_stress is, each >= 0; or, where the material has a
    stress_measure, tensors (..., 3, 3) or rows (T, 6) of xx yy zz yz xz xy, shear not doubled.
p, q : float or array_like, optional
    Mean stress, and axial less radial stress, of an axisymmetric test.
vertical, k0 : float or array_like, optional
    Vertical stress without lateral strain, and the ratio of the horizontal stress to it; left out,
    the material's own.
compression_positive : bool
    Sign of compression in tensors.

Returns
-------
float or ndarray
    One for each stress; 0 where the mean stress of a tensor or a pair is tensile.

Raises
------
ParameterError
    If first_crush_stress is not set, or stress_measure where it is needed; for a negative number,
    or one that is not finite; unless one kind of stress is given.
ShapeError
    For arrays of another shape.

Examples
--------
>>> import numpy as np
>>> import comminute as cm
>>> sand = cm.Material(first_crush_stress=10.0, stress_measure="mean")
>>> sand.stress_ratio(np.diag([-5.0, -5.0, -20.0]), compression_positive=False)
1.0
>>> sand.stress_ratio(vertical=[30.0, 60.0], k0=0.5)
array([2., 4.])
)doc")
        .def(
            "__eq__", [](const Material& a, const Material& b) { return a == b; }, py::is_operator())
        .def("__repr__", &material_text)
        .def(py::pickle(&material_fields, [](const py::tuple& t) {
            Material material{t[0].cast<double>(), t[1].cast<double>(), t[2].cast<double>(),
                              t[3].cast<FragmentLaw>(), t[4].cast<std::optional<double>>()};
            if (t.size() > 5) {  // a pickle of version 0.1.0 has five
                material.stress_measure = t[5].cast<std::optional<StressMeasure>>();
                material.k0 = t[6].cast<std::optional<double>>();
                material.strength_scatter = t[7].cast<bool>();
            }
            return material;
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
    register_stress(m);
    register_material(m);
    register_fragment_pmf(m);
}
