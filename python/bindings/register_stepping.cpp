// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

void register_cell_kernel(py::module_& m) {
    const KernelOptions defaults;
    m.def(
        "cell_kernel",
        [](const LogGrid& grid, const Material& material, double stress_ratio, Index i, Index j,
           const std::string& kind, double loading_rate, const std::string& scheme) {
            const Kernel kernel(grid, material,
                                {choice_of<KernelKind>(kind), loading_rate, choice_of<Scheme>(scheme)});
            py::array_t<double> out({grid.bins(), grid.bins()});
            kernel.cell(i, j, stress_ratio, matrix_out(out));
            return out;
        },
        py::arg("grid"), py::arg("material"), py::arg("stress_ratio"), py::arg("i"), py::arg("j"),
        py::arg("kind") = word_of(KernelKind::exact), py::kw_only(),
        py::arg("loading_rate") = defaults.loading_rate, py::arg("scheme") = word_of(defaults.scheme),
        R"doc(Places to which unit mass of one cell goes in one step (Fig. 5).

Parameters
----------
grid : LogGrid
material : Material
stress_ratio : float
    Load, >= 0.
i, j : int
    The cell, [psi, psibar].
kind : {"exact", "slow", "fast", "blend"}
    Eq. 59, 63, 68 or 67.
loading_rate : float
    Share of the fast kernel in a "blend", in [0, 1].
scheme : {"conservative", "paper"}
    Fragments on the grid, as in `fragment_pmf`: "conservative" are finite volumes, under "paper" every
    crush moves at least one bin, as in Fig. 5. Under either the cell's zone is that of its centre.

Returns
-------
ndarray (N, N)
    Sums to 1; what falls below an axis stays in its bin 0.

Raises
------
ParameterError
    For a cell off the grid, a bad load, or a loading rate with a kind that has none.

Examples
--------
>>> import comminute as cm
>>> kernel = cm.cell_kernel(cm.LogGrid(-6.0, 1.0, 71), cm.Material(), 100.0, 60, 60, kind="slow")
>>> kernel[60, :].sum().round(12), kernel[:, 60].sum().round(12)   # equals: half of each crushes
(np.float64(0.5), np.float64(0.5))
)doc");
}

void register_step_report(py::module_& m) {
    py::class_<StepReport>(m, "StepReport", R"doc(Report of one step, or of a run of steps.

Masses are in the unit of the state, whose total is usually 1.)doc")
        .def(py::init([](double active, double crushed, double crushed_neighbour, Index steps, Index terms) {
                 return StepReport{active, crushed, crushed_neighbour, steps, terms};
             }),
             py::arg("active"), py::arg("crushed"), py::arg("crushed_neighbour"), py::arg("steps"),
             py::arg("terms") = 0)
        .def_readonly("active", &StepReport::active, "Mass inside the zone when the last step began.")
        .def_readonly("crushed", &StepReport::crushed, "Mass crushed in psi, every crush counted.")
        .def_readonly("crushed_neighbour", &StepReport::crushed_neighbour, "Mass crushed in psibar.")
        .def_readonly("steps", &StepReport::steps, "Number of steps.")
        .def_readonly("terms", &StepReport::terms,
                      "Terms of the exponential sum by which the last step spread mass; 0: by other means.")
        .def(
            "__eq__",
            [](const StepReport& a, const StepReport& b) {
                return a.active == b.active && a.crushed == b.crushed && a.steps == b.steps &&
                       a.crushed_neighbour == b.crushed_neighbour && a.terms == b.terms;
            },
            py::is_operator())
        .def("__repr__",
             [](const StepReport& r) {
                 return repr_of("StepReport", "active", r.active, "crushed", r.crushed, "crushed_neighbour",
                                r.crushed_neighbour, "steps", r.steps, "terms", r.terms);
             })
        .def(py::pickle(
            [](const StepReport& r) {
                return py::make_tuple(r.active, r.crushed, r.crushed_neighbour, r.steps, r.terms);
            },
            [](const py::tuple& t) {
                return StepReport{t[0].cast<double>(), t[1].cast<double>(), t[2].cast<double>(),
                                  t[3].cast<Index>(), t[4].cast<Index>()};
            }));
}

}  // namespace

void register_stepping(py::module_& m) {
    register_cell_kernel(m);
    register_step_report(m);
    register_slow_update(m);
    register_full_convolution(m);
}
