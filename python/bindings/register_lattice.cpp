// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "guarded.hpp"
#include "interrupt.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

LatticeOptions options_of(std::uint64_t seed, Index replicas, const std::string& mean, Index threads,
                          bool record_avalanches) {
    return {seed, replicas, choice_of<Mean>(mean), threads, record_avalanches};
}

py::tuple options_state(const LatticeOptions& o) {
    return py::make_tuple(o.seed, o.replicas, word_of(o.mean), o.threads, o.record_avalanches);
}

LatticeOptions options_from(const py::tuple& t) {
    return options_of(t[0].cast<std::uint64_t>(), t[1].cast<Index>(), t[2].cast<std::string>(),
                      t[3].cast<Index>(), t[4].cast<bool>());
}

std::vector<double> sizes_in(const py::object& sizes) {
    py::ssize_t length = 0;
    if (py::isinstance<py::array>(sizes)) {
        const auto array = py::reinterpret_borrow<py::array>(sizes);
        if (array.ndim() != 1) {
            throw ShapeError({.parameter = "sizes",
                              .value = std::to_string(array.ndim()),
                              .number = static_cast<double>(array.ndim()),
                              .finding = "has " + std::to_string(array.ndim()) + " dimensions",
                              .rule = "it must have one, the cells around the ring"});
        }
        length = array.size();
    }
    const auto array = strict_array(sizes, {length}, "sizes");
    return {array.data(), array.data() + array.size()};
}

/// Loads and sizes of avalanches, as two arrays.
py::tuple avalanche_arrays(const std::vector<Avalanche>& avalanches) {
    std::vector<double> loads;
    std::vector<std::uint64_t> sizes;
    for (const auto& a : avalanches) {
        loads.push_back(a.stress_ratio);
        sizes.push_back(a.crushes);
    }
    return py::make_tuple(array_of(loads), array_of(sizes));
}

// A ring's future depends on all of this; sizes follow from psi.
py::tuple ring_state(const LatticeRing& ring) {
    std::vector<double> psi;
    for (const auto& cell : ring.cells) psi.push_back(cell.psi);
    return py::make_tuple(array_of(psi), array_of(ring.crushes), ring.stream, ring.remixes, ring.passes,
                          ring.loaded_to, ring.at_rest, ring.stepped_to, avalanche_arrays(ring.avalanches),
                          ring.avalanches_in_order, array_of(ring.log_strength));
}

LatticeRing ring_from(const py::tuple& t) {
    LatticeRing ring;
    for (const double psi : vector_of<double>(t[0])) ring.cells.push_back(LatticeCell::of(psi));
    ring.crushes = vector_of<std::uint32_t>(t[1]);
    ring.stream = t[2].cast<std::uint64_t>();
    ring.remixes = t[3].cast<std::uint32_t>();
    ring.passes = t[4].cast<std::uint64_t>();
    ring.loaded_to = t[5].cast<std::optional<double>>();
    ring.at_rest = t[6].cast<bool>();
    ring.stepped_to = t[7].cast<double>();
    const auto avalanches = t[8].cast<py::tuple>();
    const auto loads = vector_of<double>(avalanches[0]);
    const auto sizes = vector_of<std::uint64_t>(avalanches[1]);
    for (std::size_t a = 0; a < loads.size(); ++a) ring.avalanches.push_back({loads[a], sizes[a]});
    ring.avalanches_in_order = t[9].cast<std::size_t>();
    ring.log_strength = vector_of<double>(t[10]);
    return ring;
}

py::list rings_state(const LatticeState& lattice) {
    py::list rings;
    for (const auto& ring : lattice.rings()) rings.append(ring_state(ring));
    return rings;
}

std::vector<LatticeRing> rings_from(const py::object& rings) {
    std::vector<LatticeRing> result;
    for (const auto& ring : rings.cast<py::list>()) result.push_back(ring_from(ring.cast<py::tuple>()));
    return result;
}

template <class Model>
std::uint64_t load_to(Guarded<Model>& lattice, double stress_ratio) {
    return lattice.with([&](Model& l) { return l.load_to(stress_ratio, Interrupt()); });
}

template <class Model>
py::array_t<double> psi(Guarded<Model>& lattice) {
    const auto [replicas, cells] =
        lattice.with([](const Model& l) { return std::pair(l.replicas(), l.cells()); });
    py::array_t<double> out({replicas, cells});
    double* data = out.mutable_data();
    lattice.with([&, cells = cells](const Model& l) {
        for (Index r = 0; r < l.replicas(); ++r) l.psi(r, {data + r * cells, cells});
    });
    return out;
}

template <class Model>
py::array_t<double> log_strength(Guarded<Model>& lattice) {
    const auto [replicas, cells] =
        lattice.with([](const Model& l) { return std::pair(l.replicas(), l.cells()); });
    py::array_t<double> out({replicas, cells});
    double* data = out.mutable_data();
    std::fill_n(data, replicas * cells, 0.0);
    lattice.with([&, cells = cells](const Model& l) {
        Index r = 0;
        for (const auto& ring : l.rings())
            std::copy(ring.log_strength.begin(), ring.log_strength.end(), data + r++ * cells);
    });
    return out;
}

