// SPDX-License-Identifier: BSD-3-Clause
#include <exception>
#include <optional>
#include <string>
#include <vector>

#include "bindings.hpp"

namespace {

using namespace comminute;

/// What Python code needs at hand when the core throws: the classes, and the words that the package has for remedies.
struct Errors {
    py::object parameter_error;
    py::object shape_error;
    py::object unavailable_error;
    py::dict words;  // kind of remedy -> sentence, filled by comminute.util.errors
};

Errors& errors(const Errors* made = nullptr) {
    PYBIND11_CONSTINIT static py::gil_safe_call_once_and_store<Errors> storage;
    if (made != nullptr) storage.call_once_and_store_result([made] { return *made; });
    return storage.get_stored();
}

std::string words_for_python(Remedy remedy) {
    const std::string name = name_of(remedy);
    const py::dict& words = errors().words;
    return words.contains(name) ? words[py::str(name)].cast<std::string>() : words_of(remedy);
}

/// The Python exception of a fault: its message in Python's words, its parts as attributes.
py::object error_of(const py::object& type, const Fault& fault) {
    py::object error = type(message(fault, words_for_python(fault.remedy)));
    error.attr("parameter") = fault.parameter;
    error.attr("value") = fault.value;
    error.attr("number") = fault.number;
    error.attr("subject") = fault.subject;
    error.attr("finding") = fault.finding;
    error.attr("also") = fault.also;
    error.attr("rule") = fault.rule;
    error.attr("place") = py::tuple(py::cast(fault.place));
    error.attr("remedy") = name_of(fault.remedy);
    return error;
}

void set_python_error(const py::object& type, const Fault& fault) {
    PyErr_SetObject(type.ptr(), error_of(type, fault).ptr());
}

void translate(std::exception_ptr thrown) {
    try {
        if (thrown) std::rethrow_exception(thrown);
    } catch (const ParameterError& error) {
        set_python_error(errors().parameter_error, error.fault());
    } catch (const ShapeError& error) {
        set_python_error(errors().shape_error, error.fault());
    } catch (const UnavailableError& error) {
        set_python_error(errors().unavailable_error, error.fault());
    }
}

/// A class of exceptions whose instances have the parts of a fault, empty until they are set.
py::object error_class(py::module_& m, const char* name, PyObject* base, const char* doc) {
    const std::string full = m.attr("__name__").cast<std::string>() + "." + name;
    const py::dict parts(py::arg("parameter") = "", py::arg("value") = "", py::arg("number") = py::none(),
                         py::arg("subject") = "", py::arg("finding") = "", py::arg("also") = py::none(),
                         py::arg("rule") = "", py::arg("place") = py::tuple(), py::arg("remedy") = "");
    auto made =
        py::reinterpret_steal<py::object>(PyErr_NewExceptionWithDoc(full.c_str(), doc, base, parts.ptr()));
    if (!made) throw py::error_already_set();
    m.attr(name) = made;
    return made;
}

std::string worded(std::string parameter, std::string value, std::string subject, std::string finding,
                   std::optional<Place> also, std::string rule, std::vector<Place> place,
                   const std::string& remedy) {
    return message({.parameter = std::move(parameter),
                    .value = std::move(value),
                    .subject = std::move(subject),
                    .finding = std::move(finding),
                    .also = std::move(also),
                    .rule = std::move(rule),
                    .place = std::move(place)},
                   remedy);
}

}  // namespace

py::object parameter_error(const Fault& fault) {
    return error_of(errors().parameter_error, fault);
}

void register_errors(py::module_& m) {
    py::class_<Place>(m, "Place",
                      R"doc(One step of the way to an error: a list, a table or a file, and where in it.

Attributes
----------
name : str
    Name of a list or array ("states"), a table, or a file; may be empty for a table.
index : list of int
    Indices of the entry, counted from 0; empty: the whole of it.
row : int
    Row of a table, counted from 1; 0: it is no table.
column : str
    Column of a table; empty: the whole row.

Examples
--------
>>> from comminute._core import Place
>>> str(Place("states", [3, 1, 2])), str(Place("sand.csv", row=5))
('states[3, 1, 2]', 'sand.csv row 5')
)doc")
        .def(py::init([](std::string name, std::vector<Index> index, Index row, std::string column) {
                 return Place{std::move(name), std::move(index), row, std::move(column)};
             }),
             py::arg("name") = "", py::arg("index") = std::vector<Index>{}, py::arg("row") = 0,
             py::arg("column") = "")
        .def_readonly("name", &Place::name)
        .def_readonly("index", &Place::index)
        .def_readonly("row", &Place::row)
        .def_readonly("column", &Place::column)
        .def("__str__", [](const Place& p) { return text(p); })
        .def("__repr__",
             [](const Place& p) {
                 return repr_of("Place", "name", p.name, "index", p.index, "row", p.row, "column", p.column);
             })
        .def(
            "__eq__", [](const Place& a, const Place& b) { return a == b; }, py::is_operator())
        .def("__hash__", [](const Place& p) { return py::hash(py::str(text(p))); })
        .def(py::pickle([](const Place& p) { return py::make_tuple(p.name, p.index, p.row, p.column); },
                        [](const py::tuple& t) {
                            return Place{t[0].cast<std::string>(), t[1].cast<std::vector<Index>>(),
                                         t[2].cast<Index>(), t[3].cast<std::string>()};
                        }));
    const Errors made{
        error_class(m, "ParameterError", PyExc_ValueError, R"doc(A parameter outside its range.

The message says where, what was found, the rule, and what to do; its parts are attributes.

Attributes
----------
parameter : str
    Name of the parameter or array at fault; like every part, empty where there is none.
value : str
    Its value as text.
number : float or None
    Its value, where that is a number.
subject, finding : str
    Subject and predicate of the sentence, where they are not "<parameter>" and "is <value>".
also : Place or None
    A second place, with which the predicate ends.
rule : str
    The rule that is broken.
place : tuple of Place
    The way to the parameter, outermost first; a last step of the parameter's own name is the entry at fault.
remedy : str
    Kind of help, such as "extend_top".

Examples
--------
>>> import comminute as cm
>>> try:
...     cm.LogGrid(-6.0, 1.0, 4)
... except cm.ParameterError as error:
...     print(error.parameter, error.number, error.rule, sep=" | ")
bins | 4.0 | it must be at least 8
)doc"),
        error_class(
            m, "ShapeError", PyExc_ValueError,
            "An array whose shape, order or overlap does not fit; parts as those of `ParameterError`."),
        error_class(m, "UnavailableError", PyExc_RuntimeError,
                    "A part that this build leaves out; parts as those of `ParameterError`."),
        py::dict()};
    m.attr("_remedy_words") = errors(&made).words;
    py::list kinds;
    for (const Remedy remedy : remedies()) kinds.append(name_of(remedy));
    m.attr("_remedies") = py::tuple(kinds);
    m.def("_worded", &worded, py::arg("parameter"), py::arg("value"), py::arg("subject"), py::arg("finding"),
          py::arg("also"), py::arg("rule"), py::arg("place"), py::arg("remedy"),
          "Message of an error from its parts, and a layer's words for the remedy.");
    py::register_exception_translator(&translate);
}
