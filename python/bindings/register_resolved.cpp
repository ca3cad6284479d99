// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "arrays.hpp"
#include "resolved_records.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

const ResolvedOptions defaults;

py::array_t<double> cube(const std::vector<double>& values, Index nodes) {
    return py::array_t<double>({nodes, nodes, nodes}, values.data());
}

/// A law behind a lock, since the GIL does not guard it while it is stepped.
class Law {
  public:
    explicit Law(Resolved law) : law_(std::move(law)) {}
    Law(const Law& other) : law_(other.copy()) {}

    template <class Call>
    auto with(const Call& call) const {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return call(law_);
    }
    template <class Call>
    void change(const Call& call) {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        call(law_);
    }
    /// Grid, material and options, which do not change.
    const Resolved& fixed() const { return law_; }

  private:
    Resolved copy() const {
        const std::lock_guard lock(mutex_);
        return law_;
    }

    mutable std::mutex mutex_;
    Resolved law_;
};

using Start = std::variant<Grading, py::array_t<double>>;

std::unique_ptr<Law> made(const Material& material, const Start& start, std::optional<ResolvedGrid> grid,
                          const std::string& mean, double tolerance, double max_step, Index threads) {
    const ResolvedOptions options{choice_of<Mean>(mean), tolerance, max_step, threads};
    if (const auto* grading = std::get_if<Grading>(&start)) {
        const ResolvedGrid nodes = grid ? *grid : fitting_nodes(*grading, material.fabric_width);
        return std::make_unique<Law>(Resolved(nodes, material, node_pmf(*grading, nodes), options));
    }
    if (!grid) {
        throw ParameterError({.parameter = "grid",
                              .subject = "a start by nodes",
                              .finding = "names no nodes",
                              .rule = "give the ResolvedGrid that it is meant on"});
    }
    const auto& masses = std::get<py::array_t<double>>(start);
    const py::array_t<double> array =
        masses.ndim() == 3
            ? strict_array(masses, {grid->nodes(), grid->nodes(), grid->nodes()}, "start", "the grid")
            : strict_array(masses, {grid->nodes()}, "start", "the grid");
    const std::vector<double> values(array.data(), array.data() + array.size());
    return std::make_unique<Law>(array.ndim() == 3 ? Resolved::of_triples(*grid, material, values, options)
                                                   : Resolved(*grid, material, values, options));
}

std::unique_ptr<Law> from_lattice(const py::object& lattice, std::optional<ResolvedGrid> grid,
                                  double tolerance, double max_step, Index threads) {
    const auto material = lattice.attr("material").cast<Material>();
    if (material.strength_scatter && lattice.attr("crushes").attr("any")().cast<bool>()) {
        throw ParameterError({.parameter = "lattice",
                              .subject = "the lattice",
                              .finding = "has been loaded, so that its grains are those which proved strong",
                              .rule = "with scattered strengths give a lattice that no load has crushed"});
    }
    const auto psi = lattice.attr("psi").cast<py::array_t<double>>();
    if (!grid)
        grid = fitting_nodes(VectorView<const double>(psi.data(), psi.size()),
                             lattice.attr("points").cast<std::vector<PointMass>>(), material.fabric_width);
    const Index rings = psi.shape(0);
    const Index cells = psi.shape(1);
    std::vector<double> triples(static_cast<std::size_t>(grid->nodes() * grid->nodes() * grid->nodes()), 0.0);
    for (Index k = 0; k < rings; ++k) {
        const std::vector<double> ring = count_triples({psi.data() + k * cells, cells}, *grid);
        for (std::size_t i = 0; i < ring.size(); ++i) triples[i] += ring[i] / static_cast<double>(rings);
    }
    const ResolvedOptions options{choice_of<Mean>(lattice.attr("mean").cast<std::string>()), tolerance,
                                  max_step, threads};
    return std::make_unique<Law>(Resolved::of_triples(*grid, material, triples, options));
}

}  // namespace

