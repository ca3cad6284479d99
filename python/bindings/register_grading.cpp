// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "rooms.hpp"

namespace {

using namespace comminute;

/// The fields of each law, in the order of its struct: one list for text and for pickles.
py::tuple fields(const PointMasses& l) {
    return py::make_tuple(l.size, l.share);
}
py::tuple fields(const PowerLawGrading& l) {
    return py::make_tuple(l.fractal_dimension, l.smallest, l.largest);
}
py::tuple fields(const LogNormalGrading& l) {
    return py::make_tuple(l.median, l.sd_log, l.largest);
}
py::tuple fields(const RosinRammlerGrading& l) {
    return py::make_tuple(l.d63, l.exponent, l.largest);
}
py::tuple fields(const SieveCurve& l) {
    return py::make_tuple(l.size, l.finer_than, l.tail_slope);
}

std::string describe(const GradingLaw& law) {
    if (const auto* l = std::get_if<PointMasses>(&law))
        return repr_of("points", "size", l->size, "share", l->share);
    if (const auto* l = std::get_if<PowerLawGrading>(&law)) {
        return repr_of("power_law", "fractal_dimension", l->fractal_dimension, "smallest", l->smallest,
                       "largest", l->largest);
    }
    if (const auto* l = std::get_if<LogNormalGrading>(&law)) {
        return repr_of("lognormal", "median", l->median, "sd_log", l->sd_log, "largest", l->largest);
    }
    if (const auto* l = std::get_if<RosinRammlerGrading>(&law)) {
        return repr_of("rosin_rammler", "d63", l->d63, "exponent", l->exponent, "largest", l->largest);
    }
    const auto& curve = std::get<SieveCurve>(law);
    return repr_of("sieves", "points", curve.size.size(), "finest", curve.size.front(), "largest",
                   curve.size.back());
}

py::tuple state_of(const GradingLaw& law) {
    return py::make_tuple(law.index(), std::visit([](const auto& l) { return fields(l); }, law));
}

GradingLaw law_of(const py::tuple& state) {
    using Numbers = std::vector<double>;
    const auto t = state[1].cast<py::tuple>();
    const auto number = [&t](std::size_t f) { return t[f].cast<double>(); };
    switch (state[0].cast<std::size_t>()) {
        case 0:
            return PointMasses{t[0].cast<Numbers>(), t[1].cast<Numbers>()};
        case 1:
            return PowerLawGrading{number(0), number(1), number(2)};
        case 2:
            return LogNormalGrading{number(0), number(1), number(2)};
        case 3:
            return RosinRammlerGrading{number(0), number(1), number(2)};
        default:
            return SieveCurve{t[0].cast<Numbers>(), t[1].cast<Numbers>(), number(2)};
    }
}

Grading from_sieves(const std::vector<double>& size, const std::vector<double>& percent_finer,
                    std::string unit, const std::string& top, bool number,
                    const std::vector<std::string>& notes) {
    if (top != "error" && top != "extend") {
        throw ParameterError(
            {.parameter = "top", .value = "'" + top + "'", .rule = "it must be one of 'error', 'extend'"});
    }
    SieveOptions options;
    options.unit = std::move(unit);
    options.extend_top = top == "extend";
    options.by_number = number;
    Grading grading = sieve_grading(size, percent_finer, options);
    grading.notes.insert(grading.notes.begin(), notes.begin(), notes.end());
    return grading;
}

Grading with_unit(const Grading& grading, std::string unit) {
    return {grading.law, std::move(unit), grading.notes};
}

py::tuple points(const Grading& grading, Index count) {
    const CurvePoints curve = grading.points(count);
    return py::make_tuple(copied(curve.size), copied(curve.finer_than), curve.tail_slope);
}

const char* top_word(const SieveOptions& options) {
    return options.extend_top ? "extend" : "error";
}

}  // namespace

