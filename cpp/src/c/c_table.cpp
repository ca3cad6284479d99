// SPDX-License-Identifier: BSD-3-Clause
// Response tables for C.
#include <memory>
#include <vector>

#include "c/c_bytes.hpp"
#include "c/c_call.hpp"
#include "c/c_grid.hpp"

using namespace comminute;
using namespace comminute::detail;

namespace {

[[noreturn]] void refuse_load(const ResponseTable& table, const Response& found, Index k, double load) {
    const bool fines = found.status == ResponseStatus::in_fines;
    throw ParameterError(
        {.parameter = "stress_ratio",
         .value = text(load),
         .number = load,
         .finding = fines ? "is " + text(load) + ", where the size lies in the lowest bin" : "",
         .rule = fines ? "no size is known there"
                       : "the table goes from 0 to " + rounded(table.stress_ratios().back()),
         .place = {Place{.name = "stress_ratio", .index = {k}}}});
}

// Looks all loads up, and says of the first that the table does not know.
template <class Read>
int look_up(const comminute_table* table, const double* stress_ratio, int64_t count, double* value,
            double* derivative, MessageBuffer message, const Read& read) {
    return guarded(message, [&] {
        const ResponseTable& looked = known(table, "table").table;
        require(count >= 0, "count", static_cast<double>(count), "at least 0");
        if (count == 0) return static_cast<int>(COMMINUTE_OK);
        known(stress_ratio, "stress_ratio");
        known(value, "value");
        Index bad = -1;
        Response first{};
        for (Index k = 0; k < static_cast<Index>(count); ++k) {
            const Response found = read(looked, stress_ratio[k]);
            value[k] = found.value;
            if (derivative != nullptr) derivative[k] = found.derivative;
            if (found.status == ResponseStatus::inside || bad >= 0) continue;
            bad = k;
            first = found;
        }
        if (bad >= 0) refuse_load(looked, first, bad, stress_ratio[bad]);
        return static_cast<int>(COMMINUTE_OK);
    });
}

}  // namespace

void comminute_table_defaults(comminute_table_options* options) {
    if (options == nullptr) return;
    *options = {sizeof *options, 1e4, ResponseOptions{}.tolerance, QuasiStaticOptions{}.loading_rate};
}

int comminute_table_create(const comminute_material* material, const comminute_grading* start,
                           const comminute_grid* grid, const comminute_table_options* options,
                           comminute_table** table, char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        const comminute_table_options& chosen = struct_of(options, "options");
        const LogGrid on = grid_of(grid);
        known(table, "table");
        QuasiStaticOptions solver;
        solver.loading_rate = chosen.loading_rate;
        ResponseOptions response;
        response.tolerance = chosen.tolerance;
        auto made = std::make_unique<comminute_table>(comminute_table{ResponseTable(
            QuasiStatic(on, known(material, "material").material, solver),
            mixed_fabric(known(start, "start").grading, on), chosen.max_stress_ratio, response)});
        *table = made.release();
        return COMMINUTE_OK;
    });
}

int comminute_table_unpack(const unsigned char* bytes, size_t count, comminute_table** table, char* message,
                           size_t message_size) {
    return guarded({message, message_size}, [&] {
        known(table, "table");
        auto made = std::make_unique<comminute_table>(
            comminute_table{ResponseTable::from_bytes({&known(bytes, "bytes"), static_cast<Index>(count)})});
        *table = made.release();
        return COMMINUTE_OK;
    });
}

int comminute_table_pack(const comminute_table* table, unsigned char* bytes, size_t count, size_t* needed,
                         char* message, size_t message_size) {
    return guarded({message, message_size},
                   [&] { return give_bytes(known(table, "table").table.to_bytes(), bytes, count, needed); });
}

void comminute_table_destroy(comminute_table* table) {
    delete table;
}

int comminute_table_percentile(const comminute_table* table, double percent, const double* stress_ratio,
                               int64_t count, double* size, double* derivative, char* message,
                               size_t message_size) {
    const auto read = [percent](const ResponseTable& looked, double load) {
        return looked.percentile(percent, load);
    };
    const bool is_percent = percent >= 0.0 && percent <= 100.0;
    if (!is_percent) {
        return guarded({message, message_size}, [&] {
            require(false, "percent", percent, "between 0 and 100");
            return COMMINUTE_OK;
        });
    }
    return look_up(table, stress_ratio, count, size, derivative, {message, message_size}, read);
}

int comminute_table_crushes(const comminute_table* table, const double* stress_ratio, int64_t count,
                            double* crushes, double* derivative, char* message, size_t message_size) {
    return look_up(table, stress_ratio, count, crushes, derivative, {message, message_size},
                   [](const ResponseTable& looked, double load) { return looked.crushes(load); });
}

int comminute_table_finer(const comminute_table* table, int64_t bin, const double* stress_ratio,
                          int64_t count, double* finer, double* derivative, char* message,
                          size_t message_size) {
    return guarded({message, message_size}, [&] {
        const Index bins = known(table, "table").table.grid().bins();
        require(bin >= 0 && bin < bins, "bin", static_cast<double>(bin), "a bin of the table's grid");
        return look_up(table, stress_ratio, count, finer, derivative, {message, message_size},
                       [bin](const ResponseTable& looked, double load) {
                           return looked.finer(static_cast<Index>(bin), load);
                       });
    });
}
