// SPDX-License-Identifier: BSD-3-Clause
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "arrays.hpp"
#include "rooms.hpp"
#include "words.hpp"

namespace {

using namespace comminute;

VectorView<const unsigned char> view_of(const py::bytes& bytes) {
    const std::string_view view = bytes;
    return {reinterpret_cast<const unsigned char*>(view.data()), static_cast<Index>(view.size())};
}

py::bytes as_bytes(const std::vector<unsigned char>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Points behind a lock, since the GIL does not guard them while they step.
class Points {
  public:
    explicit Points(MaterialPoints points) : points_(std::move(points)) {}

    /// Calls with the points, which no other thread touches meanwhile.
    template <class Call>
    auto with(const Call& call) {
        const py::gil_scoped_release release;
        const std::lock_guard lock(mutex_);
        return call(points_);
    }

    py::array_t<unsigned char> step(bool commits, const py::object& stress_ratio, const py::object& remix,
                                    const py::object& loading_rate, Index threads) {
        const Index count = points_.count();
        const auto load = strict_array(stress_ratio, {count}, "stress_ratio", "the list of points");
        const auto rate = strict_array(loading_rate, {count}, "loading_rate", "the list of points");
        const auto mixing = remix.cast<py::array_t<unsigned char, py::array::c_style>>();
        const PointLoads loads{{load.data(), count}, {mixing.data(), mixing.size()}, {rate.data(), count}};
        with([&](MaterialPoints& points) {
            return commits ? points.update(loads, threads) : points.trial(loads, threads);
        });
        py::array_t<unsigned char> status(count);
        for (Index i = 0; i < count; ++i) {
            status.mutable_data()[i] = static_cast<unsigned char>(points_.status()[i]);
        }
        return status;
    }

    py::array_t<double> gradings(bool end) {
        const Index bins = points_.grid().bins();
        py::array_t<double> found({points_.count(), bins});
        double* const to = found.mutable_data();
        with([&](const MaterialPoints& points) {
            for (Index i = 0; i < points.count(); ++i) {
                const VectorView<double> row(to + i * bins, bins);
                end ? points.end_grading(i, row) : points.grading(i, row);
            }
        });
        return found;
    }

    py::array_t<double> list(VectorView<const double> (MaterialPoints::*of)() const) {
        return copied(with([&](const MaterialPoints& points) {
            const VectorView<const double> view = (points.*of)();
            return std::vector<double>(view.begin(), view.end());
        }));
    }

  private:
    MaterialPoints points_;
    std::mutex mutex_;
};

std::unique_ptr<Points> make(const Material& material, const Fabric& start, Index count, bool single,
                             bool gradings, const std::string& scheme) {
    MaterialPointsOptions options;
    options.numbers = single ? PointNumbers::float32 : PointNumbers::float64;
    options.contents = gradings ? PointContents::gradings : PointContents::states;
    options.scheme = choice_of<Scheme>(scheme);
    return std::make_unique<Points>(MaterialPoints(material, start, count, options));
}

}  // namespace

void register_material_points(py::module_& m) {
    py::class_<Points>(m, "MaterialPoints", "The core that `comminute.MaterialPoints` steps.")
        .def(py::init(&make), py::arg("material"), py::arg("start"), py::arg("count"), py::arg("single"),
             py::arg("gradings_alone"), py::arg("scheme"))
        .def("step", &Points::step, py::arg("commits"), py::arg("stress_ratio"), py::arg("remix"),
             py::arg("loading_rate"), py::arg("threads"))
        .def("commit", [](Points& p) { p.with([](MaterialPoints& points) { points.commit(); }); })
        .def("discard", [](Points& p) { p.with([](MaterialPoints& points) { points.discard(); }); })
        .def("message",
             [](Points& p, Index i) {
                 return p.with([i](const MaterialPoints& all) { return all.message(i); });
             })
        .def("gradings", &Points::gradings, py::arg("end"))
        .def(
            "grading",
            [](Points& p, Index i) {
                return copied(p.with([i](const MaterialPoints& all) {
                    std::vector<double> row(static_cast<std::size_t>(all.grid().bins()));
                    all.grading(i, row);
                    return row;
                }));
            },
            py::arg("i"))
        .def("largest",
             [](Points& p, Index i) {
                 return p.with([i](const MaterialPoints& all) { return all.largest(i); });
             })
        .def("fabric",
             [](Points& p, Index i) {
                 return p.with([i](const MaterialPoints& all) { return all.fabric(i); });
             })
        .def("shares_start",
             [](Points& p, Index i) {
                 return p.with([i](const MaterialPoints& all) { return all.shares_start(i); });
             })
        .def_property_readonly("settled_at", [](Points& p) { return p.list(&MaterialPoints::settled_at); })
        .def_property_readonly("end_settled_at",
                               [](Points& p) { return p.list(&MaterialPoints::end_settled_at); })
        .def_property_readonly("crushed", [](Points& p) { return p.list(&MaterialPoints::crushed); })
        .def(
            "merge",
            [](Points& p, Index i, Index j, double mass_i, double mass_j, bool never) {
                p.with([&](MaterialPoints& points) {
                    points.merge(i, j, mass_i, mass_j, never ? MergedLoad::never : MergedLoad::smaller);
                });
            },
            py::arg("i"), py::arg("j"), py::arg("mass_i"), py::arg("mass_j"), py::arg("never"))
        .def("pack",
             [](Points& p) { return as_bytes(p.with([](const MaterialPoints& all) { return all.pack(); })); })
        .def_static("unpack",
                    [](const py::bytes& bytes) {
                        return std::make_unique<Points>(MaterialPoints::unpack(view_of(bytes)));
                    })
        .def("pack_point",
             [](Points& p, Index i) {
                 return as_bytes(p.with([i](const MaterialPoints& all) { return all.pack_point(i); }));
             })
        .def("unpack_point",
             [](Points& p, Index i, const py::bytes& bytes) {
                 const auto view = view_of(bytes);
                 p.with([&](MaterialPoints& points) { points.unpack_point(i, view); });
             })
        .def("clone",
             [](Points& p) {
                 return std::make_unique<Points>(p.with([](const MaterialPoints& all) { return all; }));
             })
        .def_property_readonly(
            "count", [](Points& p) { return p.with([](const MaterialPoints& all) { return all.count(); }); })
        .def_property_readonly(
            "grid", [](Points& p) { return p.with([](const MaterialPoints& all) { return all.grid(); }); })
        .def_property_readonly(
            "material",
            [](Points& p) { return p.with([](const MaterialPoints& all) { return all.material(); }); })
        .def_property_readonly(
            "scheme",
            [](Points& p) {
                return word_of(p.with([](const MaterialPoints& all) { return all.options().scheme; }));
            })
        .def_property_readonly("single",
                               [](Points& p) {
                                   return p.with([](const MaterialPoints& all) {
                                       return all.options().numbers == PointNumbers::float32;
                                   });
                               })
        .def_property_readonly("gradings_alone",
                               [](Points& p) {
                                   return p.with([](const MaterialPoints& all) {
                                       return all.options().contents == PointContents::gradings;
                                   });
                               })
        .def_property_readonly("memory", [](Points& p) {
            return p.with([](const MaterialPoints& all) { return all.memory(); });
        });
}
