// SPDX-License-Identifier: BSD-3-Clause
#include <mutex>

#include "arrays.hpp"
#include "interrupt.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

/// An engine with its workspace behind a lock, since the GIL does not guard it while a step runs.
template <class Engine>
class Guarded {
  public:
    explicit Guarded(Engine engine) : engine_(std::move(engine)) {}

    const Engine& get() const { return engine_; }

    StepReport report() {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return report_;
    }

    py::array_t<double> step(const py::object& p, double stress_ratio, const py::object& out) {
        const auto before = strict_array(p, shape(), "p");
        auto after = strict_out(out, shape(), "out");
        const auto from = matrix_in(before);
        const auto to = matrix_out(after);
        {
            const py::gil_scoped_release release;
            const std::lock_guard lock(mutex_);
            report_ = engine_.step(from, stress_ratio, to);
        }
        return after;
    }

    py::array_t<double> settle(const py::object& p, double stress_ratio, std::optional<Index> steps,
                               const py::object& out) {
        const auto before = strict_array(p, shape(), "p");
        auto after = strict_out(out, shape(), "out");
        if (steps)
            require(*steps >= 1, "steps", static_cast<double>(*steps), "at least 1 (None: until at rest)");
        require_stress_ratio(stress_ratio);
        const auto from = matrix_in(before);
        const auto to = matrix_out(after);
        {
            const py::gil_scoped_release release;
            const std::lock_guard lock(mutex_);
            if (from.data() != to.data()) {
                std::copy(from.data(), from.data() + from.rows() * from.cols(), to.data());
            }
            report_ = comminute::settle(engine_, to, stress_ratio, steps.value_or(0), Interrupt());
        }
        return after;
    }

  private:
    std::vector<py::ssize_t> shape() const { return {engine_.grid().bins(), engine_.grid().bins()}; }

    Engine engine_;
    std::mutex mutex_;
    StepReport report_;
};

template <class Engine>
void add_engine_methods(py::class_<Guarded<Engine>>& engine) {
    using Self = Guarded<Engine>;
    engine
        .def("step", &Self::step, py::arg("p"), py::arg("stress_ratio"), py::arg("out") = py::none(),
             R"doc(One time step under a load: every active cell crushes once.

Parameters
----------
p : ndarray (N, N)
    State [psi, psibar], float64 in C order, entries at least 0.
stress_ratio : float
    Load, >= 0.
out : ndarray (N, N), optional
    Array for the new state; may be `p` itself.

Returns
-------
ndarray (N, N)
    The new state: `out`, or a new array.

Raises
------
TypeError
    For anything but a float64 array.
ShapeError
    For another shape or order, or an `out` that overlaps `p` in part.
ParameterError
    For a bad load or an entry that is not finite.
)doc")
        .def("settle", &Self::settle, py::arg("p"), py::arg("stress_ratio"), py::kw_only(),
             py::arg("steps") = py::none(), py::arg("out") = py::none(),
             R"doc(Repeats the step under one load until the state is at rest.

At rest means that the mass inside the crush zone is below 1e-18 of the whole. Ctrl-C stops between
two steps.

Parameters
----------
p, stress_ratio, out
    As for `step`.
steps : int, optional
    Take this many steps instead, >= 1.

Returns
-------
ndarray (N, N)
    The new state: `out`, or a new array. `report` has the sums over the steps.

Raises
------
TypeError, ShapeError, ParameterError
    As `step`.
)doc")
        .def_property_readonly("report", &Self::report, "StepReport of the last call of `step` or `settle`.")
        .def_property_readonly(
            "grid", [](const Self& e) { return e.get().grid(); }, "The LogGrid.")
        .def_property_readonly(
            "material", [](const Self& e) { return e.get().material(); }, "The Material.")
        .def_property_readonly(
            "kind", [](const Self& e) { return word_of(e.get().kernel().options().kind); },
            "Kernel: \"slow\", \"exact\", \"fast\" or \"blend\".")
        .def_property_readonly(
            "loading_rate", [](const Self& e) { return e.get().kernel().options().loading_rate; },
            "Share of the fast kernel.")
        .def_property_readonly(
            "scheme", [](const Self& e) { return word_of(e.get().options().scheme); },
            "Fragments on the grid: \"conservative\" or \"paper\".")
        .def(
            "__eq__",
            [](const Self& a, const Self& b) {
                const Engine& x = a.get();
                const Engine& y = b.get();
                return x.grid() == y.grid() && x.material() == y.material() && x.options() == y.options();
            },
            py::is_operator());
}

using SlowEngine = Guarded<SlowUpdate>;
using FullEngine = Guarded<FullConvolution>;

}  // namespace

