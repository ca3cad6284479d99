// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "guarded.hpp"
#include "interrupt.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

using Column = Guarded<ColumnLattice>;

ColumnOptions options_of(std::uint64_t seed, const std::string& mean, const std::string& partners,
                         const std::string& order, const std::string& rates, double largest_mixing,
                         double largest_segregation, Index threads) {
    return {seed,
            choice_of<Mean>(mean),
            choice_of<Partners>(partners),
            choice_of<CrushOrder>(order),
            choice_of<SwapRates>(rates),
            largest_mixing,
            largest_segregation,
            threads};
}

std::unique_ptr<Column> from_gradings(const std::vector<Grading>& rows, Index cells, const Material& material,
                                      double height, const ColumnOptions& options) {
    const py::gil_scoped_release release;
    return std::make_unique<Column>(ColumnLattice(rows, cells, material, height, options));
}

std::unique_ptr<Column> from_sizes(const py::array_t<double, py::array::c_style>& sizes,
                                   const Material& material, double height, const ColumnOptions& options) {
    const MatrixView<const double> rows = matrix_in(sizes);
    const py::gil_scoped_release release;
    return std::make_unique<Column>(ColumnLattice(rows, material, height, options));
}

py::tuple row_state(const ColumnRow& row) {
    std::vector<double> psi;
    for (const LatticeCell& cell : row.ring.cells) psi.push_back(cell.psi);
    return py::make_tuple(array_of(psi), array_of(row.ring.crushes), row.ring.stream, array_of(row.crushes),
                          array_of(row.touched), row.at_rest, row.activations);
}

ColumnRow row_from(const py::tuple& t) {
    ColumnRow row;
    for (const double psi : vector_of<double>(t[0])) row.ring.cells.push_back(LatticeCell::of(psi));
    row.ring.crushes = vector_of<std::uint32_t>(t[1]);
    row.ring.stream = t[2].cast<std::uint64_t>();
    row.crushes = vector_of<std::uint32_t>(t[3]);
    row.touched = vector_of<std::uint32_t>(t[4]);
    row.at_rest = t[5].cast<bool>();
    row.activations = t[6].cast<std::uint64_t>();
    return row;
}

py::tuple state_of(Column& self) {
    const ColumnLattice column = self.with([](ColumnLattice& c) { return c; });
    py::list rows;
    for (const ColumnRow& row : column.state()) rows.append(row_state(row));
    const ColumnOptions& o = column.options();
    return py::make_tuple(
        rows, array_of(column.loads()), column.sweeps(), column.material(), column.height(),
        py::make_tuple(o.seed, word_of(o.mean), word_of(o.partners), word_of(o.order), word_of(o.rates),
                       o.largest_mixing, o.largest_segregation, o.threads));
}

std::unique_ptr<Column> from_state(const py::tuple& t) {
    std::vector<ColumnRow> rows;
    for (const auto& row : t[0].cast<py::list>()) rows.push_back(row_from(row.cast<py::tuple>()));
    const auto o = t[5].cast<py::tuple>();
    const ColumnOptions options =
        options_of(o[0].cast<std::uint64_t>(), o[1].cast<std::string>(), o[2].cast<std::string>(),
                   o[3].cast<std::string>(), o[4].cast<std::string>(), o[5].cast<double>(),
                   o[6].cast<double>(), o[7].cast<Index>());
    return std::make_unique<Column>(ColumnLattice(std::move(rows), vector_of<double>(t[1]),
                                                  t[2].cast<std::uint64_t>(), t[3].cast<Material>(),
                                                  t[4].cast<double>(), options));
}

}  // namespace

void register_column_lattice(py::module_& m) {
    py::class_<ColumnOptions>(m, "_ColumnOptions", "Options of a column lattice.")
        .def(py::init(&options_of), py::arg("seed"), py::arg("mean"), py::arg("partners"), py::arg("order"),
             py::arg("rates"), py::arg("largest_mixing"), py::arg("largest_segregation"), py::arg("threads"));
    const ColumnOptions defaults;
    py::dict told;
    told["seed"] = defaults.seed;
    told["mean"] = word_of(defaults.mean);
    told["partners"] = word_of(defaults.partners);
    told["order"] = word_of(defaults.order);
    told["rates"] = word_of(defaults.rates);
    told["largest_mixing"] = defaults.largest_mixing;
    told["largest_segregation"] = defaults.largest_segregation;
    told["threads"] = defaults.threads;
    tell_defaults(m, "ColumnLattice", told);
    const ColumnDrive still;
    py::dict driven;
    driven["segregation"] = still.segregation;
    driven["mixing"] = still.mixing;
    driven["crush_rate"] = still.crush_rate;
    tell_defaults(m, "ColumnLattice.run", driven);
    py::class_<Column>(m, "_ColumnLattice", "Rows of a column lattice, for `ColumnLattice`.")
        .def(py::init(&from_gradings), py::arg("rows"), py::arg("cells"), py::arg("material"),
             py::arg("height"), py::arg("options"))
        .def(py::init(&from_sizes), py::arg("sizes"), py::arg("material"), py::arg("height"),
             py::arg("options"))
        .def(
            "load_to",
            [](Column& self, const std::vector<double>& loads) {
                self.with([&](ColumnLattice& column) { return column.load_to(loads, Interrupt()); });
            },
            py::arg("stress_ratio"))
        .def(
            "stand_under",
            [](Column& self, const std::vector<double>& loads) {
                self.with([&](ColumnLattice& column) { column.stand_under(loads); });
            },
            py::arg("stress_ratio"))
        .def(
            "advance",
            [](Column& self, double time, const std::vector<double>& shear_rate, double mixing,
               double shear_mixing, double segregation, double crush_rate) {
                const ColumnDrive drive{shear_rate, mixing, shear_mixing, segregation, crush_rate};
                const ColumnReport report = self.with(
                    [&](ColumnLattice& column) { return column.advance(time, drive, Interrupt()); });
                return py::make_tuple(report.exchanges, report.swaps, report.crushes,
                                      report.largest_probability);
            },
            py::arg("time"), py::arg("shear_rate"), py::arg("mixing"), py::arg("shear_mixing"),
            py::arg("segregation"), py::arg("crush_rate"))
        .def("psi",
             [](Column& self, Index row) {
                 std::vector<double> psi;
                 self.with([&](ColumnLattice& column) {
                     psi.resize(static_cast<std::size_t>(column.cells()));
                     column.psi(row, psi);
                 });
                 return copied(psi);
             })
        .def("crushes",
             [](Column& self, Index row) {
                 std::vector<std::uint32_t> counts;
                 self.with([&](ColumnLattice& column) {
                     const auto found = column.crushes(row);
                     counts.assign(found.begin(), found.end());
                 });
                 return py::array_t<std::uint32_t>(static_cast<py::ssize_t>(counts.size()), counts.data());
             })
        .def(py::pickle(&state_of, &from_state))
        .def("__eq__",
             [](Column& self, const py::object& other) -> py::object {
                 if (!py::isinstance<Column>(other))
                     return py::reinterpret_borrow<py::object>(Py_NotImplemented);
                 Column& that = other.cast<Column&>();
                 if (&self == &that) return py::bool_(true);
                 const ColumnLattice copy = that.with([](ColumnLattice& c) { return c; });
                 return py::bool_(self.with([&](ColumnLattice& c) { return c == copy; }));
             })
        .def("mean_crushes", [](Column& self, Index row) {
            return self.with([&](ColumnLattice& column) { return column.mean_crushes(row); });
        });
}
