// SPDX-License-Identifier: BSD-3-Clause
#include <pybind11/functional.h>

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "rooms.hpp"

namespace {

using namespace comminute;

const FamilyOptions defaults;

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// Values, derivatives by the load and by the variable, and statuses, of loads and values in pairs.
template <class Read>
py::tuple look_up(const Numbers& loads, const Numbers& values, const Read& read) {
    py::array_t<double> value(loads.size());
    py::array_t<double> by_load(loads.size());
    py::array_t<double> by_variable(loads.size());
    py::array_t<unsigned char> status(loads.size());
    for (Index k = 0; k < loads.size(); ++k) {
        const FamilyResponse found = read(loads.data()[k], values.data()[k]);
        value.mutable_data()[k] = found.value;
        by_load.mutable_data()[k] = found.by_load;
        by_variable.mutable_data()[k] = found.by_variable;
        status.mutable_data()[k] = static_cast<unsigned char>(found.status);
    }
    return py::make_tuple(value, by_load, by_variable, status);
}

py::bytes bytes_of(const ResponseFamily& family) {
    const std::vector<unsigned char> bytes = family.to_bytes();
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

ResponseFamily family_of(const py::bytes& bytes) {
    const std::string_view view = bytes;
    const auto* data = reinterpret_cast<const unsigned char*>(view.data());
    return ResponseFamily::from_bytes({data, static_cast<Index>(view.size())});
}

}  // namespace

void register_response_family(py::module_& m) {
    tell_defaults(m, "ResponseFamily", py::dict(py::arg("tolerance") = defaults.tolerance));
    py::class_<ResponseFamily>(m, "ResponseFamily", "The core that `comminute.ResponseFamily` reads.")
        .def(py::init<std::vector<double>, std::vector<ResponseTable>>(), py::arg("values"),
             py::arg("tables"))
        .def_static(
            "refined",
            [](std::vector<double> values, const std::function<ResponseTable(double)>& table_at,
               double tolerance) {
                return ResponseFamily::refined(std::move(values), table_at, {tolerance, defaults.most_nodes});
            },
            py::arg("values"), py::arg("table_at"), py::arg("tolerance"))
        .def_property_readonly("values", [](const ResponseFamily& f) { return copied(f.values()); })
        .def_property_readonly("tables", &ResponseFamily::tables)
        .def_property_readonly("memory", &ResponseFamily::memory)
        .def("crushes",
             [](const ResponseFamily& f, const Numbers& loads, const Numbers& values) {
                 return look_up(loads, values,
                                [&f](double load, double value) { return f.crushes(load, value); });
             })
        .def("finer",
             [](const ResponseFamily& f, Index bin, const Numbers& loads, const Numbers& values) {
                 return look_up(loads, values,
                                [&f, bin](double load, double value) { return f.finer(bin, load, value); });
             })
        .def("scalar",
             [](const ResponseFamily& f, const std::string& name, const Numbers& loads,
                const Numbers& values) {
                 const Index index = f.tables().front().index_of(name);
                 return look_up(loads, values, [&f, index](double load, double value) {
                     return f.scalar(index, load, value);
                 });
             })
        .def("percentile",
             [](const ResponseFamily& f, double percent, const Numbers& loads, const Numbers& values) {
                 return look_up(loads, values, [&f, percent](double load, double value) {
                     return f.percentile(percent, load, value);
                 });
             })
        .def("grading",
             [](const ResponseFamily& f, double load, double value) {
                 py::array_t<double> cdf(f.grid().bins());
                 const ResponseStatus status = f.grading(load, value, {cdf.mutable_data(), cdf.size()});
                 return py::make_tuple(cdf, static_cast<unsigned char>(status), f.points(load, value));
             })
        .def(
            "__eq__", [](const ResponseFamily& a, const ResponseFamily& b) { return a == b; },
            py::is_operator())
        .def("to_bytes", &bytes_of)
        .def_static("from_bytes", &family_of)
        .def(py::pickle(&bytes_of, &family_of));
}
