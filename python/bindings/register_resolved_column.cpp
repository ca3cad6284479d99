// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "guarded.hpp"
#include "interrupt.hpp"
#include "resolved_records.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

using Column = Guarded<ResolvedColumn>;

ResolvedColumnOptions options_of(const std::string& mean, const std::string& partners,
                                 double neighbour_length, double largest_mixing, double largest_segregation,
                                 double tolerance, double competition, double rest, Index threads) {
    return {choice_of<Mean>(mean),
            choice_of<Partners>(partners),
            neighbour_length,
            largest_mixing,
            largest_segregation,
            tolerance,
            competition,
            rest,
            threads};
}

py::tuple words_of(const ResolvedColumnOptions& o) {
    return py::make_tuple(word_of(o.mean), word_of(o.partners), o.neighbour_length, o.largest_mixing,
                          o.largest_segregation, o.tolerance, o.competition, o.rest, o.threads);
}

std::unique_ptr<Column> from_rows(const ResolvedGrid& grid, const Material& material,
                                  const py::array_t<double, py::array::c_style>& rows, double height,
                                  const ResolvedColumnOptions& options) {
    const MatrixView<const double> pmf = matrix_in(rows);
    const py::gil_scoped_release release;
    return std::make_unique<Column>(ResolvedColumn(grid, material, pmf, height, options));
}

py::tuple advanced(Column& self, double time, const ColumnDrive& drive, const ColumnEnds& ends) {
    const ResolvedColumnReport report =
        self.with([&](ResolvedColumn& column) { return column.advance(time, drive, ends, Interrupt()); });
    return py::make_tuple(report.exchanges, report.largest_probability, copied(report.inflow));
}

template <class Read>
auto of_row(const Read& read) {
    return [read](Column& self, Index row) {
        return self.with([&](ResolvedColumn& column) { return read(column, row); });
    };
}

py::tuple state_of(Column& self) {
    const auto [record, grid, material, height, options] = self.with([](ResolvedColumn& c) {
        return std::tuple(c.record(), c.grid(), c.material(), c.height(), c.options());
    });
    py::list rows;
    for (const ResolvedRowRecord& row : record.rows) {
        const py::tuple law = row.has_met ? stored(row.open) : stored(row.closed);
        rows.append(
            py::make_tuple(copied(row.start), row.has_met, law, copied(row.counts), row.load, row.largest));
    }
    return py::make_tuple(grid, material, height, words_of(options), rows, record.sweeps, record.fed);
}

std::unique_ptr<Column> from_state(const py::tuple& t) {
    ResolvedColumnRecord record;
    for (const auto& object : t[4].cast<py::list>()) {
        const auto row = object.cast<py::tuple>();
        ResolvedRowRecord found;
        found.start = vector_of<double>(row[0]);
        found.has_met = row[1].cast<bool>();
        if (found.has_met) {
            found.open = triple_record_of(row[2]);
        } else {
            found.closed = resolved_record_of(row[2]);
        }
        found.counts = vector_of<double>(row[3]);
        found.load = row[4].cast<double>();
        found.largest = row[5].cast<double>();
        record.rows.push_back(std::move(found));
    }
    record.sweeps = t[5].cast<std::uint64_t>();
    record.fed = t[6].cast<double>();
    const auto o = t[3].cast<py::tuple>();
    const ResolvedColumnOptions options =
        options_of(o[0].cast<std::string>(), o[1].cast<std::string>(), o[2].cast<double>(),
                   o[3].cast<double>(), o[4].cast<double>(), o[5].cast<double>(), o[6].cast<double>(),
                   o[7].cast<double>(), o[8].cast<Index>());
    return std::make_unique<Column>(ResolvedColumn(t[0].cast<ResolvedGrid>(), t[1].cast<Material>(), record,
                                                   t[2].cast<double>(), options));
}

}  // namespace

