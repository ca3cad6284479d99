// SPDX-License-Identifier: BSD-3-Clause
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "curve_points.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

std::unique_ptr<MaterialSweep> make(const Fabric& start, const std::optional<Points>& measured,
                                    std::vector<double> percents, std::vector<double> sizes, double silt,
                                    const std::string& scheme, double loading_rate) {
    std::optional<CurvePoints> sieves;
    if (measured) sieves = points_of(*measured);
    const GradingReader reader(start, std::move(sieves), {std::move(percents), std::move(sizes), silt});
    return std::make_unique<MaterialSweep>(
        start, reader, QuasiStaticOptions{choice_of<Scheme>(scheme), loading_rate, SolvePath::automatic});
}

/// Numbers of all members, and what is wrong with those that cannot be run, by their index.
py::tuple run(MaterialSweep& sweep, const std::vector<Material>& materials, const py::object& loads) {
    const auto members = static_cast<py::ssize_t>(materials.size());
    const auto ratios = strict_array(loads, {members, py::reinterpret_borrow<py::array>(loads).shape(1)},
                                     "stress_ratios", "the members");
    const Index count = ratios.shape(1);
    const Index columns = sweep.columns();
    py::array_t<double> rows({members, static_cast<py::ssize_t>(count), static_cast<py::ssize_t>(columns)});
    double* const first = rows.mutable_data();
    const double* const load = ratios.data();
    std::map<Index, std::string> faults;
    {
        const py::gil_scoped_release release;
        for (Index b = 0; b < members; ++b) {
            try {
                sweep.run(materials[static_cast<std::size_t>(b)], {load + b * count, count},
                          {first + b * count * columns, count, columns});
            } catch (const std::invalid_argument& error) {  // ParameterError, ShapeError
                faults.emplace(b, error.what());
            }
        }
    }
    return py::make_tuple(rows, faults);
}

}  // namespace

void register_material_sweep(py::module_& m) {
    py::class_<MaterialSweep>(m, "_MaterialSweep",
                              "Numbers of the gradings of one start under loads, for many materials.")
        .def(py::init(&make), py::arg("start"), py::arg("measured"), py::arg("percents"), py::arg("sizes"),
             py::arg("silt"), py::arg("scheme"), py::arg("loading_rate"))
        .def(
            "run", &run, py::arg("materials"), py::arg("stress_ratios"),
            "(B, T, columns) numbers of B materials under (B, T) loads, and the faults of members by index.");
}