template <class Model>
py::array_t<std::uint32_t> crushes(Guarded<Model>& lattice) {
    const auto [replicas, cells] =
        lattice.with([](const Model& l) { return std::pair(l.replicas(), l.cells()); });
    py::array_t<std::uint32_t> out({replicas, cells});
    std::uint32_t* data = out.mutable_data();
    lattice.with([&, cells = cells](const Model& l) {
        for (Index r = 0; r < l.replicas(); ++r) {
            const auto row = l.crushes(r);
            std::copy(row.begin(), row.end(), data + r * cells);
        }
    });
    return out;
}

template <class Model>
py::array_t<double> grainsizes(Guarded<Model>& lattice, const LogGrid& grid) {
    const auto rows = lattice.with([&](const Model& l) { return l.grainsizes(grid); });
    py::array_t<double> out({static_cast<Index>(rows.size()), grid.bins()});
    for (std::size_t r = 0; r < rows.size(); ++r)
        std::copy(rows[r].begin(), rows[r].end(), out.mutable_data(static_cast<Index>(r), 0));
    return out;
}

/// A property that is read under the lock.
template <class Model, class F>
auto reading(const F& f) {
    return [f](Guarded<Model>& lattice) { return lattice.with([&f](const Model& l) { return f(l); }); };
}

/// The face that both lattices share; comminute/lattice/rings.py documents it.
template <class Model>
void add_lattice_methods(py::class_<Guarded<Model>>& lattice) {
    using Self = Guarded<Model>;
    lattice.def("load_to", &load_to<Model>, py::arg("stress_ratio"))
        .def("remix", [](Self& l) { l.with([](Model& m) { m.remix(); }); })
        .def("grainsizes", &grainsizes<Model>, py::arg("grid"))
        .def(
            "fabric",
            [](Self& l, const LogGrid& grid) {
                return l.with([&](const Model& m) { return m.fabric(grid); });
            },
            py::arg("grid"))
        .def(
            "fitting_grid",
            [](Self& l, double max_stress_ratio) {
                return l.with([&](const Model& m) { return m.fitting_grid(max_stress_ratio); });
            },
            py::arg("max_stress_ratio"))
        .def_property_readonly("points", reading<Model>([](const Model& m) { return m.points(); }))
        .def_property_readonly("psi", &psi<Model>)
        .def_property_readonly("log_strength", &log_strength<Model>)
        .def_property_readonly("crushes", &crushes<Model>)
        .def_property_readonly(
            "mean_crushes",
            [](Self& l) { return copied(l.with([](const Model& m) { return m.mean_crushes(); })); })
        .def_property_readonly("settled_at", reading<Model>([](const Model& m) { return m.settled_at(); }))
        .def_property_readonly("cells", reading<Model>([](const Model& m) { return m.cells(); }))
        .def_property_readonly("replicas", reading<Model>([](const Model& m) { return m.replicas(); }))
        .def_property_readonly("material", reading<Model>([](const Model& m) { return m.material(); }))
        .def_property_readonly("seed", reading<Model>([](const Model& m) { return m.options().seed; }))
        .def_property_readonly("mean",
                               reading<Model>([](const Model& m) { return word_of(m.options().mean); }))
        .def_property_readonly("threads", reading<Model>([](const Model& m) { return m.options().threads; }))
        .def(
            "__eq__",
            [](Self& a, Self& b) {
                const auto state = [](Self& l) { return l.with([](const Model& m) { return m; }); };
                return &a == &b || state(a) == state(b);
            },
            py::is_operator());
}

/// Defaults of the options of either lattice.
py::dict shared_defaults(const LatticeOptions& standard) {
    using namespace py::literals;
    return py::dict("seed"_a = standard.seed, "replicas"_a = standard.replicas,
                    "mean"_a = word_of(standard.mean), "threads"_a = standard.threads);
}

