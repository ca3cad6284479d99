// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "comminute/export.hpp"
#include "comminute/fragments.hpp"
#include "comminute/stress.hpp"

namespace comminute {

/// Strength, fabric and fragments of the grains. Defaults are the paper's (Section 2, Fig. 3).
///
/// A plain struct: fill the fields, and whatever takes it calls `validate()`.
///
/// @code{.cpp}
/// comminute::Material sand;
/// sand.reference_size = 2.0;       // mm
/// sand.first_crush_stress = 1.2;   // MPa
/// CHECK(sand.stress_ratio(12.0) == doctest::Approx(10.0));
/// @endcode
struct COMMINUTE_API Material {
    double weibull_modulus = 3.0;  ///< w > 0, Weibull modulus of grain strength
    double fabric_width = 0.05;    ///< n > 0, how far a neighbour may differ and still crush; inf: size alone
    double reference_size = 1.0;   ///< s_max > 0, in the unit of the sizes: a reference, not a bound
    FragmentLaw fragments = WeibullFragments{};
    /// Stress at which a grain of reference_size among equals crushes; needed only to speak in stresses.
    std::optional<double> first_crush_stress = std::nullopt;
    /// Measure by which stresses that are not single numbers compare with first_crush_stress.
    std::optional<StressMeasure> stress_measure = std::nullopt;
    /// K0 >= 0, ratio of the horizontal to the vertical stress of the oedometer in which first_crush_stress was found as a
    /// vertical stress; without one it was found as a value of the measure.
    std::optional<double> k0 = std::nullopt;
    /// Scatter of strengths: each grain and each fragment has one of its own, a factor of its critical load that is drawn from
    /// the Weibull law of modulus w and scale 1. For `Lattice` and `Resolved`.
    bool strength_scatter = false;

    /// @throws ParameterError naming the field, its value and its range
    void validate() const;
    /// The same for a model that knows one critical load for each pair of sizes.
    /// @throws ParameterError where strengths are scattered too
    void validate_sharp() const;

    /// k = 6 n^2 / w of the log-space stress function (Eq. 15); inf where the fabric is off.
    double k() const { return 6.0 * fabric_width * fabric_width / weibull_modulus; }

    /// Dimensionless load of a stress that is quoted as first_crush_stress is.
    /// @throws ParameterError if first_crush_stress is not set, or for a negative or NaN stress
    double stress_ratio(double stress) const;

    /// Makes what turns stress tensors into stress ratios.
    /// @throws ParameterError if first_crush_stress or stress_measure is not set
    StressScale stress_scale() const;

    friend bool operator==(const Material& a, const Material& b) {
        return a.weibull_modulus == b.weibull_modulus && a.fabric_width == b.fabric_width &&
               a.reference_size == b.reference_size && a.fragments == b.fragments &&
               a.first_crush_stress == b.first_crush_stress && a.stress_measure == b.stress_measure &&
               a.k0 == b.k0 && a.strength_scatter == b.strength_scatter;
    }
};

/// @throws ParameterError unless the stress ratio is a number >= 0 (0 is no load)
COMMINUTE_API void require_stress_ratio(double stress_ratio);

}  // namespace comminute
