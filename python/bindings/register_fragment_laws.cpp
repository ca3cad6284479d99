// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "arrays.hpp"
#include "rooms.hpp"

namespace {

using comminute::LogNormalFragments;
using comminute::PowerLawFragments;
using comminute::TabulatedFragments;
using comminute::WeibullFragments;

template <class Law>
py::class_<Law>& add_law_methods(py::class_<Law>& law) {
    return law
        .def(
            "pdf",
            [](const Law& l, const py::array_t<double>& r) {
                return py::vectorize([&l](double x) { return l.pdf(x); })(r);
            },
            py::arg("r"), "Density of R = ln X at r (scalar or array); 0 for r > 0.")
        .def(
            "cdf",
            [](const Law& l, const py::array_t<double>& r) {
                return py::vectorize([&l](double x) { return l.cdf(x); })(r);
            },
            py::arg("r"), "P[R <= r] (scalar or array); 1 for r >= 0.")
        .def(
            "sample",
            [](const Law& l, const py::object& size, const py::object& rng) {
                // A generator gives numbers in [0, 1), and quantile takes a share in (0, 1).
                const auto uniform = py::array_t<double>(rng.attr("random")(size));
                return py::vectorize([&l](double u) {
                    return std::exp(l.quantile(std::clamp(u, 0x1p-60, 1.0 - 0x1p-53)));
                })(uniform);
            },
            py::arg("size"), py::arg("rng"),
            R"doc(Size-reduction factors X, drawn from the law: fragments of a grain of size s have sizes X s, by mass.

Parameters
----------
size : int or tuple of int
    Shape of the result.
rng : numpy.random.Generator

Returns
-------
ndarray

Examples
--------
>>> import numpy as np
>>> import comminute as cm
>>> drawn = cm.PowerLawFragments(2.0).sample(10_000, np.random.default_rng(0))
>>> drawn.shape, round(float(np.mean(drawn <= 0.5)), 2)  # P[X <= x] = x**2
((10000,), 0.25)
)doc")
        .def(
            "__eq__", [](const Law& a, const Law& b) { return a == b; }, py::is_operator());
}

template <class Law>
Law valid(Law law) {
    law.validate();
    return law;
}

}  // namespace