void register_resolved(py::module_& m) {
    register_resolved_grid(m);
    py::class_<Law>(m, "Resolved", R"doc(The neighbour-resolved continuum: the law of three adjacent cells.

It keeps both neighbours of a cell, where the paper's model keeps their mean, and closes with one assumption: of two
adjacent cells, what is left of them knows nothing of what is right of them. Without a fitted constant its gradings
agree with the lattice's to .0005 to .006. Quasi-static and free of noise; loads may be given in any steps.

Parameters
----------
material : Material
    With a finite fabric width.
start : Grading, or ndarray (N,) or (N, N, N)
    A random mixture of these grains, or of the mass of each node; or the mass of the centre b between a and c at
    [b, a, c].
grid : ResolvedGrid, optional
    Left out: `ResolvedGrid.fitting(start, material.fabric_width)`.
mean : {"arithmetic", "geometric"}
    How two neighbours make a neighbourhood grainsize (Eq. 48 or 65).
tolerance : float
    Mass that the crush zone may overrun in one step; `step_error` tells the error.
max_step : float
    Longest step in ln(stress ratio).
threads : int
    1 or 2, with the same bits.

Raises
------
ParameterError, ShapeError
    For an infinite fabric width, an option outside its range, or masses that are none.

Examples
--------
>>> import comminute as cm
>>> grains = cm.Resolved(cm.Material(), cm.monodisperse(1.0))
>>> grains.load_to(1.0)
>>> round(grains.crushes, 4)  # random sequential adsorption: (1 - e**-2) / 2
0.4323
>>> grains
<Resolved: 46 nodes, at rest under 1, 0.432 crushes a cell>
)doc")
        .def(py::init(&made), py::arg("material"), py::arg("start"), py::arg("grid") = py::none(),
             py::kw_only(), py::arg("mean") = word_of(defaults.mean),
             py::arg("tolerance") = defaults.tolerance, py::arg("max_step") = defaults.max_step,
             py::arg("threads") = defaults.threads)
        .def_static("from_lattice", &from_lattice, py::arg("lattice"), py::arg("grid") = py::none(),
                    py::kw_only(), py::arg("tolerance") = defaults.tolerance,
                    py::arg("max_step") = defaults.max_step, py::arg("threads") = defaults.threads,
                    R"doc(The law of the triples that a lattice has now, counted, at no load.

Parameters
----------
lattice : Lattice
    Its material and mean are taken too.
grid : ResolvedGrid, optional
    Left out: its exact sizes, and the range of all others as one support.
tolerance, max_step, threads
    As for `Resolved`.

Returns
-------
Resolved

Examples
--------
>>> import comminute as cm
>>> lattice = cm.Lattice(20_000, cm.Material(), cm.gap_graded(1.0, 0.1))
>>> counted = cm.Resolved.from_lattice(lattice)
>>> abs(counted.pmf()[-1] - 0.5) < 0.02
np.True_
)doc")
        .def(
            "load_to",
            [](Law& l, double stress_ratio) { l.change([&](Resolved& r) { r.load_to(stress_ratio); }); },
            py::arg("stress_ratio"), R"doc(Raise the load; a lower one changes nothing.

Raises
------
ParameterError
    For a stress ratio that is negative, NaN or above e**700.
)doc")
        .def(
            "remix", [](Law& l) { l.change([](Resolved& r) { r.remix(); }); },
            "Mix the packing anew: a random mixture of the same grains, at no load.")
        .def(
            "pmf", [](const Law& l) { return copied(l.with([](const Resolved& r) { return r.pmf(); })); },
            "(N,) mass by node.")
        .def(
            "cdf",
            [](const Law& l) {
                std::vector<double> mass = l.with([](const Resolved& r) { return r.pmf(); });
                for (std::size_t i = 1; i < mass.size(); ++i) mass[i] += mass[i - 1];
                return copied(mass);
            },
            "(N,) mass up to the upper end of each node, that of an exact size with it.")
        .def(
            "triples",
            [](const Law& l) {
                return cube(l.with([](const Resolved& r) { return r.triples(); }), l.fixed().grid().nodes());
            },
            "(N, N, N) mass of the centre b between a and c at [b, a, c].")
        .def(
            "joint",
            [](const Law& l, const LogGrid& grid) {
                const std::vector<double> joint = l.with([&](const Resolved& r) { return r.joint(grid); });
                return py::array_t<double>({grid.bins(), grid.bins()}, joint.data());
            },
            py::arg("grid"), R"doc((N, N) mass by bins of log grainsize and log neighbourhood grainsize.

Raises
------
ParameterError
    For a grid below the largest grain.
)doc")
        .def_property_readonly(
            "crushes", [](const Law& l) { return l.with([](const Resolved& r) { return r.crushes(); }); },
            "Mean number of crushes a cell has been through since the start.")
        .def_property_readonly(
            "avalanches",
            [](const Law& l) { return l.with([](const Resolved& r) { return r.avalanches(); }); },
            "Avalanches a cell has begun since the start: crushes by the load, not by a neighbour's crush.")
        .def_property_readonly(
            "step_error",
            [](const Law& l) { return l.with([](const Resolved& r) { return r.step_error(); }); },
            "Largest difference of the coarse and the fine curve, several times the error by the steps.")
        .def_property_readonly(
            "settled_at",
            [](const Law& l) { return l.with([](const Resolved& r) { return r.settled_at(); }); },
            "Largest load since the last mixing; 0 before any.")
        .def_property_readonly(
            "steps", [](const Law& l) { return l.with([](const Resolved& r) { return r.steps(); }); },
            "Steps of both states since the last mixing.")
        .def_property_readonly(
            "grid", [](const Law& l) { return l.fixed().grid(); }, "The ResolvedGrid.")
        .def_property_readonly(
            "material", [](const Law& l) { return l.fixed().material(); }, "The Material.")
        .def_property_readonly(
            "mean", [](const Law& l) { return word_of(l.fixed().options().mean); },
            "\"arithmetic\" or \"geometric\".")
        .def("__repr__",
             [](const Law& l) {
                 const auto [load, crushes] =
                     l.with([](const Resolved& r) { return std::pair(r.settled_at(), r.crushes()); });
                 char shown[32];
                 std::snprintf(shown, sizeof shown, "%.3g", crushes);
                 return "<Resolved: " + std::to_string(l.fixed().grid().nodes()) + " nodes, at rest under " +
                        text(load) + ", " + shown + " crushes a cell>";
             })
        .def(
            "__eq__",
            [](const Law& a, const Law& b) {
                const ResolvedOptions& one = a.fixed().options();
                const ResolvedOptions& other = b.fixed().options();
                const bool alike = a.fixed().grid() == b.fixed().grid() &&
                                   a.fixed().material() == b.fixed().material() && one.mean == other.mean &&
                                   one.tolerance == other.tolerance && one.max_step == other.max_step;
                const auto record = [](const Resolved& r) { return r.record(); };
                return alike && a.with(record) == b.with(record);
            },
            py::is_operator())
        .def("__copy__", [](const Law& l) { return Law(l); })
        .def(
            "__deepcopy__", [](const Law& l, const py::dict&) { return Law(l); }, py::arg("memo"))
        .def(py::pickle(
            [](const Law& l) {
                const ResolvedRecord r = l.with([](const Resolved& law) { return law.record(); });
                const ResolvedOptions& o = l.fixed().options();
                return py::make_tuple(l.fixed().grid(), l.fixed().material(), word_of(o.mean), o.tolerance,
                                      o.max_step, o.threads, stored(r));
            },
            [](const py::tuple& t) {
                const ResolvedOptions options{choice_of<Mean>(t[2].cast<std::string>()), t[3].cast<double>(),
                                              t[4].cast<double>(), t[5].cast<Index>()};
                const ResolvedRecord record = resolved_record_of(t[6]);
                return std::make_unique<Law>(
                    Resolved(t[0].cast<ResolvedGrid>(), t[1].cast<Material>(), record, options));
            }));
    register_resolved_batch(m);
    register_resolved_column(m);
}
