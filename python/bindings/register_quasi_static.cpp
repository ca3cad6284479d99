// SPDX-License-Identifier: BSD-3-Clause
#include <mutex>

#include "arrays.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

py::tuple fields(const SolveReport& r) {
    return py::make_tuple(word_of(r.path), r.terms, r.head, r.fit_error, r.crushed, r.crushed_neighbour);
}

/// A solver with its workspace behind a lock, since the GIL does not guard it while it runs.
class Solver {
  public:
    Solver(const LogGrid& grid, const Material& material, const std::string& scheme, double loading_rate,
           const std::string& path)
        : solver_(grid, material, choice_of<Scheme>(scheme), loading_rate, choice_of<SolvePath>(path)) {}

    const QuasiStatic& get() const { return solver_; }

    SolveReport report() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return report_;
    }

    Fabric solve(const Fabric& state, double stress_ratio, std::optional<double> settled_at,
                 const py::object& out) {
        if (!out.is_none())
            throw py::type_error("out belongs to an array; a Fabric is never changed in place");
        refuse_second_load(settled_at);
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return solver_.solve(state, stress_ratio, &report_);
    }

    py::array_t<double> solve_array(const py::object& state, double stress_ratio,
                                    std::optional<double> settled_at, const py::object& out) {
        const auto before = strict_array(state, shape(), "state");
        auto after = strict_out(out, shape(), "out");
        const auto from = matrix_in(before);
        const auto to = matrix_out(after);
        {
            const py::gil_scoped_release release;
            const std::lock_guard lock(mutex_);
            report_ = solver_.solve(from, stress_ratio, settled_at, to);
        }
        return after;
    }

    Marginal grading_after(const Fabric& state, double stress_ratio) {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        Marginal marginal = solver_.marginal(state, stress_ratio);
        report_ = marginal.report;
        return marginal;
    }

    py::array_t<double> marginal(const Fabric& state, double stress_ratio, std::optional<double> settled_at) {
        refuse_second_load(settled_at);
        return copied(grading_after(state, stress_ratio).grainsize);
    }

    py::array_t<double> marginal_of_array(const py::object& state, double stress_ratio,
                                          std::optional<double> settled_at) {
        const auto before = strict_array(state, shape(), "state");
        const auto from = matrix_in(before);
        py::array_t<double> after(solver_.grid().bins());
        const VectorView<double> to(after.mutable_data(), solver_.grid().bins());
        {
            const py::gil_scoped_release release;
            const std::lock_guard lock(mutex_);
            report_ = solver_.marginal(from, stress_ratio, settled_at, to);
        }
        return after;
    }

  private:
    static void refuse_second_load(std::optional<double> settled_at) {
        if (settled_at) {
            throw ParameterError("settled_at is " + text(*settled_at) +
                                 " beside a Fabric, which carries its own; leave it out");
        }
    }

    std::vector<py::ssize_t> shape() const { return {solver_.grid().bins(), solver_.grid().bins()}; }

    QuasiStatic solver_;
    std::mutex mutex_;
    SolveReport report_;
};

py::tuple settings(const Solver& s) {
    return py::make_tuple(s.get().grid(), s.get().material(), word_of(s.get().scheme()),
                          s.get().loading_rate(), word_of(s.get().path()));
}

std::unique_ptr<Solver> make(const LogGrid& grid, const Material& material, const std::string& scheme,
                             double loading_rate, const std::string& path) {
    return std::make_unique<Solver>(grid, material, scheme, loading_rate, path);
}

void register_reports(py::module_& m) {
    py::class_<SolveReport>(m, "SolveReport", R"doc(What one quasi-static solve did, and how.

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
            "\"sums\", \"direct\" or \"blend\"; \"none\" where nothing had to move.")
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

}  // namespace

