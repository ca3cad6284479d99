// SPDX-License-Identifier: BSD-3-Clause
#include "rooms.hpp"
#include "stress_input.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

py::object equivalent(const StressMeasure& measure, const py::object& tensor, const py::object& p,
                      const py::object& q, const py::object& vertical, const py::object& k0,
                      bool compression_positive) {
    const WaysToScalar ways{
        [&](MatrixView<const double> sigma, VectorView<double> out, StressSign sign) {
            measure.equivalent(sigma, out, sign);
        },
        [&](double mean, double shear) { return measure.equivalent_pq(mean, shear); },
        [&](double stress, double ratio) { return measure.equivalent_vertical(stress, ratio); }};
    return scalar_of({"tensor", tensor, p, q, vertical, k0, compression_positive}, ways);
}

constexpr const char* equivalent_doc = R"doc(Measure of stresses: one number for each.

Parameters
----------
tensor : array_like (..., 3, 3) or (..., 6), optional
    Effective stress tensors, or their components in the order xx yy zz yz xz xy, shear not doubled.
p, q : float or array_like, optional
    Mean stress, and axial less radial stress, of an axisymmetric (triaxial) test. The sign of q,
    negative in extension, matters to "largest" alone.
vertical, k0 : float or array_like, optional
    Vertical stress without lateral strain, and the ratio of the horizontal stress to it.
compression_positive : bool
    Sign of compression in tensors; p and vertical are positive in compression.

Returns
-------
float or ndarray (...)
    At least 0; 0 where the mean stress is tensile.

Raises
------
ParameterError
    Unless one of tensor, p with q, and vertical with k0 is given, and for numbers that are not
    finite, a tensor that is not symmetric, and a negative k0.
ShapeError
    For an array of another shape.

Examples
--------
>>> import numpy as np
>>> import comminute as cm
>>> energy = cm.StressMeasure("energy", poisson=0.2)
>>> oedometer = np.diag([5.0, 5.0, 10.0])
>>> round(energy.equivalent(oedometer), 3), round(energy(vertical=10.0, k0=0.5), 3)
(7.454, 7.454)
>>> cm.StressMeasure("vertical").equivalent(np.stack([oedometer, 2.0 * oedometer]))
array([10., 20.])
)doc";

}  // namespace

void register_stress(py::module_& m) {
    py::class_<StressMeasure> measure(m, "StressMeasure",
                                      R"doc(The scalar of a stress that stands for its load on the grains.

The model has one load, and a stress tensor has six numbers. A measure makes one of them: isotropic,
of degree 1, and equal to the pressure under an isotropic stress ("octahedral" alone is 0 there). The
stress ratio of a stress is its measure over that of the first crush; see `Material`.

Parameters
----------
name : {"largest", "vertical", "mean", "octahedral", "energy"}
    "largest": the largest principal stress. "vertical" is another word for it, since the vertical
    stress of an oedometer is the largest (K0 <= 1); no axis is singled out. "mean": p, a third of
    the trace. "octahedral": sqrt(2) q / 3, shear alone. "energy": sqrt(p**2 + K/(3G) q**2), the
    pressure that stores as much energy in a linear elastic packing, with
    K/(3G) = 2 (1 + nu) / (9 (1 - 2 nu)); the criterion of breakage mechanics before any breakage
    (Einav 2007), without friction's share in it.
poisson : float, optional
    Poisson's ratio nu of the packing, in [0, 0.5). Only "energy" uses it, and needs it.

Raises
------
ParameterError
    For another name, a ratio outside its range, or none where one is needed.

Notes
-----
Stresses are effective, and positive in compression. A measure remembers no direction and knows
nothing of shear strain.

Examples
--------
>>> import comminute as cm
>>> energy = cm.StressMeasure("energy", poisson=0.2)
>>> energy(p=2.0, q=0.0), round(energy(p=2.0, q=1.5), 3)
(2.0, 2.236)
>>> energy
StressMeasure(name='energy', poisson=0.2)
)doc");
    measure
        .def(py::init([](const std::string& name, std::optional<double> poisson) {
                 return StressMeasure(choice_of<StressKind>(name), poisson);
             }),
             py::arg("name"), py::kw_only(), py::arg("poisson") = py::none())
        .def_property_readonly(
            "name", [](const StressMeasure& x) { return word_of(x.kind()); },
            "\"largest\", \"mean\", \"octahedral\" or \"energy\".")
        .def_property_readonly("poisson", &StressMeasure::poisson, "Poisson's ratio, or None.")
        .def(
            "__eq__", [](const StressMeasure& a, const StressMeasure& b) { return a == b; },
            py::is_operator())
        .def("__hash__",
             [](const StressMeasure& x) { return py::hash(py::make_tuple(word_of(x.kind()), x.poisson())); })
        .def("__repr__",
             [](const StressMeasure& x) {
                 return x.poisson()
                            ? repr_of("StressMeasure", "name", word_of(x.kind()), "poisson", x.poisson())
                            : repr_of("StressMeasure", "name", word_of(x.kind()));
             })
        .def(py::pickle([](const StressMeasure& x) { return py::make_tuple(word_of(x.kind()), x.poisson()); },
                        [](const py::tuple& t) {
                            return StressMeasure(choice_of<StressKind>(t[0].cast<std::string>()),
                                                 t[1].cast<std::optional<double>>());
                        }));
    for (const char* name : {"equivalent", "__call__"}) {
        measure.def(name, &equivalent, py::arg("tensor") = py::none(), py::kw_only(),
                    py::arg("p") = py::none(), py::arg("q") = py::none(), py::arg("vertical") = py::none(),
                    py::arg("k0") = py::none(), py::arg("compression_positive") = true, equivalent_doc);
    }
}
