// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>

#include "rooms.hpp"
#include "solver.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

py::tuple settings(const Solver& s) {
    const QuasiStaticOptions& o = s.get().options();
    return py::make_tuple(s.get().grid(), s.get().material(), word_of(o.scheme), o.loading_rate,
                          word_of(o.path));
}

std::unique_ptr<Solver> make(const LogGrid& grid, const Material& material, const std::string& scheme,
                             double loading_rate, const std::string& path) {
    return std::make_unique<Solver>(
        QuasiStatic(grid, material, {choice_of<Scheme>(scheme), loading_rate, choice_of<SolvePath>(path)}));
}

}  // namespace

void register_sweeping(py::module_& m) {
    register_solve_report(m);
    register_material_sweep(m);
    const QuasiStaticOptions defaults;
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
        .def(py::init(&make), py::arg("grid"), py::arg("material"),
             py::arg("scheme") = word_of(defaults.scheme), py::arg("loading_rate") = defaults.loading_rate,
             py::kw_only(), py::arg("path") = word_of(defaults.path))
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
    For an array: array for the new state; may be `state` itself.

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
        .def(
            "gradings_after", &Solver::gradings_after, py::arg("fabric"), py::arg("stress_ratios"),
            R"doc(The grading under each of many loads, to the bits of `grading_after`, in less time where zones are narrow.

Parameters
----------
fabric : Fabric
stress_ratios : sequence of float
    In any order: each is applied to `fabric` itself.

Returns
-------
list of Marginal

Raises
------
ParameterError
    As `solve`.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-6.0, 0.0, 64)
>>> start = cm.mixed_fabric(cm.power_law(2.5, 0.01, 1.0), grid)
>>> solver = cm.QuasiStatic(grid, cm.Material())
>>> low, high = solver.gradings_after(start, [10.0, 100.0])
>>> low == solver.grading_after(start, 10.0), high.report.crushed > low.report.crushed
(True, True)
)doc")
        .def("solve_batch", &Solver::solve_batch, py::arg("states"), py::arg("stress_ratio"),
             py::arg("settled_at") = py::none(), py::arg("out") = py::none(), py::arg("threads") = 1,
             py::kw_only(), py::arg("bad_states") = "raise",
             R"doc(Many states at rest, each under a load of its own, as a host code's material points are.

For each state it gives the very bits that `solve` gives, whatever the number of threads. States that
share their loads share the crush zones too, so a few loads for many states cost less.

Parameters
----------
states : ndarray (B, N, N)
    float64, C order.
stress_ratio : float or ndarray (B,)
    Loads, >= 0; a number is the load of all.
settled_at : float or ndarray (B,), optional
    Largest load under which each state is at rest, 0: never loaded. None: none was loaded. What it is for the new
    states is the solver's `settled_at`.
out : ndarray (B, N, N), optional
    Array for the new states; may be `states` itself.
threads : int
    At most so many at a time.
bad_states : {"raise", "keep"}
    A load that is NaN or negative, or a state with an entry that is no mass: an error for all, or that state
    stays as it is, `faults` says why, and the others are solved.

Returns
-------
ndarray (B, N, N)
    `reports` says how for each, `settled_at` under which load it is at rest.

Raises
------
TypeError, ShapeError, ParameterError
    Before anything is written, for the first input that does not fit; the message gives its index. Only
    masses so large that their sum overflows are found on the way.
KeyboardInterrupt
    On Ctrl-C; some states have been written then.

Examples
--------
>>> import comminute as cm
>>> import numpy as np
>>> grid = cm.LogGrid(-6.0, 0.0, 64)
>>> start = cm.mixed_fabric(cm.power_law(2.5, 0.01, 1.0), grid).probability
>>> solver = cm.QuasiStatic(grid, cm.Material())
>>> states = np.repeat(start[None], 3, axis=0)
>>> loads = np.array([2.0, 10.0, 100.0])
>>> states = solver.solve_batch(states, loads, out=states, threads=2)
>>> bool(np.all(states[1] == solver.solve(start, 10.0)))
True
>>> [report.crushed > 0.0 for report in solver.reports]
[True, True, True]
>>> states = solver.solve_batch(states, 5.0, settled_at=solver.settled_at)  # unloads two of them
>>> solver.settled_at
array([  5.,  10., 100.])
>>> states[1, 20, 20] = np.nan
>>> states = solver.solve_batch(states, 200.0, solver.settled_at, out=states, bad_states="keep")
>>> [str(fault) for fault in solver.faults.values()]
['states[1, 20, 20] is nan; every entry must be finite']
>>> solver.settled_at
array([200.,  10., 200.])
)doc")
        .def("marginal_batch", &Solver::marginal_batch, py::arg("states"), py::arg("stress_ratio"),
             py::arg("settled_at") = py::none(), py::arg("out") = py::none(), py::arg("threads") = 1,
             py::kw_only(), py::arg("bad_states") = "raise",
             R"doc(Mass by grainsize of many states, each under a load of its own, without the states.

For each it gives the very bits that `marginal` gives, whatever the number of threads.

Parameters
----------
states, stress_ratio, settled_at, threads, bad_states
    As for `solve_batch`; the grading of a bad state is NaN.
out : ndarray (B, N), optional
    Array for the gradings; may not overlap `states`.

Returns
-------
ndarray (B, N)

Raises
------
TypeError, ShapeError, ParameterError, KeyboardInterrupt
    As `solve_batch`.

Examples
--------
>>> import comminute as cm
>>> import numpy as np
>>> states = np.full((2, 32, 32), 1.0 / 32**2)
>>> solver = cm.QuasiStatic(cm.LogGrid(-6.0, 0.0, 32), cm.Material())
>>> gradings = solver.marginal_batch(states, np.array([2.0, 100.0]))
>>> bool(gradings[1, 0] > gradings[0, 0])
True
)doc")
        .def_property_readonly("reports", &Solver::reports,
                               "List of SolveReport, one for each state of the last batch.")
        .def_property_readonly(
            "settled_at", [](Solver& s) { return copied(s.settled_at()); },
            "(B,) load under which each state of the last batch is at rest, for the next.")
        .def_property_readonly(
            "faults",
            [](Solver& s) {
                py::dict errors;
                for (const auto& [b, fault] : s.faults()) errors[py::int_(b)] = parameter_error(fault);
                return errors;
            },
            "ParameterError of each state that the last batch left as it was, by its index.")
        .def_property_readonly("report", &Solver::report, "SolveReport of the last solve or marginal.")
        .def_property_readonly(
            "grid", [](const Solver& s) { return s.get().grid(); }, "The LogGrid.")
        .def_property_readonly(
            "material", [](const Solver& s) { return s.get().material(); }, "The Material.")
        .def_property_readonly(
            "scheme", [](const Solver& s) { return word_of(s.get().options().scheme); },
            "\"conservative\" or \"paper\".")
        .def_property_readonly(
            "loading_rate", [](const Solver& s) { return s.get().options().loading_rate; },
            "Share of the fast kernel.")
        .def_property_readonly(
            "path", [](const Solver& s) { return word_of(s.get().options().path); }, "As it was asked for.")
        .def(
            "__eq__", [](const Solver& a, const Solver& b) { return settings(a).equal(settings(b)); },
            py::is_operator())
        .def("__repr__",
             [](const Solver& s) {
                 return repr_of("QuasiStatic", "grid", s.get().grid(), "material", s.get().material(),
                                "scheme", word_of(s.get().options().scheme), "loading_rate",
                                s.get().options().loading_rate, "path", word_of(s.get().options().path));
             })
        .def(py::pickle([](const Solver& s) { return settings(s); },
                        [](const py::tuple& t) {
                            return make(t[0].cast<LogGrid>(), t[1].cast<Material>(), t[2].cast<std::string>(),
                                        t[3].cast<double>(), t[4].cast<std::string>());
                        }));
}
