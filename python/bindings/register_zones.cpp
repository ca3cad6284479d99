// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/native_enum.h>

#include "arrays.hpp"

namespace {

using comminute::CrushZones;
using comminute::Index;
using comminute::LogGrid;
using comminute::Material;
using comminute::Zone;

py::array_t<Index> per_shell(const CrushZones& zones, Index (CrushZones::*distance)(Index) const) {
    py::array_t<Index> out(zones.grid().bins());
    for (Index m = 0; m < out.size(); ++m) out.mutable_at(m) = (zones.*distance)(m);
    return out;
}

void register_crush_zones(py::module_& m) {
    py::native_enum<Zone>(m, "Zone", "enum.IntEnum",
                          "Which of the two grains of a cell (psi, psibar) a load crushes (Eqs. 52-55).")
        .value("REST", Zone::rest, "00: neither")
        .value("NEIGHBOUR", Zone::neighbour, "01: psibar alone")
        .value("GRAIN", Zone::grain, "10: psi alone")
        .value("BOTH", Zone::both, "11: either would")
        .finalize();

    py::class_<CrushZones>(m, "CrushZones",
                           R"doc(The four crush zones on a grid, as a band around the diagonal.

Shell m holds the cells whose larger index is m. In it the cells at distance |i - j| <= band[m] are
active, those at <= overlap[m] lie in zone 11; the larger grain is always the first to crush.

Parameters
----------
grid : LogGrid
material : Material
stress_ratio : float
    Load, >= 0.

Raises
------
ParameterError
    For a stress ratio that is negative or NaN.

Examples
--------
>>> import comminute as cm
>>> zones = cm.CrushZones(cm.LogGrid(-6.0, 1.0, 351), cm.Material(), 100.0)
>>> int(zones.band[300])   # at psi = 0 neighbours within 7 bins of 0.02 crush
7
)doc")
        .def(py::init<const LogGrid&, const Material&, double>(), py::arg("grid"), py::arg("material"),
             py::arg("stress_ratio"))
        .def_property_readonly("stress_ratio", &CrushZones::stress_ratio, "Load.")
        .def_property_readonly(
            "band", [](const CrushZones& z) { return per_shell(z, &CrushZones::band); },
            "(N,) largest |i - j| that is active in each shell, -1 where none is.")
        .def_property_readonly(
            "overlap", [](const CrushZones& z) { return per_shell(z, &CrushZones::overlap); },
            "(N,) largest |i - j| at which both grains crush, -1 where none does.")
        .def_property_readonly(
            "distrusted_below", &CrushZones::distrusted_below,
            R"doc(Log size below which results are not exact because the zone reaches the fines bin.

-inf where it does not.)doc")
        .def(
            "half_width",
            [](const CrushZones& z, const py::array_t<double>& psi) {
                return py::vectorize([&z](double x) { return z.half_width(x); })(psi);
            },
            py::arg("psi"),
            R"doc(Half-width sqrt(g* + k psi) of the zone where the larger grain has log size psi.

0 at the tip, -1 where nothing crushes, inf where the fabric is off. Scalar or array.)doc")
        .def("__repr__",
             [](const CrushZones& z) {
                 return repr_of("CrushZones", "grid", z.grid(), "material", z.material(), "stress_ratio",
                                z.stress_ratio());
             })
        .def(
            "__eq__",
            [](const CrushZones& a, const CrushZones& b) {
                return a.grid() == b.grid() && a.material() == b.material() &&
                       a.stress_ratio() == b.stress_ratio();
            },
            py::is_operator())
        .def(py::pickle(
            [](const CrushZones& z) { return py::make_tuple(z.grid(), z.material(), z.stress_ratio()); },
            [](const py::tuple& t) {
                return CrushZones(t[0].cast<LogGrid>(), t[1].cast<Material>(), t[2].cast<double>());
            }));

    m.def(
        "crush_zones",
        [](const LogGrid& grid, const Material& material, double stress_ratio) {
            py::array_t<std::uint8_t> out({grid.bins(), grid.bins()});
            CrushZones(grid, material, stress_ratio).fill({out.mutable_data(), grid.bins(), grid.bins()});
            return out;
        },
        py::arg("grid"), py::arg("material"), py::arg("stress_ratio"),
        R"doc(Grains of each cell that crush, tested at bin centres (Eqs. 52-55).

Zones are closed: a grain exactly at its critical load crushes. The cell (0, 0) never does.

Parameters
----------
grid : LogGrid
material : Material
stress_ratio : float
    Load, >= 0.

Returns
-------
ndarray (N, N) of uint8
    Values of `Zone`, [psi, psibar]: 0 = 00, 1 = 01, 2 = 10, 3 = 11.

Raises
------
ParameterError
    For a stress ratio that is negative or NaN.

Examples
--------
>>> import comminute as cm
>>> zones = cm.crush_zones(cm.LogGrid(-6.0, 1.0, 351), cm.Material(), 1.0)
>>> cm.Zone(zones[300, 300])
<Zone.BOTH: 3>
)doc");

    m.def(
        "active_share",
        [](const LogGrid& grid, const Material& material, double stress_ratio) {
            py::array_t<double> out({grid.bins(), grid.bins()});
            const auto view = matrix_out(out);
            const py::gil_scoped_release release;
            comminute::active_share(grid, material, stress_ratio, view);
            return out;
        },
        py::arg("grid"), py::arg("material"), py::arg("stress_ratio"),
        R"doc(Share of each cell's area inside the slow crush zone, where the larger grain crushes.

The sub-cell counterpart of `crush_zones`: mass is uniform over its cell, and the zone may cut it.
Exact, also where the width of the zone varies across a cell.

Parameters
----------
grid : LogGrid
material : Material
stress_ratio : float
    Load, >= 0.

Returns
-------
ndarray (N, N)
    Values in [0, 1], symmetric.

Raises
------
ParameterError
    For a stress ratio that is negative or NaN.

Examples
--------
>>> import comminute as cm
>>> share = cm.active_share(cm.LogGrid(-6.0, 1.0, 351), cm.Material(), 100.0)
>>> share[300, 300], share[300, 200]
(np.float64(1.0), np.float64(0.0))
)doc");
}

}  // namespace

