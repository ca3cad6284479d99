// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "interrupt.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

const ResolvedOptions defaults;

/// Nodes that suit all of the materials: those of the smallest fabric width.
ResolvedGrid common_nodes(const std::vector<Material>& materials, const Grading& start) {
    double smallest = materials.empty() ? Material{}.fabric_width : materials.front().fabric_width;
    for (const Material& material : materials) smallest = std::min(smallest, material.fabric_width);
    return fitting_nodes(start, smallest);
}

py::array_t<double> gradings(const std::vector<Material>& materials, const Grading& start,
                             const py::object& stress_ratio, std::optional<ResolvedGrid> grid,
                             const std::string& mean, double tolerance, double max_step, Index threads) {
    const auto members = static_cast<Index>(materials.size());
    auto loads = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(stress_ratio);
    if (!loads) throw py::error_already_set();
    if (loads.ndim() == 1) {
        const Index each = loads.shape(0);
        py::array_t<double> all({members, each});
        for (Index m = 0; m < members; ++m) std::copy_n(loads.data(), each, all.mutable_data(m));
        loads = std::move(all);
    }
    if (loads.ndim() != 2) {
        throw ShapeError({.parameter = "stress_ratio",
                          .finding = "has " + std::to_string(loads.ndim()) + " dimensions",
                          .rule = "it must be (T,) loads for all materials, or (M, T)"});
    }
    if (!grid) grid = common_nodes(materials, start);
    const Index count = loads.shape(1);
    const MatrixView<const double> view(loads.data(), loads.shape(0), count);
    const ResolvedOptions options{choice_of<Mean>(mean), tolerance, max_step, 1};
    std::vector<double> mass;
    {
        const py::gil_scoped_release release;
        mass =
            resolved_gradings(*grid, node_pmf(start, *grid), materials, view, options, threads, Interrupt{});
    }
    return py::array_t<double>({members, count, grid->nodes()}, mass.data());
}

}  // namespace

void register_resolved_batch(py::module_& m) {
    m.def("resolved_gradings", &gradings, py::arg("materials"), py::arg("start"), py::arg("stress_ratio"),
          py::arg("grid") = py::none(), py::kw_only(), py::arg("mean") = word_of(defaults.mean),
          py::arg("tolerance") = defaults.tolerance, py::arg("max_step") = defaults.max_step,
          py::arg("threads") = 1,
          R"doc(Gradings of many materials from one start, by the law of three cells: for fits and sweeps.

All have the nodes of one grid, on which curves change smoothly with the material.

Parameters
----------
materials : sequence of Material
start : Grading
    The packing is a random mixture of its grains.
stress_ratio : ndarray (T,) or (M, T)
    Loads, for all materials or of each, in any order: a lower one changes nothing.
grid : ResolvedGrid, optional
    Left out: `ResolvedGrid.fitting` of the start and the smallest fabric width.
mean, tolerance, max_step
    As for `Resolved`.
threads : int
    Materials that are worked on at a time; the same bits.

Returns
-------
ndarray (M, T, N)
    Mass by node; see `ResolvedGrid`.

Raises
------
ShapeError
    For loads of another number of materials.
ParameterError
    As `Resolved`, naming the material.

Examples
--------
>>> import comminute as cm
>>> sands = [cm.Material(weibull_modulus=w) for w in (3.0, 6.0)]
>>> mass = cm.resolved_gradings(sands, cm.monodisperse(1.0), [1.0, 8.0])
>>> mass.shape, mass[:, 0, -1].round(4)  # equal grains do not know their modulus under the first load
((2, 2, 46), array([0.5677, 0.5677]))
)doc");
}