void register_grading(py::module_& m) {
    using namespace py::literals;
    const SieveOptions standard;
    tell_defaults(
        m, "from_sieves",
        py::dict("unit"_a = standard.unit, "top"_a = top_word(standard), "number"_a = standard.by_number));
    py::class_<Grading>(m, "Grading", R"doc(How much of the mass is finer than each size, at the start.

Made by `monodisperse`, `gap_graded`, `power_law` or `Grading.from_sieves`. Immutable.)doc")
        .def_static("from_sieves", &from_sieves, py::arg("size"), py::arg("percent_finer"),
                    py::arg("unit") = standard.unit, py::kw_only(), py::arg("top") = top_word(standard),
                    py::arg("number") = standard.by_number, py::arg("notes") = std::vector<std::string>{},
                    R"doc(A measured curve: linear in ln(size) between sieves.

What is finer than the finest sieve continues as a power law through the two finest points; `notes`
says so.

Parameters
----------
size : sequence of float
    Two or more sieve openings > 0, in any order, all different.
percent_finer : sequence of float
    Per cent of the mass finer than each, 0 to 100, never falling with size, 100 at the coarsest. A
    curve whose top lies between 0.9 and 1 is read as fractions; `notes` says so. What sums leave
    behind, 100.00000000000001 or -5e-15, is 100 and 0.
unit : str
    Unit of the sizes, carried along as text.
top : {"error", "extend"}
    A curve that stops short of 100 % is refused, or its last slope is carried on, as far as the next
    sieve, twice the coarsest, at most.
number : bool
    The shares count grains. They are converted to mass with weights of size cubed, mass taken as
    even in ln(size) between sieves; `notes` says so.
notes : sequence of str
    Assumptions made in preparing the numbers; they stand first in the grading's `notes`.

Returns
-------
Grading

Raises
------
ParameterError
    For a size, a share or a curve that no grading can have. Its `place` has the row: the position of the point
    in the lists, counted from 1.
ShapeError
    For lists of different lengths.

Examples
--------
>>> import comminute as cm
>>> sand = cm.Grading.from_sieves([2.0, 1.0, 0.5], [100, 50, 0], unit="mm")
>>> sand.finer(1.0)
0.5
)doc")
        .def_property_readonly(
            "unit", [](const Grading& g) { return g.unit; }, "Unit of the sizes, as text; empty if relative.")
        .def_property_readonly(
            "notes", [](const Grading& g) { return py::tuple(py::cast(g.notes)); },
            "Assumptions made on the way, in plain words: a tuple of str.")
        .def("finer", py::vectorize(&Grading::finer), py::arg("size"),
             R"doc(Mass fraction of grains no larger than `size` (scalar or array).

Raises
------
ParameterError
    Unless size > 0.
)doc")
        .def_property_readonly("largest", &Grading::largest, "Largest size.")
        .def_property_readonly(
            "measured", [](const Grading& g) { return std::holds_alternative<SieveCurve>(g.law); },
            "Whether it was measured: sieve data, not a law or exact sizes.")
        .def("smallest", &Grading::smallest, py::arg("tail") = 0.0,
             "Size below which a share `tail` of the mass lies; 0 if the finest tail has no end.")
        .def("percentile", py::vectorize(&Grading::percentile), py::arg("percent"), py::kw_only(),
             py::arg("extrapolate") = false,
             R"doc(Size D_x such that `percent` of the mass is finer (scalar or array).

inf{d : F(d) >= percent / 100}: on a plateau this is its lower end. D_0 is the smallest size.

Parameters
----------
percent : float or sequence
    Share of the mass in per cent, in [0, 100].
extrapolate : bool
    Go on below the finest sieve, along the tail.

Returns
-------
float or ndarray
    The size, in `unit`.

Raises
------
ParameterError
    If D_x lies below the finest sieve of a measured curve.

Examples
--------
>>> import comminute as cm
>>> cm.gap_graded(1.0, 0.1).percentile([50, 51])
array([0.1, 1. ])
)doc")
        .def("with_unit", &with_unit, py::arg("unit"),
             R"doc(The same sizes, said to be in a unit: for ideal gradings, whose sizes have none.

Examples
--------
>>> import comminute as cm
>>> cm.fuller(16.0).with_unit("mm").unit
'mm'
)doc")
        .def("_points", &points, py::arg("count") = 20001,
             "Points of the curve, for `SizeCurve.of`: sizes, fractions finer, slope of the tail.")
        .def(
            "on_grid", [](const Grading& g, const LogGrid& grid) { return copied(g.on_grid(grid)); },
            py::arg("grid"),
            R"doc((N,) mass by bin; what is finer than the grid goes to the fines bin.

Raises
------
ParameterError
    If a grain is larger than the grid's last edge.
)doc")
        .def(
            "__eq__", [](const Grading& a, const Grading& b) { return a == b; }, py::is_operator())
        .def("__repr__",
             [](const Grading& g) {
                 return "<Grading " + describe(g.law) + (g.unit.empty() ? "" : " " + g.unit) + ">";
             })
        .def(py::pickle([](const Grading& g) { return py::make_tuple(state_of(g.law), g.unit, g.notes); },
                        [](const py::tuple& t) {
                            return Grading{law_of(t[0].cast<py::tuple>()), t[1].cast<std::string>(),
                                           t[2].cast<std::vector<std::string>>()};
                        }));
}
