// SPDX-License-Identifier: BSD-3-Clause
#include "stress_input.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "arrays.hpp"

namespace {

using namespace comminute;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

constexpr double rounding =
    1e-8;  // asymmetry of a tensor, to its largest entry, that is no mistake of the caller's

Numbers numbers_of(const py::object& object, const std::string& name) {
    auto numbers = Numbers::ensure(object);
    if (!numbers) {
        PyErr_Clear();
        throw py::type_error(name + " is a " + std::string(py::str(py::type::of(object).attr("__name__"))) +
                             "; it must be a number or an array of numbers");
    }
    return numbers;
}

std::string shape_text(const py::array& array) {
    return py::repr(array.attr("shape"));
}

/// Place of an entry of an array, by its position in memory.
Place place_of(const char* name, const py::array& array, py::ssize_t flat) {
    std::vector<Index> index(static_cast<std::size_t>(array.ndim()));
    for (py::ssize_t d = array.ndim(); d-- > 0;) {
        index[static_cast<std::size_t>(d)] = flat % array.shape(d);
        flat /= array.shape(d);
    }
    return {name, index};
}

void require_each(const Numbers& numbers, const char* name, const char* rule, bool (*good)(double)) {
    for (py::ssize_t k = 0; k < numbers.size(); ++k) {
        const double value = numbers.data()[k];
        if (good(value)) continue;
        throw ParameterError({.parameter = name,
                              .value = text(value),
                              .number = value,
                              .rule = rule,
                              .place = {place_of(name, numbers, k)}});
    }
}

bool finite(double value) {
    return std::isfinite(value);
}

/// Six numbers a tensor, from nine.
std::vector<double> packed(const Numbers& tensors, const char* name) {
    constexpr std::array<std::pair<int, int>, 6> order = {{{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}}};
    const py::ssize_t count = tensors.size() / 9;
    std::vector<double> rows;
    rows.reserve(static_cast<std::size_t>(6 * count));
    for (py::ssize_t t = 0; t < count; ++t) {
        const double* s = tensors.data() + 9 * t;
        double largest = 0.0;
        for (int k = 0; k < 9; ++k) largest = std::max(largest, std::abs(s[k]));
        for (const auto& [i, j] : order) {
            const double above = s[3 * i + j];
            const double below = s[3 * j + i];
            if (std::abs(above - below) > rounding * largest) {
                throw ParameterError({.parameter = name,
                                      .value = text(above),
                                      .number = above,
                                      .rule = "it must equal " +
                                              text(place_of(name, tensors, 9 * t + 3 * j + i)) +
                                              ", which is " + text(below) + ": stress tensors are symmetric",
                                      .place = {place_of(name, tensors, 9 * t + 3 * i + j)}});
            }
            rows.push_back(0.5 * above + 0.5 * below);
        }
    }
    return rows;
}

py::object of_tensors(const GivenStress& given, const WaysToScalar& ways) {
    const Numbers tensors = numbers_of(given.tensor, given.name);
    if (!holds_tensors(tensors)) {
        throw ShapeError({.parameter = given.name,
                          .value = shape_text(tensors),
                          .finding = "has shape " + shape_text(tensors),
                          .rule = "it must be (..., 3, 3), or (..., 6) in the order xx yy zz yz xz xy"});
    }
    require_each(tensors, given.name, "every entry must be finite", &finite);
    const bool square = tensors.shape(tensors.ndim() - 1) == 3;
    std::vector<py::ssize_t> shape(tensors.shape(), tensors.shape() + tensors.ndim() - (square ? 2 : 1));
    const std::vector<double> rows =
        square ? packed(tensors, given.name)
               : std::vector<double>(tensors.data(), tensors.data() + tensors.size());
    py::array_t<double> out(shape);
    ways.tensors(
        {rows.data(), out.size(), 6}, {out.mutable_data(), out.size()},
        given.compression_positive ? StressSign::compression_positive : StressSign::compression_negative);
    if (shape.empty()) return py::float_(out.data()[0]);
    return out;
}

py::object of_pairs(const std::function<double(double, double)>& way, const Numbers& first,
                    const Numbers& second, const char* name, const char* other) {
    try {
        py::module_::import("numpy").attr("broadcast_shapes")(first.attr("shape"), second.attr("shape"));
    } catch (py::error_already_set& error) {
        if (!error.matches(PyExc_ValueError)) throw;
        throw ShapeError({.parameter = other,
                          .value = shape_text(second),
                          .finding = "has shape " + shape_text(second),
                          .rule = std::string(name) + " has " + shape_text(first) +
                                  "; give both in one shape, or one of them as a number"});
    }
    return py::vectorize([&](double a, double b) { return way(a, b); })(first, second);
}

void require_given(const py::object& value, const char* name, const char* rule) {
    if (value.is_none()) throw ParameterError({.parameter = name, .value = "missing", .rule = rule});
}

}  // namespace

bool holds_tensors(const py::array& array) {
    const py::ssize_t d = array.ndim();
    return (d >= 2 && array.shape(d - 1) == 3 && array.shape(d - 2) == 3) ||
           (d >= 1 && array.shape(d - 1) == 6);
}

py::object scalar_of(const GivenStress& given, const WaysToScalar& ways) {
    const bool pairs = !given.p.is_none() || !given.q.is_none();
    const bool verticals = !given.vertical.is_none() || !given.k0.is_none();
    if ((given.tensor.is_none() ? 0 : 1) + (pairs ? 1 : 0) + (verticals ? 1 : 0) != 1) {
        throw ParameterError({.parameter = given.name,
                              .subject = "give one stress:",
                              .finding = given.name + std::string(", p with q, or vertical with k0")});
    }
    if (!given.tensor.is_none()) return of_tensors(given, ways);
    if (!given.compression_positive) {
        throw ParameterError({.parameter = "compression_positive",
                              .value = "False",
                              .rule = "it is for tensors; p and vertical are positive in compression"});
    }
    if (pairs) {
        require_given(given.p, "p", "q is given with it");
        require_given(given.q, "q", "p is given with it; q is 0 under an isotropic stress");
        const Numbers p = numbers_of(given.p, "p");
        const Numbers q = numbers_of(given.q, "q");
        require_each(p, "p", "it must be finite", &finite);
        require_each(q, "q", "it must be finite", &finite);
        return of_pairs(ways.pq, p, q, "p", "q");
    }
    require_given(given.vertical, "vertical", "k0 is given with it");
    require_given(given.k0, "k0", "a vertical stress needs it, the ratio of the horizontal stress to it");
    const Numbers vertical = numbers_of(given.vertical, "vertical");
    const Numbers k0 = numbers_of(given.k0, "k0");
    require_each(vertical, "vertical", "it must be finite", &finite);
    require_each(k0, "k0", "it must be at least 0 and finite",
                 [](double value) { return value >= 0.0 && std::isfinite(value); });
    return of_pairs(ways.vertical, vertical, k0, "vertical", "k0");
}
