// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/material.hpp"

#include <cmath>

#include "comminute/error.hpp"

namespace comminute {

namespace {

ParameterError no_first_crush_stress(const std::string& value, std::optional<double> number) {
    return ParameterError({.parameter = "stress",
                           .value = value,
                           .number = number,
                           .rule = "it needs first_crush_stress, which is not set",
                           .remedy = Remedy::set_first_crush_stress});
}

}  // namespace

void Material::validate() const {
    require(weibull_modulus > 0.0 && std::isfinite(weibull_modulus), "weibull_modulus", weibull_modulus,
            "greater than 0 and finite");
    require(fabric_width > 0.0, "fabric_width", fabric_width, "greater than 0 (inf switches the fabric off)");
    require(reference_size > 0.0 && std::isfinite(reference_size), "reference_size", reference_size,
            "greater than 0 and finite");
    if (first_crush_stress) {
        require(*first_crush_stress > 0.0 && std::isfinite(*first_crush_stress), "first_crush_stress",
                *first_crush_stress, "greater than 0 and finite");
    }
    if (k0) {
        require(*k0 >= 0.0 && std::isfinite(*k0), "k0", *k0, "at least 0 and finite");
        if (!stress_measure) {
            throw ParameterError({.parameter = "k0",
                                  .value = text(*k0),
                                  .number = *k0,
                                  .rule = "it belongs to a stress measure, which is not set",
                                  .remedy = Remedy::set_stress_measure});
        }
        require(stress_measure->equivalent_vertical(1.0, *k0) > 0.0, "k0", *k0,
                "other than 1 with the octahedral measure, which is 0 there");
    }
    std::visit([](const auto& law) { law.validate(); }, fragments);
}

void Material::validate_sharp() const {
    validate();
    if (!strength_scatter) return;
    throw ParameterError({.parameter = "strength_scatter",
                          .value = "true",
                          .finding = "is true, and the paper's closure knows one strength for each size",
                          .remedy = Remedy::use_lattice_or_resolved});
}

double Material::stress_ratio(double stress) const {
    if (!first_crush_stress) throw no_first_crush_stress(text(stress), stress);
    require(stress >= 0.0, "stress", stress, "a number of at least 0");
    return stress / *first_crush_stress;
}

StressScale Material::stress_scale() const {
    validate();
    if (!stress_measure) {
        throw ParameterError({.parameter = "stress_measure",
                              .value = "missing",
                              .rule = "stresses that are not single numbers need it",
                              .remedy = Remedy::set_stress_measure});
    }
    if (!first_crush_stress) throw no_first_crush_stress("a tensor", std::nullopt);
    return {*stress_measure,
            k0 ? stress_measure->equivalent_vertical(*first_crush_stress, *k0) : *first_crush_stress};
}

void require_stress_ratio(double stress_ratio) {
    require(stress_ratio >= 0.0, "stress_ratio", stress_ratio, "a number of at least 0 (0 is no load)");
}

}  // namespace comminute
