// SPDX-License-Identifier: BSD-3-Clause
#include "arrays.hpp"

#include <algorithm>

namespace {

std::string shape_text(const py::ssize_t* shape, std::size_t dimensions) {
    py::tuple sizes(dimensions);
    for (std::size_t d = 0; d < dimensions; ++d) sizes[d] = py::int_(shape[d]);
    return py::repr(sizes);
}

}  // namespace

py::array_t<double> strict_array(const py::object& object, const std::vector<py::ssize_t>& shape,
                                 const char* name, const char* needed_by) {
    const std::string label(name);
    if (!py::isinstance<py::array>(object)) {
        throw py::type_error(label + " is a " + std::string(py::str(py::type::of(object).attr("__name__"))) +
                             "; it must be a NumPy float64 array (np.asarray makes one)");
    }
    const auto array = py::reinterpret_borrow<py::array>(object);
    if (!py::isinstance<py::array_t<double>>(object)) {
        throw py::type_error(label + " has dtype " + std::string(py::str(array.dtype())) +
                             "; it must be float64. Convert it with np.ascontiguousarray(" + label +
                             ", dtype=np.float64)");
    }
    const auto dimensions = static_cast<std::size_t>(array.ndim());
    if (dimensions != shape.size() || !std::equal(shape.begin(), shape.end(), array.shape())) {
        const std::string found = shape_text(array.shape(), dimensions);
        throw comminute::ShapeError(
            {.parameter = label,
             .value = found,
             .finding = "has shape " + found,
             .rule = std::string(needed_by) + " needs " + shape_text(shape.data(), shape.size())});
    }
    const int wanted = int{py::array::c_style} | int{py::detail::npy_api::NPY_ARRAY_ALIGNED_};
    if ((array.flags() & wanted) != wanted) {
        throw comminute::ShapeError({.parameter = label,
                                     .finding = "is not a C-ordered (row after row) array",
                                     .remedy = comminute::Remedy::order_rows});
    }
    return py::reinterpret_borrow<py::array_t<double>>(object);
}

py::array_t<double> strict_out(const py::object& object, const std::vector<py::ssize_t>& shape,
                               const char* name) {
    if (object.is_none()) return py::array_t<double>(shape);
    py::array_t<double> array = strict_array(object, shape, name);
    if (!array.writeable()) {
        throw comminute::ParameterError(
            {.parameter = name, .value = "read-only", .rule = "it must be writeable"});
    }
    return array;
}

py::array_t<double> read_only_view(const double* data, const std::vector<py::ssize_t>& shape,
                                   const py::object& owner) {
    py::array_t<double> view(shape, data, owner);
    view.attr("flags").attr("writeable") = false;
    return view;
}