void register_zones(py::module_& m) {
    m.def("critical_stress_ratio",
          py::vectorize([](const Material* material, double size, double neighbour_size) {
              return comminute::critical_stress_ratio(*material, size, neighbour_size);
          }),
          py::arg("material"), py::arg("size"), py::arg("neighbour_size"),
          R"doc(Stress ratio at which a grain crushes beside neighbours of a mean size (Eq. 2).

Parameters
----------
material : Material
size, neighbour_size : float or array
    > 0, in the unit of the material's reference size.

Returns
-------
float or ndarray

Raises
------
ParameterError
    For a size that is not positive.

Examples
--------
>>> import comminute as cm
>>> cm.critical_stress_ratio(cm.Material(), 1.0, 1.0)
1.0
>>> round(cm.critical_stress_ratio(cm.Material(), 1.0, 0.9), 3)   # cushioned by smaller neighbours
9.209
)doc");
    m.def("stress_function", py::vectorize([](const Material* material, double psi, double psibar) {
              return comminute::stress_function(*material, psi, psibar);
          }),
          py::arg("material"), py::arg("psi"), py::arg("psibar"),
          R"doc(Log-space stress function g = (psi - psibar)**2 - k psi (Eq. 15), scalar or array.

Raises
------
ParameterError
    Where the fabric is off (fabric_width inf): g has no value then.
)doc");
    m.def("logspace_load", py::vectorize([](const Material* material, double stress_ratio) {
              return comminute::logspace_load(*material, stress_ratio);
          }),
          py::arg("material"), py::arg("stress_ratio"),
          R"doc(Log-space load g* = 2 n**2 ln(sigma* / s_max**(3/w)) (Eq. 15); a grain crushes where g <= g*.

Raises
------
ParameterError
    For a stress ratio that is negative or NaN, or where the fabric is off.

Examples
--------
>>> import comminute as cm
>>> material = cm.Material()
>>> g = cm.logspace_load(material, 8.0)
>>> round(cm.stress_ratio_at(material, g), 12)
8.0
)doc");
    m.def("stress_ratio_at", py::vectorize([](const Material* material, double load) {
              return comminute::stress_ratio_at(*material, load);
          }),
          py::arg("material"), py::arg("logspace_load"),
          "Stress ratio of a log-space load g*: the inverse of logspace_load.");
    register_crush_zones(m);
}
