// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

py::tuple fields(const SolveReport& r) {
    return py::make_tuple(word_of(r.path), r.terms, r.head, r.fit_error, r.crushed, r.crushed_neighbour);
}

}  // namespace

void register_solve_report(py::module_& m) {
    py::class_<SolveReport>(m, "SolveReport",
                            R"doc(Report of one quasi-static solve: its path and its crushed mass.

Masses are shares of the whole.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-6.0, 0.0, 301)
>>> solver = cm.QuasiStatic(grid, cm.Material())
>>> after = solver.solve(cm.mixed_fabric(cm.monodisperse(1.0), grid), 1.0)
>>> float(round(solver.report.crushed, 12))
0.5
)doc")
        .def(py::init([](const std::string& path, Index terms, Index head, double fit_error, double crushed,
                         double crushed_neighbour) {
                 return SolveReport{choice_of<SolvePath>(path), terms, head, fit_error, crushed,
                                    crushed_neighbour};
             }),
             py::arg("path"), py::arg("terms"), py::arg("head"), py::arg("fit_error"), py::arg("crushed"),
             py::arg("crushed_neighbour"))
        .def_property_readonly(
            "path", [](const SolveReport& r) { return word_of(r.path); },
            "\"narrow\", \"sums\", \"direct\" or \"blend\"; \"none\" where nothing had to move.")
        .def_readonly("terms", &SolveReport::terms, "Terms K of the exponential sum; 0 on a path without.")
        .def_readonly("head", &SolveReport::head, "Reductions of up to so many bins were added one by one.")
        .def_readonly("fit_error", &SolveReport::fit_error,
                      "Largest error of the sum, as a share of the largest fragment bin.")
        .def_readonly("crushed", &SolveReport::crushed, "Mass crushed in psi, every crush counted.")
        .def_readonly("crushed_neighbour", &SolveReport::crushed_neighbour, "Mass crushed in psibar.")
        .def(
            "__eq__", [](const SolveReport& a, const SolveReport& b) { return fields(a).equal(fields(b)); },
            py::is_operator())
        .def("__repr__",
             [](const SolveReport& r) {
                 return repr_of("SolveReport", "path", word_of(r.path), "terms", r.terms, "head", r.head,
                                "fit_error", r.fit_error, "crushed", r.crushed, "crushed_neighbour",
                                r.crushed_neighbour);
             })
        .def(py::pickle([](const SolveReport& r) { return fields(r); },
                        [](const py::tuple& t) {
                            return SolveReport{choice_of<SolvePath>(t[0].cast<std::string>()),
                                               t[1].cast<Index>(),
                                               t[2].cast<Index>(),
                                               t[3].cast<double>(),
                                               t[4].cast<double>(),
                                               t[5].cast<double>()};
                        }));

    py::class_<Marginal>(m, "Marginal", R"doc(Grading after a quasi-static solve, without the state.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-6.0, 0.0, 301)
>>> start = cm.mixed_fabric(cm.monodisperse(1.0), grid)
>>> after = cm.QuasiStatic(grid, cm.Material()).grading_after(start, 1.0)
>>> [(point.psi, float(round(point.mass, 12))) for point in after.points]
[(0.0, 0.5)]
)doc")
        .def_property_readonly(
            "grainsize", [](const Marginal& r) { return copied(r.grainsize); },
            "(N,) mass by bin, exact sizes in theirs.")
        .def_property_readonly(
            "points", [](const Marginal& r) { return r.points; },
            "List of PointMass, fine to coarse: what of it is still at an exact size.")
        .def_property_readonly(
            "report", [](const Marginal& r) { return r.report; }, "SolveReport of the solve.")
        .def_property_readonly("mass_error", &Marginal::mass_error, "Total mass less 1, summed exactly.")
        .def(
            "__eq__",
            [](const Marginal& a, const Marginal& b) {
                return a.grainsize == b.grainsize && a.points == b.points &&
                       fields(a.report).equal(fields(b.report));
            },
            py::is_operator())
        .def("__repr__",
             [](const Marginal& r) {
                 return repr_of("Marginal", "bins", r.grainsize.size(), "points", r.points, "report",
                                r.report);
             })
        .def(py::pickle(
            [](const Marginal& r) { return py::make_tuple(copied(r.grainsize), r.points, r.report); },
            [](const py::tuple& t) {
                return Marginal{t[0].cast<std::vector<double>>(), t[1].cast<std::vector<PointMass>>(),
                                t[2].cast<SolveReport>()};
            }));
}