void register_quasi_static(py::module_& m) {
    register_reports(m);
    py::class_<Solver>(m, "QuasiStatic",
                       R"doc(The state to which infinitely slow loading leads, in one sweep.

Under the slow rule (Eq. 63) what mass does depends on its place alone; the load only decides whether
it must move, and crush zones only grow. So one solve equals any slow path to the same load, and
unloading changes nothing. The same holds for the blend (Eq. 67) at a constant rate; the exact kernel
(Eq. 59) has no such solve.

Parameters
----------
grid : LogGrid
material : Material
scheme : {"conservative", "paper"}
    "conservative": finite-volume fragments, cells move by the share of their area inside the zone,
    exact sizes stay exact; second order in the bin width. "paper": the paper's fragments, cells move
    whole by the test of their centre, exact sizes go to bins.
loading_rate : float
    Share of the fast kernel (Eq. 67), in [0, 1]; above 0 a solve takes O(N^3).
path : {"automatic", "direct", "sums"}
    How fragments are added up: bin by bin, or by running sums of the law's exponential sum where it
    has one. "automatic" takes what costs less.

Raises
------
ParameterError
    For a word or a loading rate outside its range.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-12.0, 0.0, 601)
>>> start = cm.mixed_fabric(cm.gap_graded(1.0, 0.1), grid)
>>> solver = cm.QuasiStatic(grid, cm.Material())
>>> after = solver.solve(start, 100.0)
>>> bool(solver.report.crushed > 0.1), after.settled_at
(True, 100.0)
>>> cm.QuasiStatic(grid, cm.Material()).solve(after, 50.0) == after
True
)doc")
        .def(py::init(&make), py::arg("grid"), py::arg("material"), py::arg("scheme") = "conservative",
             py::arg("loading_rate") = 0.0, py::kw_only(), py::arg("path") = "automatic")
        .def("solve", &Solver::solve, py::arg("state"), py::arg("stress_ratio"),
             py::arg("settled_at") = py::none(), py::arg("out") = py::none(),
             R"doc(State at rest under a load.

Parameters
----------
state : Fabric or ndarray (N, N)
    On the solver's grid. An array has no exact sizes.
stress_ratio : float
    Load, >= 0.
settled_at : float, optional
    For an array: largest load under which it is at rest; None: never loaded. A Fabric carries its own.
out : ndarray (N, N), optional
    For an array: where to write the new state; may be `state` itself.

Returns
-------
Fabric or ndarray (N, N)
    As `state`. `report` says how.

Raises
------
TypeError, ShapeError, ParameterError
    For a state or load that does not fit; the message says which.
)doc")
        .def("solve", &Solver::solve_array, py::arg("state"), py::arg("stress_ratio"),
             py::arg("settled_at") = py::none(), py::arg("out") = py::none())
        .def("marginal", &Solver::marginal, py::arg("state"), py::arg("stress_ratio"),
             py::arg("settled_at") = py::none(),
             R"doc(Mass by grainsize under a load, without the state.

For a Fabric it reads the band of the zone and no more.

Parameters
----------
state, stress_ratio, settled_at
    As for `solve`.

Returns
-------
ndarray (N,)

Raises
------
TypeError, ShapeError, ParameterError
    As `solve`.
)doc")
        .def("marginal", &Solver::marginal_of_array, py::arg("state"), py::arg("stress_ratio"),
             py::arg("settled_at") = py::none())
        .def("grading_after", &Solver::grading_after, py::arg("fabric"), py::arg("stress_ratio"),
             R"doc(The same as a Marginal: with the exact sizes that are left, and the report.

Parameters
----------
fabric : Fabric
stress_ratio : float

Returns
-------
Marginal

Raises
------
ParameterError
    As `solve`.
)doc")
        .def_property_readonly("report", &Solver::report, "SolveReport of the last solve or marginal.")
        .def_property_readonly(
            "grid", [](const Solver& s) { return s.get().grid(); }, "The LogGrid.")
        .def_property_readonly(
            "material", [](const Solver& s) { return s.get().material(); }, "The Material.")
        .def_property_readonly(
            "scheme", [](const Solver& s) { return word_of(s.get().scheme()); },
            "\"conservative\" or \"paper\".")
        .def_property_readonly(
            "loading_rate", [](const Solver& s) { return s.get().loading_rate(); },
            "Share of the fast kernel.")
        .def_property_readonly(
            "path", [](const Solver& s) { return word_of(s.get().path()); }, "As it was asked for.")
        .def(
            "__eq__", [](const Solver& a, const Solver& b) { return settings(a).equal(settings(b)); },
            py::is_operator())
        .def("__repr__",
             [](const Solver& s) {
                 return repr_of("QuasiStatic", "grid", s.get().grid(), "material", s.get().material(),
                                "scheme", word_of(s.get().scheme()), "loading_rate", s.get().loading_rate(),
                                "path", word_of(s.get().path()));
             })
        .def(py::pickle([](const Solver& s) { return settings(s); },
                        [](const py::tuple& t) {
                            return make(t[0].cast<LogGrid>(), t[1].cast<Material>(), t[2].cast<std::string>(),
                                        t[3].cast<double>(), t[4].cast<std::string>());
                        }));
}
