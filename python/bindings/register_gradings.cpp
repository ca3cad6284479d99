// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"
#include "curve_points.hpp"
#include "rooms.hpp"
#include "words.hpp"

using namespace comminute;

void register_gradings(py::module_& m) {
    register_grading(m);
    register_ideal_gradings(m);
    m.def(
        "mixed_fabric",
        [](const Grading& grading, const LogGrid& grid, const std::string& mean, const std::string& points) {
            const Mean how = choice_of<Mean>(mean);
            const PointHandling handling = choice_of<PointHandling>(points);
            const py::gil_scoped_release release;
            return mixed_fabric(grading, grid, how, handling);
        },
        py::arg("grading"), py::arg("grid"), py::kw_only(), py::arg("mean") = "arithmetic",
        py::arg("points") = "exact",
        R"doc(Completely mixed grains of a grading: neighbours independent of the grain (Eq. 64).

The fines bin stands for its centre.

Parameters
----------
grading : Grading
grid : LogGrid
mean : {"arithmetic", "geometric"}
    How two neighbours make a neighbourhood grainsize: Eq. 48 or 65.
points : {"exact", "binned"}
    Treatment of the sizes of a monodisperse or gap-graded start: they stay exact, as atoms, until
    they crush; or they go to the bins that hold them, for engines that know bins only.

Returns
-------
Fabric

Raises
------
ParameterError
    If a grain is larger than the grid's last edge.

Examples
--------
>>> import comminute as cm
>>> fabric = cm.mixed_fabric(cm.gap_graded(1.0, 0.1), cm.LogGrid(-6.0, 0.0, 61))
>>> fabric.cdf()[-1].round(12)
np.float64(1.0)
)doc");
    using namespace py::literals;
    const GridOptions standard;
    tell_defaults(m, "fitting_grid",
                  py::dict("spacing"_a = standard.spacing, "bins"_a = standard.bins,
                           "psi_min"_a = standard.psi_min, "psi_max"_a = standard.psi_max));
    m.def(
        "fitting_grid",
        [](const Grading& grading, const Material& material, double max_stress_ratio,
           std::optional<double> spacing, std::optional<Index> bins, std::optional<double> psi_min,
           std::optional<double> psi_max) {
            return fitting_grid(grading, material, max_stress_ratio,
                                GridOptions{spacing, bins, psi_min, psi_max});
        },
        py::arg("grading"), py::arg("material"), py::arg("max_stress_ratio"), py::kw_only(),
        py::arg("spacing") = standard.spacing, py::arg("bins") = standard.bins,
        py::arg("psi_min") = standard.psi_min, py::arg("psi_max") = standard.psi_max,
        R"doc(A grid that fits a grading and the loads to come.

Its top edge is at the largest grain (point masses sit on bin centres), its fines bin below the
finest grains and below the crush zone of the largest load, with room for their fragments. Bins or
ends may be given; the rest is then chosen to suit them.

Parameters
----------
grading : Grading
material : Material
max_stress_ratio : float
    Largest load to come, >= 0; finite, unless bins and both ends are given.
spacing : float, optional
    Wanted bin width in psi; left out, 0.02, or `needed_spacing` where that is narrower. The grid's is no larger, unless
    that would take more than 4000 bins or `bins` is given.
bins : int, optional
    Number of bins, >= 8.
psi_min, psi_max : float, optional
    Log sizes at the centres of the fines bin and of the last bin.

Returns
-------
LogGrid

Raises
------
ParameterError
    For a load, spacing, number of bins or end outside its range.

Examples
--------
>>> import comminute as cm
>>> grid = cm.fitting_grid(cm.monodisperse(1.0), cm.Material(), 1e4)
>>> grid.psi_max, grid.psi_min < -9.2
(0.0, True)
>>> cm.fitting_grid(cm.gap_graded(1.0, 0.1), cm.Material(), 1e4, bins=256).bins
256
)doc");
    m.def(
        "needed_spacing",
        [](const Material& material, const std::optional<Grading>& grading) {
            return grading ? needed_spacing(*grading, material) : needed_spacing(material);
        },
        py::arg("material"), py::arg("grading") = py::none(),
        R"doc(Bin width that a fragment law and a grading need, so that curves are good to some 2e-3.

A twelfth of the range in ln s that holds the middle 68 % of the mass, a tenth of a sieve interval that holds a fifth of it, a
twenty-second part of the range of ln X that holds the middle 68 % of the fragments; exact sizes need none. Errors grow as the width's
square.

Parameters
----------
material : Material
    Its fragment law is resolved.
grading : Grading, optional
    Start; left out, the law alone counts.

Returns
-------
float
    Width in psi; 0 where all fragments are of one relative size, which no bins resolve.

Examples
--------
>>> import comminute as cm
>>> round(cm.needed_spacing(cm.Material(), cm.uniform_size(0.95, 1.0)), 4)
0.0029
>>> cm.needed_spacing(cm.Material()) > 0.05
True
)doc");
    m.def(
        "_curve_on_grid",
        [](const LogGrid& grid, const py::object& cdf, const std::vector<PointMass>& points, double largest) {
            const auto finer = strict_array(cdf, {grid.bins()}, "cdf");
            const CurvePoints curve =
                curve_on_grid(grid, VectorView<const double>(finer.data(), finer.size()), points, largest);
            return py::make_tuple(copied(curve.size), copied(curve.finer_than), curve.tail_slope);
        },
        "Points of a cdf on a grid, for `SizeCurve.on_grid`: sizes, fractions finer, slope of the tail.");
    m.def(
        "_first_at_least", [](const Points& curve, double share) { return points_of(curve).quantile(share); },
        "inf{d : F(d) >= share} of a curve's points, for `SizeCurve.percentile`.");
    m.def(
        "_finer_than",
        [](const Points& curve, const py::array_t<double>& at) {
            const CurvePoints points = points_of(curve);
            return py::vectorize([&points](double size) { return points.finer(size); })(at);
        },
        "F of a curve's points at sizes, for `SizeCurve.finer_than`.");
    m.def(
        "_mean_log", [](const Points& curve) { return points_of(curve).mean_log(); },
        "Mean of ln(size) of a curve's points, for `mean_log`.");
    m.def(
        "_breakage_potential",
        [](const Points& curve, double silt) { return points_of(curve).breakage_potential(silt); },
        "Hardin's potential of a curve's points, for `breakage_potential`.");
    m.def(
        "_with_sieves",
        [](const Points& curve, const LogGrid& grid, const Contiguous& mass, const Contiguous& start,
           const Points& measured) {
            const CurvePoints bent = with_sieves(points_of(curve), grid, {mass.data(), mass.size()},
                                                 {start.data(), start.size()}, points_of(measured));
            return py::make_tuple(copied(bent.size), copied(bent.finer_than), bent.tail_slope);
        },
        "Curve that bends at the sieves of a measured start, for `Result.curve`.");
    m.def(
        "percentile",
        [](const LogGrid& grid, const py::object& cdf, double percent, bool extrapolate,
           const std::vector<PointMass>& points, double largest) {
            const auto finer = strict_array(cdf, {grid.bins()}, "cdf");
            return percentile(grid, VectorView<const double>(finer.data(), finer.size()), percent,
                              extrapolate, points, largest);
        },
        py::arg("grid"), py::arg("cdf"), py::arg("percent"), py::kw_only(), py::arg("extrapolate") = false,
        py::arg("points") = std::vector<PointMass>(), py::arg("largest") = 0.0,
        R"doc(Size D_x such that `percent` of the mass is finer.

inf{d : F(d) >= percent / 100}, linear in ln d inside a bin; on a plateau this is its lower end. D100 is the
largest size where that lies in the coarsest bin that holds mass, else the upper edge of this bin.

Parameters
----------
grid : LogGrid
cdf : ndarray (N,)
    Fraction finer than the upper edge of each bin.
percent : float
    In [0, 100].
extrapolate : bool
    Continue a curve that ends in the fines bin as a power law through its two finest points.
points : sequence of PointMass
    Exact sizes that are part of `cdf`, fine to coarse: it jumps there, inside their bin.
largest : float
    Size that no grain exceeds (`Fabric.largest`); 0 where it is not known.

Returns
-------
float

Raises
------
ParameterError
    If D_x lies in the fines bin, where no size is known, or above the largest size; for a cdf that falls, or is not
    finite.

Examples
--------
>>> import comminute as cm
>>> grid = cm.LogGrid(-6.0, 0.0, 61)
>>> cdf = cm.mixed_fabric(cm.power_law(2.0, 0.01, 1.0), grid).cdf()
>>> bool(0.4 < cm.percentile(grid, cdf, 50) < 0.6)
True
)doc");
}
