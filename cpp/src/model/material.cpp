// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/material.hpp"

#include <cmath>

#include "comminute/error.hpp"

namespace comminute {

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
    if (!first_crush_stress) {
        throw ParameterError({.parameter = "stress",
                              .value = text(stress),
                              .number = stress,
                              .rule = "it needs first_crush_stress, which is not set",
                              .remedy = Remedy::set_first_crush_stress});
    }
    require(stress >= 0.0, "stress", stress, "a number of at least 0");
    return stress / *first_crush_stress;
}

void require_stress_ratio(double stress_ratio) {
    require(stress_ratio >= 0.0, "stress_ratio", stress_ratio, "a number of at least 0 (0 is no load)");
}

}  // namespace comminute
