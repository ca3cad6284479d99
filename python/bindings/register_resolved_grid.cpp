// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "rooms.hpp"

namespace {

using namespace comminute;

const NodeOptions node_defaults;

template <class Of>
py::array_t<double> by_node(const ResolvedGrid& grid, const Of& of) {
    py::array_t<double> values(grid.nodes());
    for (Index i = 0; i < grid.nodes(); ++i) values.mutable_at(i) = of(i);
    return values;
}

py::object exponential(const py::object& psi) {
    return py::module_::import("numpy").attr("exp")(psi);
}

std::vector<Support> supports_of(const std::vector<std::pair<double, double>>& pairs) {
    std::vector<Support> supports;
    for (const auto& [lower, upper] : pairs) supports.push_back({lower, upper});
    return supports;
}

NodeOptions node_options(double spacing, double grade, Index support_bins) {
    return {spacing, grade, support_bins};
}

}  // namespace

void register_resolved_grid(py::module_& m) {
    py::class_<ResolvedGrid>(
        m, "ResolvedGrid",
        R"doc(Sizes of the resolved continuum: bins of uneven width, and exact sizes between them.

Node 0 is the fines bin: it holds the mass of all that is finer, never crushes, and as a neighbour has the size of its
centre. An exact size is a node of no width, above the bin that ends there.

Parameters
----------
lower, upper : array_like (N,)
    Ends of the nodes in ln(size), the fines bin first; each begins where the one before ends.

Raises
------
ShapeError, ParameterError
    For nodes that do not rise without gaps.

Examples
--------
>>> import comminute as cm
>>> cm.ResolvedGrid([-3.0, -1.0, 0.0], [-1.0, 0.0, 0.0]).exact
array([False, False,  True])
)doc")
        .def(py::init<std::vector<double>, std::vector<double>>(), py::arg("lower"), py::arg("upper"))
        .def_static(
            "graded",
            [](double fabric_width, double bottom, std::vector<double> exact,
               const std::vector<std::pair<double, double>>& supports, const std::vector<double>& edges,
               double spacing, double grade, Index support_bins) {
                return ResolvedGrid::graded(fabric_width, bottom, std::move(exact), supports_of(supports),
                                            node_options(spacing, grade, support_bins), edges);
            },
            py::arg("fabric_width"), py::arg("bottom"), py::arg("exact") = std::vector<double>(),
            py::arg("supports") = std::vector<std::pair<double, double>>(), py::kw_only(),
            py::arg("edges") = std::vector<double>(), py::arg("spacing") = node_defaults.spacing,
            py::arg("grade") = node_defaults.grade, py::arg("support_bins") = node_defaults.support_bins,
            R"doc(Bins that are narrow below every exact size and both ends of every support, and widen away from these.

Parameters
----------
fabric_width : float
    n, the scale of a zone's width.
bottom : float
    Upper end of the fines bin in ln(size), below all other sizes.
exact : list of float
    Exact log sizes.
supports : list of (float, float)
    Pieces of ln(size) over which the rest of the mass is spread.
edges : list of float
    Log sizes that are to be ends of bins, such as sieves.
spacing, grade, support_bins
    Widest bin in ln(size), bins next to a jump as a multiple of the fabric width, least number of bins to a support.

Returns
-------
ResolvedGrid

Raises
------
ParameterError
    For a size below the bottom, or a width that is not greater than 0.

Examples
--------
>>> import comminute as cm
>>> cm.ResolvedGrid.graded(0.05, -8.0, [0.0])
<ResolvedGrid: 46 nodes, 1 of them exact, -8 to 0>
)doc")
        .def_static(
            "fitting",
            [](const Grading& grading, double fabric_width, const std::vector<double>& edges, double spacing,
               double grade, Index support_bins) {
                return fitting_nodes(grading, fabric_width, node_options(spacing, grade, support_bins),
                                     edges);
            },
            py::arg("grading"), py::arg("fabric_width"), py::kw_only(),
            py::arg("edges") = std::vector<double>(), py::arg("spacing") = node_defaults.spacing,
            py::arg("grade") = node_defaults.grade, py::arg("support_bins") = node_defaults.support_bins,
            R"doc(Nodes for a grading: its exact sizes, the ends of its spread, its sieves as ends of bins.

The fines bin begins at least 8 in ln(size) below the largest grain, and 1 below the size that a thousandth of the mass
is finer than.

Parameters
----------
grading : Grading
fabric_width : float
edges : list of float
    Log sizes at which the curve is wanted, which become ends of bins; the fines bin begins below them.
spacing, grade, support_bins
    As for `graded`.

Returns
-------
ResolvedGrid

Raises
------
ParameterError
    For an edge that is no number, or a width that is not greater than 0.

Examples
--------
>>> import comminute as cm
>>> cm.ResolvedGrid.fitting(cm.gap_graded(1.0, 0.1), 0.05)
<ResolvedGrid: 50 nodes, 2 of them exact, -8 to 0>
)doc")
        .def_property_readonly("nodes", &ResolvedGrid::nodes, "Number of nodes, N.")
        .def_property_readonly("bins", &ResolvedGrid::bins,
                               "Number of bins, B: of the nodes that are no exact size.")
        .def_property_readonly(
            "edges", [](const ResolvedGrid& g) { return copied(g.edges()); },
            "(B + 1,) edges of the bins, psi; an exact size lies on the upper edge of its bin.")
        .def_property_readonly(
            "centres",
            [](const ResolvedGrid& g) {
                const std::vector<double> edges = g.edges();
                std::vector<double> centres;
                for (std::size_t i = 1; i < edges.size(); ++i)
                    centres.push_back(0.5 * (edges[i - 1] + edges[i]));
                return copied(centres);
            },
            "(B,) centres of the bins, psi.")
        .def_property_readonly(
            "edge_sizes", [](const ResolvedGrid& g) { return exponential(copied(g.edges())); },
            "(B + 1,) sizes at the edges.")
        .def_property_readonly(
            "sizes", [](const py::object& g) { return exponential(g.attr("centres")); },
            "(B,) sizes at the centres.")
        .def_property_readonly(
            "lower", [](const ResolvedGrid& g) { return by_node(g, [&](Index i) { return g.lower(i); }); },
            "(N,) lower ends in ln(size).")
        .def_property_readonly(
            "upper", [](const ResolvedGrid& g) { return by_node(g, [&](Index i) { return g.upper(i); }); },
            "(N,) upper ends in ln(size).")
        .def_property_readonly(
            "exact",
            [](const ResolvedGrid& g) {
                py::array_t<bool> exact(g.nodes());
                for (Index i = 0; i < g.nodes(); ++i) exact.mutable_at(i) = g.exact(i);
                return exact;
            },
            "(N,) whether a node is an exact size.")
        .def(
            "pmf", [](const ResolvedGrid& g, const Grading& grading) { return copied(node_pmf(grading, g)); },
            py::arg("grading"), R"doc((N,) mass of a grading by node.

Raises
------
ParameterError
    For grains above the grid.

Examples
--------
>>> import comminute as cm
>>> grid = cm.ResolvedGrid.graded(0.05, -8.0, [0.0])
>>> float(grid.pmf(cm.monodisperse(1.0))[-1])
1.0
)doc")
        .def("__repr__",
             [](const ResolvedGrid& g) {
                 Index exact = 0;
                 for (Index i = 0; i < g.nodes(); ++i) exact += g.exact(i) ? 1 : 0;
                 return "<ResolvedGrid: " + std::to_string(g.nodes()) + " nodes, " + std::to_string(exact) +
                        " of them exact, " + text(g.upper(0)) + " to " + text(g.upper(g.nodes() - 1)) + ">";
             })
        .def(
            "__eq__", [](const ResolvedGrid& a, const ResolvedGrid& b) { return a == b; }, py::is_operator())
        .def("__hash__",
             [](const ResolvedGrid& g) {
                 return py::hash(py::make_tuple(g.nodes(), g.lower(1), g.upper(g.nodes() - 1)));
             })
        .def(py::pickle(
            [](const ResolvedGrid& g) {
                return py::make_tuple(by_node(g, [&](Index i) { return g.lower(i); }),
                                      by_node(g, [&](Index i) { return g.upper(i); }));
            },
            [](const py::tuple& ends) {
                return ResolvedGrid(ends[0].cast<std::vector<double>>(), ends[1].cast<std::vector<double>>());
            }));
}