void register_event_driven(py::module_& m) {
    using Self = Guarded<Lattice>;
    const LatticeOptions standard;
    py::dict defaults = shared_defaults(standard);
    defaults["record_avalanches"] = standard.record_avalanches;
    tell_defaults(m, "Lattice", defaults);
    const auto from_grading = [](Index cells, const Material& material, const Grading& grading,
                                 std::uint64_t seed, Index replicas, const std::string& mean, Index threads,
                                 bool record_avalanches) {
        const auto options = options_of(seed, replicas, mean, threads, record_avalanches);
        return std::make_unique<Self>(Lattice(cells, material, grading, options));
    };
    const auto from_sizes = [](const py::object& sizes, const Material& material, std::uint64_t seed,
                               Index replicas, const std::string& mean, Index threads,
                               bool record_avalanches) {
        const auto options = options_of(seed, replicas, mean, threads, record_avalanches);
        return std::make_unique<Self>(Lattice(sizes_in(sizes), material, options));
    };
    const auto avalanches = [](Self& l, Index replica) {
        return avalanche_arrays(l.with([&](const Lattice& model) { return model.avalanches(replica); }));
    };
    py::class_<Self> lattice(m, "Lattice", "The core that `comminute.Lattice` drives.");
    lattice
        .def(py::init(from_grading), py::arg("cells"), py::arg("material"), py::arg("grading"), py::kw_only(),
             py::arg("seed") = standard.seed, py::arg("replicas") = standard.replicas,
             py::arg("mean") = word_of(standard.mean), py::arg("threads") = standard.threads,
             py::arg("record_avalanches") = standard.record_avalanches)
        .def(py::init(from_sizes), py::arg("sizes"), py::arg("material"), py::kw_only(),
             py::arg("seed") = standard.seed, py::arg("replicas") = standard.replicas,
             py::arg("mean") = word_of(standard.mean), py::arg("threads") = standard.threads,
             py::arg("record_avalanches") = standard.record_avalanches)
        .def("avalanches", avalanches, py::arg("replica") = 0)
        .def(py::pickle(
            [](Self& l) {
                const Lattice copy = l.with([](const Lattice& model) { return model; });
                return py::make_tuple(rings_state(copy), copy.material(), options_state(copy.options()));
            },
            [](const py::tuple& t) {
                return std::make_unique<Self>(
                    Lattice(rings_from(t[0]), t[1].cast<Material>(), options_from(t[2].cast<py::tuple>())));
            }));
    add_lattice_methods(lattice);
}

void register_time_stepped(py::module_& m) {
    using Self = Guarded<TimeSteppedLattice>;
    const LatticeOptions standard;
    const TimeStepping steps;
    py::dict defaults = shared_defaults(standard);
    defaults["crush_probability"] = steps.crush_probability;
    defaults["load_factor"] = steps.load_factor;
    tell_defaults(m, "TimeSteppedLattice", defaults);
    const auto from_grading = [](Index cells, const Material& material, const Grading& grading,
                                 double crush_probability, double load_factor, std::uint64_t seed,
                                 Index replicas, const std::string& mean, Index threads) {
        const auto options = options_of(seed, replicas, mean, threads, false);
        const TimeStepping stepping{crush_probability, load_factor};
        return std::make_unique<Self>(TimeSteppedLattice(cells, material, grading, stepping, options));
    };
    const auto from_sizes = [](const py::object& sizes, const Material& material, double crush_probability,
                               double load_factor, std::uint64_t seed, Index replicas,
                               const std::string& mean, Index threads) {
        const auto options = options_of(seed, replicas, mean, threads, false);
        const TimeStepping stepping{crush_probability, load_factor};
        return std::make_unique<Self>(TimeSteppedLattice(sizes_in(sizes), material, stepping, options));
    };
    py::class_<Self> lattice(m, "TimeSteppedLattice", "The core that `comminute.TimeSteppedLattice` drives.");
    lattice
        .def(py::init(from_grading), py::arg("cells"), py::arg("material"), py::arg("grading"), py::kw_only(),
             py::arg("crush_probability") = steps.crush_probability,
             py::arg("load_factor") = steps.load_factor, py::arg("seed") = standard.seed,
             py::arg("replicas") = standard.replicas, py::arg("mean") = word_of(standard.mean),
             py::arg("threads") = standard.threads)
        .def(py::init(from_sizes), py::arg("sizes"), py::arg("material"), py::kw_only(),
             py::arg("crush_probability") = steps.crush_probability,
             py::arg("load_factor") = steps.load_factor, py::arg("seed") = standard.seed,
             py::arg("replicas") = standard.replicas, py::arg("mean") = word_of(standard.mean),
             py::arg("threads") = standard.threads)
        .def(
            "crush_pass",
            [](Self& l, double stress_ratio) {
                return l.with([&](TimeSteppedLattice& model) { return model.pass(stress_ratio); });
            },
            py::arg("stress_ratio"))
        .def_property_readonly("crush_probability", reading<TimeSteppedLattice>([](const auto& l) {
                                   return l.stepping().crush_probability;
                               }))
        .def_property_readonly("load_factor", reading<TimeSteppedLattice>(
                                                  [](const auto& l) { return l.stepping().load_factor; }))
        .def(py::pickle(
            [](Self& l) {
                const TimeSteppedLattice copy = l.with([](const TimeSteppedLattice& model) { return model; });
                return py::make_tuple(rings_state(copy), copy.material(), options_state(copy.options()),
                                      copy.stepping().crush_probability, copy.stepping().load_factor);
            },
            [](const py::tuple& t) {
                const TimeStepping stepping{t[3].cast<double>(), t[4].cast<double>()};
                return std::make_unique<Self>(TimeSteppedLattice(
                    rings_from(t[0]), t[1].cast<Material>(), stepping, options_from(t[2].cast<py::tuple>())));
            }));
    add_lattice_methods(lattice);
}

}  // namespace

void register_lattice(py::module_& m) {
    register_column_lattice(m);
    register_event_driven(m);
    register_time_stepped(m);
}