void register_fragment_laws(py::module_& m) {
    const WeibullFragments weibull;
    py::class_<WeibullFragments> weibull_class(
        m, "WeibullFragments",
        R"doc(Weibull law of the size-reduction factor X on (0, 1] (Eq. 3).

Parameters
----------
scale : float
    lambda > 0.
shape : float
    kappa > 0. Scale and shape 1 is the truncated exponential of Eq. 4.

Raises
------
ParameterError
    Unless both are greater than 0 and finite.

Examples
--------
>>> import comminute as cm
>>> law = cm.WeibullFragments(scale=1.0, shape=1.0)
>>> law.cdf(0.0)
1.0
)doc");
    weibull_class
        .def(py::init([](double scale, double shape) {
                 return valid(WeibullFragments{scale, shape});
             }),
             py::arg("scale") = weibull.scale, py::arg("shape") = weibull.shape)
        .def_readonly("scale", &WeibullFragments::scale, "lambda.")
        .def_readonly("shape", &WeibullFragments::shape, "kappa.")
        .def("__repr__",
             [](const WeibullFragments& l) {
                 return repr_of("WeibullFragments", "scale", l.scale, "shape", l.shape);
             })
        .def(py::pickle([](const WeibullFragments& l) { return py::make_tuple(l.scale, l.shape); },
                        [](const py::tuple& t) {
                            return WeibullFragments{t[0].cast<double>(), t[1].cast<double>()};
                        }));
    add_law_methods(weibull_class);

    const PowerLawFragments power;
    py::class_<PowerLawFragments> power_class(
        m, "PowerLawFragments",
        R"doc(Power law of the size-reduction factor: P[X <= x] = x**exponent on (0, 1].

Parameters
----------
exponent : float
    > 0; 1 is uniform X.

Raises
------
ParameterError
    Unless the exponent is greater than 0 and finite.

Examples
--------
>>> import math
>>> import comminute as cm
>>> round(cm.PowerLawFragments(exponent=2.0).cdf(math.log(0.5)), 12)
0.25
)doc");
    power_class
        .def(py::init([](double exponent) { return valid(PowerLawFragments{exponent}); }),
             py::arg("exponent") = power.exponent)
        .def_readonly("exponent", &PowerLawFragments::exponent, "Exponent of P[X <= x].")
        .def("__repr__",
             [](const PowerLawFragments& l) { return repr_of("PowerLawFragments", "exponent", l.exponent); })
        .def(py::pickle([](const PowerLawFragments& l) { return py::make_tuple(l.exponent); },
                        [](const py::tuple& t) { return PowerLawFragments{t[0].cast<double>()}; }));
    add_law_methods(power_class);

    const LogNormalFragments lognormal;
    py::class_<LogNormalFragments> lognormal_class(
        m, "LogNormalFragments",
        R"doc(Lognormal law of the size-reduction factor, cut off at X = 1.

R = ln X is normal, restricted to R <= 0.

Parameters
----------
mean_log : float
    Mean of ln X before the cut, at most 30 sd_log.
sd_log : float
    Its standard deviation, > 0.

Raises
------
ParameterError
    For a value outside its range.

Examples
--------
>>> import comminute as cm
>>> round(cm.LogNormalFragments(mean_log=-1.0, sd_log=0.5).cdf(-1.0), 4)
0.5116
)doc");
    lognormal_class
        .def(py::init([](double mean_log, double sd_log) {
                 return valid(LogNormalFragments{mean_log, sd_log});
             }),
             py::arg("mean_log") = lognormal.mean_log, py::arg("sd_log") = lognormal.sd_log)
        .def_readonly("mean_log", &LogNormalFragments::mean_log, "Mean of ln X before the cut.")
        .def_readonly("sd_log", &LogNormalFragments::sd_log, "Standard deviation of ln X before the cut.")
        .def("__repr__",
             [](const LogNormalFragments& l) {
                 return repr_of("LogNormalFragments", "mean_log", l.mean_log, "sd_log", l.sd_log);
             })
        .def(py::pickle([](const LogNormalFragments& l) { return py::make_tuple(l.mean_log, l.sd_log); },
                        [](const py::tuple& t) {
                            return LogNormalFragments{t[0].cast<double>(), t[1].cast<double>()};
                        }));
    add_law_methods(lognormal_class);

    py::class_<TabulatedFragments> tabulated_class(m, "TabulatedFragments",
                                                   R"doc(A measured law of the size-reduction factor.

P[X <= x] is linear in ln x between the points. Below the first it continues as the power law
through the first two, or is 0 where the first share is 0.

Parameters
----------
x : sequence of float
    Two or more, rising, in (0, 1], the last 1.
finer : sequence of float
    P[X <= x], never falling, the last 1.

Raises
------
ParameterError, ShapeError
    Naming the value and the rule.

Examples
--------
>>> import math
>>> import comminute as cm
>>> law = cm.TabulatedFragments([0.25, 0.5, 1.0], [0.0, 0.4, 1.0])
>>> round(law.cdf(math.log(0.5)), 12)
0.4
)doc");
    tabulated_class
        .def(py::init([](std::vector<double> x, std::vector<double> finer) {
                 return valid(TabulatedFragments{std::move(x), std::move(finer)});
             }),
             py::arg("x"), py::arg("finer"))
        .def_property_readonly(
            "x", [](const TabulatedFragments& l) { return copied(l.x); }, "(Q,) points.")
        .def_property_readonly(
            "finer", [](const TabulatedFragments& l) { return copied(l.finer); }, "(Q,) P[X <= x].")
        .def("__repr__",
             [](const TabulatedFragments& l) {
                 return repr_of("TabulatedFragments", "x", l.x, "finer", l.finer);
             })
        .def(py::pickle(
            [](const TabulatedFragments& l) { return py::make_tuple(l.x, l.finer); },
            [](const py::tuple& t) {
                return TabulatedFragments{t[0].cast<std::vector<double>>(), t[1].cast<std::vector<double>>()};
            }));
    add_law_methods(tabulated_class);
}
