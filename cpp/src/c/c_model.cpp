// SPDX-License-Identifier: BSD-3-Clause
// Materials, gradings and grids for C.
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "c/c_call.hpp"
#include "c/c_grid.hpp"
#include "comminute/version.hpp"

using namespace comminute;
using namespace comminute::detail;

namespace {

FragmentLaw law_of(const comminute_material_options& o) {
    switch (o.fragments) {
        case COMMINUTE_WEIBULL:
            return WeibullFragments{o.fragments_first, o.fragments_second};
        case COMMINUTE_POWER_LAW:
            return PowerLawFragments{o.fragments_first};
        case COMMINUTE_LOGNORMAL:
            return LogNormalFragments{o.fragments_first, o.fragments_second};
        default:
            throw ParameterError(
                {.parameter = "fragments",
                 .value = std::to_string(o.fragments),
                 .number = static_cast<double>(o.fragments),
                 .rule = "it must be COMMINUTE_WEIBULL, COMMINUTE_POWER_LAW or COMMINUTE_LOGNORMAL"});
    }
}

Material material_of(const comminute_material_options& o) {
    Material material;
    material.weibull_modulus = o.weibull_modulus;
    material.fabric_width = o.fabric_width;
    material.reference_size = o.reference_size;
    material.fragments = law_of(o);
    if (o.first_crush_stress != 0.0) material.first_crush_stress = o.first_crush_stress;
    require(o.stress_measure >= COMMINUTE_NO_MEASURE && o.stress_measure <= COMMINUTE_ENERGY,
            "stress_measure", o.stress_measure, "one of the COMMINUTE_ measures");
    if (o.stress_measure != COMMINUTE_NO_MEASURE) {
        const std::optional<double> poisson = o.poisson < 0.0 ? std::nullopt : std::optional(o.poisson);
        material.stress_measure = StressMeasure(static_cast<StressKind>(o.stress_measure - 1), poisson);
    }
    if (!(o.k0 < 0.0)) material.k0 = o.k0;
    material.validate();
    return material;
}

template <class Make>
int make_grading(comminute_grading** grading, MessageBuffer message, const Make& make) {
    return guarded(message, [&] {
        known(grading, "grading");
        auto made = std::make_unique<comminute_grading>(comminute_grading{make()});
        *grading = made.release();
        return COMMINUTE_OK;
    });
}

}  // namespace

const char* comminute_version(void) {
    return comminute::version;
}

void comminute_material_defaults(comminute_material_options* options) {
    if (options == nullptr) return;
    const Material usual;
    const auto& fragments = std::get<WeibullFragments>(usual.fragments);
    *options = {sizeof *options,
                usual.weibull_modulus,
                usual.fabric_width,
                usual.reference_size,
                COMMINUTE_WEIBULL,
                fragments.scale,
                fragments.shape,
                0.0,
                COMMINUTE_NO_MEASURE,
                -1.0,
                -1.0};
}

int comminute_material_create(const comminute_material_options* options, comminute_material** material,
                              char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        known(material, "material");
        auto made = std::make_unique<comminute_material>(
            comminute_material{material_of(struct_of(options, "options"))});
        *material = made.release();
        return COMMINUTE_OK;
    });
}

void comminute_material_destroy(comminute_material* material) {
    delete material;
}

int comminute_material_stress_ratios(const comminute_material* material, const double* sigma, int64_t count,
                                     int compression, double* stress_ratio, char* message,
                                     size_t message_size) {
    return guarded({message, message_size}, [&] {
        const StressScale scale = known(material, "material").material.stress_scale();
        require(count >= 0, "count", static_cast<double>(count), "at least 0");
        require(compression == 1 || compression == -1, "compression", compression,
                "1 (positive) or -1 (negative)");
        if (count == 0) return COMMINUTE_OK;
        const StressSign sign =
            compression > 0 ? StressSign::compression_positive : StressSign::compression_negative;
        known(sigma, "sigma");
        known(stress_ratio, "stress_ratio");
        scale.stress_ratio({sigma, static_cast<Index>(count), 6}, {stress_ratio, static_cast<Index>(count)},
                           sign);
        return COMMINUTE_OK;
    });
}

int comminute_grading_power_law(double fractal_dimension, double smallest, double largest,
                                comminute_grading** grading, char* message, size_t message_size) {
    return make_grading(grading, {message, message_size},
                        [&] { return power_law(fractal_dimension, smallest, largest); });
}

int comminute_grading_lognormal(double median, double sd_log, double largest, comminute_grading** grading,
                                char* message, size_t message_size) {
    return make_grading(grading, {message, message_size}, [&] { return lognormal(median, sd_log, largest); });
}

int comminute_grading_equal(double size, comminute_grading** grading, char* message, size_t message_size) {
    return make_grading(grading, {message, message_size}, [&] { return monodisperse(size); });
}

int comminute_grading_sieves(const double* sizes, const double* percent_finer, int64_t count,
                             comminute_grading** grading, char* message, size_t message_size) {
    return make_grading(grading, {message, message_size}, [&] {
        require(count >= 1, "count", static_cast<double>(count), "at least 1");
        known(sizes, "sizes");
        known(percent_finer, "percent_finer");
        return sieve_grading(std::vector<double>(sizes, sizes + count),
                             std::vector<double>(percent_finer, percent_finer + count));
    });
}

void comminute_grading_destroy(comminute_grading* grading) {
    delete grading;
}

int comminute_grid_fitting(const comminute_grading* grading, const comminute_material* material,
                           double max_stress_ratio, int64_t bins, comminute_grid* grid, char* message,
                           size_t message_size) {
    return guarded({message, message_size}, [&] {
        GridOptions options;
        if (bins != 0) options.bins = static_cast<Index>(bins);
        const LogGrid fitting = fitting_grid(known(grading, "grading").grading,
                                             known(material, "material").material, max_stress_ratio, options);
        known(grid, "grid") = {sizeof(comminute_grid), fitting.psi_min(), fitting.psi_max(), fitting.bins()};
        return COMMINUTE_OK;
    });
}

int comminute_grid_edges(const comminute_grid* grid, double* sizes, int64_t count, char* message,
                         size_t message_size) {
    return guarded({message, message_size}, [&] {
        const LogGrid on = grid_of(grid);
        require_length(count, on.bins(), "sizes");
        known(sizes, "sizes");
        for (Index i = 0; i < on.bins(); ++i) sizes[i] = std::exp(on.edge(i + 1));
        return COMMINUTE_OK;
    });
}

int comminute_grid_percentile(const comminute_grid* grid, const double* masses, int64_t count, double percent,
                              double* size, char* message, size_t message_size) {
    return guarded({message, message_size}, [&] {
        const LogGrid on = grid_of(grid);
        require_length(count, on.bins(), "masses");
        known(masses, "masses");
        std::vector<double> cdf;
        double finer = 0.0;
        for (Index i = 0; i < on.bins(); ++i) cdf.push_back(finer += masses[i]);
        known(size, "size") = percentile(on, cdf, percent);
        return COMMINUTE_OK;
    });
}
