// SPDX-License-Identifier: BSD-3-Clause
#include "rooms.hpp"

using namespace comminute;

void register_ideal_gradings(py::module_& m) {
    using namespace py::literals;
    tell_defaults(m, "gap_graded", py::dict("coarse_share"_a = usual_coarse_share));
    tell_defaults(m, "fuller", py::dict("exponent"_a = fuller_exponent));
    m.def("monodisperse", &monodisperse, py::arg("size"), R"doc(All grains of one size.

Parameters
----------
size : float
    > 0.

Returns
-------
Grading

Raises
------
ParameterError
    Unless size > 0.

Examples
--------
>>> import comminute as cm
>>> cm.monodisperse(2.0).finer([1.9, 2.0])
array([0., 1.])
)doc");
    m.def("gap_graded", &gap_graded, py::arg("coarse"), py::arg("fine"),
          py::arg("coarse_share") = usual_coarse_share,
          R"doc(Two sizes and nothing between.

Parameters
----------
coarse, fine : float
    Sizes, 0 < fine < coarse.
coarse_share : float
    Share of the mass that is coarse, in [0, 1].

Returns
-------
Grading

Raises
------
ParameterError
    For a value outside its range.

Examples
--------
>>> import comminute as cm
>>> cm.gap_graded(1.0, 0.1, coarse_share=0.25).finer(0.5)
0.75
)doc");
    m.def("power_law", &power_law, py::arg("fractal_dimension"), py::arg("smallest"), py::arg("largest"),
          R"doc(Power law N(> s) ~ s**-fractal_dimension between two sizes.

By mass F = (s**(3-a) - s_m**(3-a)) / (s_M**(3-a) - s_m**(3-a)), a the fractal dimension;
a = 3 is uniform in ln s.

Parameters
----------
fractal_dimension : float
smallest, largest : float
    0 < smallest < largest; smallest may be 0 for a fractal dimension below 3.

Returns
-------
Grading

Raises
------
ParameterError
    For a value outside its range.

Examples
--------
>>> import comminute as cm
>>> cm.power_law(2.5, 1e-3, 1.0).finer(1.0)
1.0
)doc");
    m.def("uniform_size", &uniform_size, py::arg("smallest"), py::arg("largest"),
          R"doc(Mass uniform in size between two sizes: the power law of fractal dimension 2.

Parameters
----------
smallest, largest : float
    0 <= smallest < largest.

Returns
-------
Grading

Raises
------
ParameterError
    For a value outside its range.

Examples
--------
>>> import comminute as cm
>>> cm.uniform_size(0.0, 2.0).finer(0.5)
0.25
)doc");
    m.def("log_uniform", &log_uniform, py::arg("smallest"), py::arg("largest"),
          R"doc(Mass uniform in ln(size) between two sizes: the power law of fractal dimension 3.

Parameters
----------
smallest, largest : float
    0 < smallest < largest.

Returns
-------
Grading

Raises
------
ParameterError
    For a value outside its range.

Examples
--------
>>> import comminute as cm
>>> round(cm.log_uniform(0.01, 1.0).finer(0.1), 12)
0.5
)doc");
    m.def("fuller", &fuller, py::arg("largest"), py::arg("exponent") = fuller_exponent,
          R"doc(Fuller-Talbot curve F = (size / largest)**exponent.

Parameters
----------
largest : float
    > 0.
exponent : float
    > 0; one half is Fuller's, any other Talbot's.

Returns
-------
Grading

Raises
------
ParameterError
    For a value outside its range.

Examples
--------
>>> import comminute as cm
>>> cm.fuller(16.0).finer(4.0)
0.5
)doc");
    m.def("lognormal", &lognormal, py::arg("median"), py::arg("sd_log"), py::kw_only(),
          py::arg("largest") = py::none(), R"doc(Lognormal by mass, cut off at a largest size and rescaled.

Parameters
----------
median : float
    Size that half the mass of the uncut law is finer than, > 0.
sd_log : float
    Standard deviation of ln(size), > 0.
largest : float, optional
    Size at which the law is cut off; left out: 4 standard deviations above the median, and `notes` says so.

Returns
-------
Grading

Raises
------
ParameterError
    For a value outside its range.

Examples
--------
>>> import comminute as cm
>>> round(cm.lognormal(0.5, 0.4).finer(0.5), 4)
0.5
)doc");
    m.def("rosin_rammler", &rosin_rammler, py::arg("d63"), py::arg("exponent"), py::kw_only(),
          py::arg("largest") = py::none(),
          R"doc(Rosin-Rammler F = 1 - exp(-(size / d63)**exponent), cut off at a largest size and rescaled.

Parameters
----------
d63 : float
    Size that 63.2 % of the uncut law is finer than, > 0.
exponent : float
    > 0.
largest : float, optional
    Size at which the law is cut off; left out: the size that 0.01 % of the uncut law is coarser than, and
    `notes` says so.

Returns
-------
Grading

Raises
------
ParameterError
    For a value outside its range.

Examples
--------
>>> import comminute as cm
>>> round(cm.rosin_rammler(1.0, 1.2).finer(1.0), 3)
0.632
)doc");
}