void register_resolved_column(py::module_& m) {
    const ResolvedColumnOptions defaults;
    py::dict told;
    told["mean"] = word_of(defaults.mean);
    told["partners"] = word_of(defaults.partners);
    told["largest_mixing"] = defaults.largest_mixing;
    told["largest_segregation"] = defaults.largest_segregation;
    told["tolerance"] = defaults.tolerance;
    told["competition"] = defaults.competition;
    told["rest"] = defaults.rest;
    told["threads"] = defaults.threads;
    tell_defaults(m, "Column", told);
    py::class_<ResolvedColumnOptions>(m, "_ResolvedColumnOptions", "Options of a column of laws.")
        .def(py::init(&options_of), py::arg("mean"), py::arg("partners"), py::arg("neighbour_length"),
             py::arg("largest_mixing"), py::arg("largest_segregation"), py::arg("tolerance"),
             py::arg("competition"), py::arg("rest"), py::arg("threads"));
    py::class_<Column>(m, "_ResolvedColumn", "Rows of a column of laws of three cells, for `Column`.")
        .def(py::init(&from_rows), py::arg("grid"), py::arg("material"), py::arg("rows"), py::arg("height"),
             py::arg("options"))
        .def(
            "load_to",
            [](Column& self, const std::vector<double>& loads) {
                self.with([&](ResolvedColumn& column) { return column.load_to(loads, Interrupt()); });
            },
            py::arg("stress_ratio"))
        .def(
            "stand_under",
            [](Column& self, const std::vector<double>& loads) {
                self.with([&](ResolvedColumn& column) { return column.stand_under(loads, Interrupt()); });
            },
            py::arg("stress_ratio"))
        .def(
            "advance",
            [](Column& self, double time, const std::vector<double>& shear_rate, double mixing,
               double shear_mixing, double segregation, double crush_rate, const std::string& bottom,
               const std::string& top, const std::vector<double>& feed, double feed_rate) {
                return advanced(self, time, {shear_rate, mixing, shear_mixing, segregation, crush_rate},
                                {choice_of<ColumnEnd>(bottom), choice_of<ColumnEnd>(top), feed, feed_rate});
            },
            py::arg("time"), py::arg("shear_rate"), py::arg("mixing"), py::arg("shear_mixing"),
            py::arg("segregation"), py::arg("crush_rate"), py::arg("bottom"), py::arg("top"), py::arg("feed"),
            py::arg("feed_rate"))
        .def("pmf",
             [](Column& self, Index row) {
                 return copied(self.with([&](ResolvedColumn& column) { return column.pmf(row); }));
             })
        .def("triples",
             [](Column& self, Index row) {
                 const auto [mass, nodes] = self.with([&](ResolvedColumn& column) {
                     return std::pair(column.triples(row), column.grid().nodes());
                 });
                 return py::array_t<double>({nodes, nodes, nodes}, mass.data());
             })
        .def("joint",
             [](Column& self, Index row, const LogGrid& bins) {
                 const std::vector<double> joint =
                     self.with([&](ResolvedColumn& column) { return column.joint(row, bins); });
                 return py::array_t<double>({bins.bins(), bins.bins()}, joint.data());
             })
        .def("crushes", of_row([](ResolvedColumn& column, Index row) { return column.crushes(row); }))
        .def("mean_size", of_row([](ResolvedColumn& column, Index row) { return column.mean_size(row); }))
        .def("pending", of_row([](ResolvedColumn& column, Index row) { return column.pending(row); }))
        .def("__eq__",
             [](Column& self, const py::object& other) -> py::object {
                 if (!py::isinstance<Column>(other))
                     return py::reinterpret_borrow<py::object>(Py_NotImplemented);
                 Column& that = other.cast<Column&>();
                 const auto of = [](Column& column) {
                     return column.with([](ResolvedColumn& c) {
                         ResolvedColumnOptions o = c.options();
                         o.threads = 1;
                         return std::tuple(c.record(), c.grid(), c.material(), c.height(), o);
                     });
                 };
                 const auto [record, grid, material, height, o] = of(self);
                 const auto [r, g, m, h, p] = of(that);
                 return py::bool_(record == r && grid == g && material == m && height == h &&
                                  words_of(o).equal(words_of(p)));
             })
        .def(py::pickle(&state_of, &from_state));
    m.def(
        "_fitting_nodes",
        [](const std::vector<Grading>& gradings, double fabric_width, const std::vector<double>& edges) {
            return fitting_nodes(gradings, fabric_width, {}, edges);
        },
        py::arg("gradings"), py::arg("fabric_width"), py::arg("edges"), "Nodes for several gradings.");
}
