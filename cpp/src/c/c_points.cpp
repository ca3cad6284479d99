// SPDX-License-Identifier: BSD-3-Clause
// Material points for C.
#include <algorithm>
#include <memory>
#include <string>

#include "c/c_bytes.hpp"
#include "c/c_call.hpp"
#include "c/c_grid.hpp"

using namespace comminute;
using namespace comminute::detail;

namespace {

MaterialPointsOptions options_of(const comminute_points_options& o) {
    require(o.numbers == COMMINUTE_FLOAT64 || o.numbers == COMMINUTE_FLOAT32, "numbers", o.numbers,
            "COMMINUTE_FLOAT64 or COMMINUTE_FLOAT32");
    require(o.keeps == COMMINUTE_STATES || o.keeps == COMMINUTE_GRADINGS, "keeps", o.keeps,
            "COMMINUTE_STATES or COMMINUTE_GRADINGS");
    MaterialPointsOptions options;
    options.numbers = o.numbers == COMMINUTE_FLOAT32 ? PointNumbers::float32 : PointNumbers::float64;
    options.contents = o.keeps == COMMINUTE_GRADINGS ? PointContents::gradings : PointContents::states;
    return options;
}

PointLoads loads_of(const comminute_loads& loads) {
    const auto count = static_cast<Index>(loads.count);
    return {{&known(loads.stress_ratio, "stress_ratio"), count},
            {loads.remix, loads.remix == nullptr ? 0 : count},
            {loads.loading_rate, loads.loading_rate == nullptr ? 0 : count}};
}

template <class Step>
int step(comminute_points* points, const comminute_loads* loads, MessageBuffer message, const Step& take) {
    return guarded(message, [&] {
        MaterialPoints& all = known(points, "points").points;
        if (take(all, loads_of(struct_of(loads, "loads")))) return static_cast<int>(COMMINUTE_OK);
        for (Index i = 0; i < all.count(); ++i) {
            if (all.status()[i] != PointStatus::done)
                return message.say(COMMINUTE_SOME_POINTS, all.message(i).c_str());
        }
        return static_cast<int>(COMMINUTE_SOME_POINTS);
    });
}

int give(VectorView<const double> from, double* to, int64_t count, const char* name) {
    require_length(count, from.size(), name);
    std::copy(from.begin(), from.end(), &known(to, name));
    return COMMINUTE_OK;
}

template <class Make>
int make_points(comminute_points** points, MessageBuffer message, const Make& make) {
    return guarded(message, [&] {
        known(points, "points");
        auto made = std::make_unique<comminute_points>(comminute_points{make()});
        *points = made.release();
        return COMMINUTE_OK;
    });
}

}  // namespace

void comminute_points_defaults(comminute_points_options* options) {
    if (options != nullptr) *options = {sizeof *options, COMMINUTE_FLOAT64, COMMINUTE_STATES};
}

int comminute_points_create(const comminute_material* material, const comminute_grading* start,
                            const comminute_grid* grid, int64_t count,
                            const comminute_points_options* options, comminute_points** points, char* message,
                            size_t message_size) {
    return make_points(points, {message, message_size}, [&] {
        const Fabric mixed = mixed_fabric(known(start, "start").grading, grid_of(grid));
        return MaterialPoints(known(material, "material").material, mixed, static_cast<Index>(count),
                              options_of(struct_of(options, "options")));
    });
}

int comminute_points_clone(const comminute_points* points, comminute_points** clone, char* message,
                           size_t message_size) {
    return make_points(clone, {message, message_size}, [&] { return known(points, "points").points; });
}

int comminute_points_unpack(const unsigned char* bytes, size_t count, comminute_points** points,
                            char* message, size_t message_size) {
    return make_points(points, {message, message_size}, [&] {
        return MaterialPoints::unpack({&known(bytes, "bytes"), static_cast<Index>(count)});
    });
}

int comminute_points_pack(const comminute_points* points, unsigned char* bytes, size_t count, size_t* needed,
                          char* message, size_t message_size) {
    return guarded({message, message_size},
                   [&] { return give_bytes(known(points, "points").points.pack(), bytes, count, needed); });
}

void comminute_points_destroy(comminute_points* points) {
    delete points;
}

int64_t comminute_points_count(const comminute_points* points) {
    return points == nullptr ? 0 : points->points.count();
}
int64_t comminute_points_bins(const comminute_points* points) {
    return points == nullptr ? 0 : points->points.grid().bins();
}

int comminute_points_trial(comminute_points* points, const comminute_loads* loads, int64_t threads,
                           char* message, size_t message_size) {
    return step(points, loads, {message, message_size},
                [threads](MaterialPoints& all, const PointLoads& given) {
                    return all.trial(given, static_cast<Index>(threads));
                });
}

int comminute_points_update(comminute_points* points, const comminute_loads* loads, int64_t threads,
                            char* message, size_t message_size) {
    return step(points, loads, {message, message_size},
                [threads](MaterialPoints& all, const PointLoads& given) {
                    return all.update(given, static_cast<Index>(threads));
                });
}

int comminute_points_commit(comminute_points* points, char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        known(points, "points").points.commit();
        return COMMINUTE_OK;
    });
}

int comminute_points_discard(comminute_points* points, char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        known(points, "points").points.discard();
        return COMMINUTE_OK;
    });
}

int comminute_points_status(const comminute_points* points, unsigned char* status, int64_t count,
                            char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        const VectorView<const PointStatus> found = known(points, "points").points.status();
        require_length(count, found.size(), "status");
        std::transform(found.begin(), found.end(), &known(status, "status"),
                       [](PointStatus one) { return static_cast<unsigned char>(one); });
        return COMMINUTE_OK;
    });
}

int comminute_points_message(const comminute_points* points, int64_t point, char* words, size_t words_size,
                             char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        const std::string found = known(points, "points").points.message(static_cast<Index>(point));
        known(words, "words");
        require(words_size >= 1, "words_size", static_cast<double>(words_size), "at least 1");
        return MessageBuffer{words, words_size}.say(COMMINUTE_OK, found.c_str());
    });
}

int comminute_points_settled_at(const comminute_points* points, int end, double* settled_at, int64_t count,
                                char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        const MaterialPoints& all = known(points, "points").points;
        return give(end != 0 ? all.end_settled_at() : all.settled_at(), settled_at, count, "settled_at");
    });
}

int comminute_points_crushed(const comminute_points* points, double* crushed, int64_t count, char* message,
                             size_t message_size) {
    return guarded({message, message_size},
                   [&] { return give(known(points, "points").points.crushed(), crushed, count, "crushed"); });
}

int comminute_points_grading(const comminute_points* points, int64_t point, int end, double* masses,
                             int64_t count, char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        const MaterialPoints& all = known(points, "points").points;
        require_length(count, all.grid().bins(), "masses");
        const VectorView<double> to(&known(masses, "masses"), static_cast<Index>(count));
        const auto i = static_cast<Index>(point);
        end != 0 ? all.end_grading(i, to) : all.grading(i, to);
        return COMMINUTE_OK;
    });
}

int comminute_points_merge(comminute_points* points, int64_t first, int64_t second, double mass_first,
                           double mass_second, int settled, char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        require(settled == COMMINUTE_SMALLER || settled == COMMINUTE_NEVER, "settled", settled,
                "COMMINUTE_SMALLER or COMMINUTE_NEVER");
        known(points, "points")
            .points.merge(static_cast<Index>(first), static_cast<Index>(second), mass_first, mass_second,
                          settled == COMMINUTE_NEVER ? MergedLoad::never : MergedLoad::smaller);
        return COMMINUTE_OK;
    });
}
