// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <string_view>
#include <vector>

#include "arrays.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

const ResponseOptions defaults;

using Loads = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Values, derivatives and statuses of many loads at once.
template <class Read>
py::tuple look_up(const Loads& loads, const Read& read) {
    py::array_t<double> value(loads.size());
    py::array_t<double> derivative(loads.size());
    py::array_t<unsigned char> status(loads.size());
    const double* from = loads.data();
    double* values = value.mutable_data();
    double* derivatives = derivative.mutable_data();
    unsigned char* statuses = status.mutable_data();
    {
        const py::gil_scoped_release release;
        for (Index k = 0; k < loads.size(); ++k) {
            const Response found = read(from[k]);
            values[k] = found.value;
            derivatives[k] = found.derivative;
            statuses[k] = static_cast<unsigned char>(found.status);
        }
    }
    return py::make_tuple(value, derivative, status);
}

py::bytes bytes_of(const ResponseTable& table) {
    const std::vector<unsigned char> bytes = table.to_bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

ResponseTable table_of(const py::bytes& bytes) {
    const std::string_view view = bytes;
    const auto* data = reinterpret_cast<const unsigned char*>(view.data());
    return ResponseTable::from_bytes(VectorView<const unsigned char>(data, static_cast<Index>(view.size())));
}

}  // namespace

void register_points(py::module_& m) {
    register_material_points(m);
    tell_defaults(m, "ResponseTable", py::dict(py::arg("tolerance") = defaults.tolerance));
    py::class_<ResponseTable>(m, "ResponseTable", "The core that `comminute.ResponseTable` reads.")
        .def(py::init([](const Material& material, const Fabric& start, double max_stress_ratio,
                         double tolerance, double loading_rate, const std::string& scheme) {
                 QuasiStaticOptions options;
                 options.loading_rate = loading_rate;
                 options.scheme = choice_of<Scheme>(scheme);
                 const py::gil_scoped_release release;
                 return ResponseTable(QuasiStatic(start.grid(), material, options), start, max_stress_ratio,
                                      {tolerance, defaults.most_loads});
             }),
             py::arg("material"), py::arg("start"), py::arg("max_stress_ratio"), py::arg("tolerance"),
             py::arg("loading_rate"), py::arg("scheme"))
        .def("with_scalar", &ResponseTable::with_scalar, py::arg("name"), py::arg("at_loads"))
        .def_property_readonly("grid", [](const ResponseTable& t) { return t.grid(); })
        .def_property_readonly("tolerance", [](const ResponseTable& t) { return t.options().tolerance; })
        .def_property_readonly("stress_ratios",
                               [](const ResponseTable& t) { return copied(t.stress_ratios()); })
        .def_property_readonly("scalars", &ResponseTable::scalars)
        .def_property_readonly("largest", &ResponseTable::largest)
        .def_property_readonly("memory", &ResponseTable::memory)
        .def("crushes",
             [](const ResponseTable& t, const Loads& loads) {
                 return look_up(loads, [&t](double load) { return t.crushes(load); });
             })
        .def("finer",
             [](const ResponseTable& t, Index bin, const Loads& loads) {
                 return look_up(loads, [&t, bin](double load) { return t.finer(bin, load); });
             })
        .def("scalar",
             [](const ResponseTable& t, const std::string& name, const Loads& loads) {
                 const Index index = t.index_of(name);
                 return look_up(loads, [&t, index](double load) { return t.scalar(index, load); });
             })
        .def("percentile",
             [](const ResponseTable& t, double percent, const Loads& loads) {
                 return look_up(loads, [&t, percent](double load) { return t.percentile(percent, load); });
             })
        .def("grading",
             [](const ResponseTable& t, double load) {
                 py::array_t<double> cdf(t.grid().bins());
                 const ResponseStatus status = t.grading(load, {cdf.mutable_data(), cdf.size()});
                 return py::make_tuple(cdf, static_cast<unsigned char>(status), t.points(load));
             })
        .def(
            "__eq__", [](const ResponseTable& a, const ResponseTable& b) { return a == b; },
            py::is_operator())
        .def("to_bytes", &bytes_of)
        .def_static("from_bytes", &table_of)
        .def(py::pickle(&bytes_of, &table_of));
    register_response_family(m);
}