void register_slow_update(py::module_& m) {
    const SlowUpdateOptions defaults;
    const auto make = [](const LogGrid& grid, const Material& material, const std::string& scheme) {
        return std::make_unique<SlowEngine>(SlowUpdate(grid, material, {choice_of<Scheme>(scheme)}));
    };
    py::class_<SlowEngine> engine(m, "SlowUpdate",
                                  R"doc(One slow step that touches only what crushes (Section 8.2).

Equal to `FullConvolution` with kind "slow", but it looks only at the band of the zone and spreads
only the cells in it that hold mass, each along its row or column, or takes running sums where these
cost less (`report.terms`). Needs no FFTW. Never makes a negative entry.

Parameters
----------
grid : LogGrid
material : Material
scheme : {"conservative", "paper"}
    Fragments on the grid, as in `fragment_pmf`: "conservative" are finite volumes, under "paper" every
    crush moves at least one bin. Under either a cell moves whole, by the test of its centre.

Raises
------
ParameterError
    For a word it does not know.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-12.0, 0.0, 121)
>>> start = cm.mixed_fabric(cm.monodisperse(1.0), grid, points="binned")
>>> engine = cm.SlowUpdate(grid, cm.Material())
>>> after = engine.settle(start.probability, 8.0)
>>> float(after.sum().round(12)), bool(engine.report.steps > 1)
(1.0, True)
)doc");
    engine
        .def(py::init(make), py::arg("grid"), py::arg("material"),
             py::arg("scheme") = word_of(defaults.scheme))
        .def("__repr__",
             [](const SlowEngine& e) {
                 return repr_of("SlowUpdate", "grid", e.get().grid(), "material", e.get().material(),
                                "scheme", word_of(e.get().options().scheme));
             })
        .def(py::pickle(
            [](const SlowEngine& e) {
                return py::make_tuple(e.get().grid(), e.get().material(), word_of(e.get().options().scheme));
            },
            [make](const py::tuple& t) {
                return make(t[0].cast<LogGrid>(), t[1].cast<Material>(), t[2].cast<std::string>());
            }));
    add_engine_methods(engine);
}

void register_full_convolution(py::module_& m) {
    const FullConvolutionOptions defaults;
    const auto make = [](const LogGrid& grid, const Material& material, const std::string& kind,
                         double loading_rate, const std::string& scheme, const std::string& path,
                         const std::string& effort) {
        const KernelOptions kernel{choice_of<KernelKind>(kind), loading_rate, choice_of<Scheme>(scheme)};
        return std::make_unique<FullEngine>(FullConvolution(
            grid, material, {kernel, choice_of<StepPath>(path), choice_of<PlanEffort>(effort)}));
    };
    py::class_<FullEngine> engine(m, "FullConvolution",
                                  R"doc(One time step with any kernel (Eqs. 59-61, 63, 67, 68).

A linear, separable convolution, nothing lost at the bottom: by running sums where the fragments'
law is a short sum of exponentials (`report.terms` says of how many), else by FFTW, which takes
several times as long. FFT noise is removed line by line: nothing above a line's coarsest source,
no negative entry, and the fines bin takes what was crushed less what landed (a deficit there is
taken from the line's largest entry).

Parameters
----------
grid : LogGrid
material : Material
kind : {"slow", "exact", "fast", "blend"}
    Eq. 63, 59, 68, or 67: (1 - loading_rate) slow + loading_rate fast.
loading_rate : float
    Share of the fast kernel in a "blend", in [0, 1].
scheme : {"conservative", "paper"}
    Fragments on the grid, as in `fragment_pmf`: "conservative" are finite volumes, under "paper" every
    crush moves at least one bin. Under either a cell moves whole, by the test of its centre.
path : {"automatic", "transforms", "sums", "direct"}
    "transforms" takes FFTW in any case, "sums" refuses laws that have none, and "direct" pushes fragments bin by
    bin, which a build without FFTW does for laws without sums; `path_taken` says which it is.
effort : {"estimate", "measure"}
    How long FFTW may look for fast plans: milliseconds, or seconds for a somewhat faster step.

Raises
------
UnavailableError
    If it takes FFTW and this build has none.
ParameterError
    For a word or a loading rate outside its range, or sums that the law does not have.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-12.0, 0.0, 121)
>>> start = cm.mixed_fabric(cm.monodisperse(1.0), grid, points="binned")
>>> engine = cm.FullConvolution(grid, cm.Material(), "exact")
>>> after = engine.step(start.probability, 8.0)
>>> float(after.sum().round(12)), engine.report.crushed
(1.0, 1.0)
)doc");
    engine
        .def(py::init(make), py::arg("grid"), py::arg("material"), py::arg("kind") = word_of(defaults.kind),
             py::kw_only(), py::arg("loading_rate") = defaults.loading_rate,
             py::arg("scheme") = word_of(defaults.scheme), py::arg("path") = word_of(defaults.path),
             py::arg("effort") = word_of(defaults.effort))
        .def_property_readonly(
            "path", [](const FullEngine& e) { return word_of(e.get().options().path); },
            "Means of spreading mass, as asked for.")
        .def_property_readonly(
            "path_taken", [](const FullEngine& e) { return word_of(e.get().path()); },
            "Means of spreading mass that steps take: \"transforms\", \"sums\" or \"direct\".")
        .def("__repr__",
             [](const FullEngine& e) {
                 const FullConvolutionOptions& o = e.get().options();
                 return repr_of("FullConvolution", "grid", e.get().grid(), "material", e.get().material(),
                                "kind", word_of(o.kind), "loading_rate", o.loading_rate, "scheme",
                                word_of(o.scheme), "path", word_of(o.path));
             })
        .def(py::pickle(
            [](const FullEngine& e) {
                const FullConvolutionOptions& o = e.get().options();
                return py::make_tuple(e.get().grid(), e.get().material(), word_of(o.kind), o.loading_rate,
                                      word_of(o.scheme), word_of(o.path), word_of(o.effort));
            },
            [make](const py::tuple& t) {
                return make(t[0].cast<LogGrid>(), t[1].cast<Material>(), t[2].cast<std::string>(),
                            t[3].cast<double>(), t[4].cast<std::string>(), t[5].cast<std::string>(),
                            t[6].cast<std::string>());
            }));
    add_engine_methods(engine);
}
