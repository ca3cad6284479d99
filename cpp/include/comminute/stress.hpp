// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "comminute/export.hpp"
#include "comminute/view.hpp"

namespace comminute {

/// The scalar of a stress that stands for its load on the grains. All are isotropic, of degree 1, and equal to the
/// pressure under an isotropic stress, but the octahedral one, which is 0 there.
enum class StressKind {
    largest,     ///< sigma_1, the largest principal stress: the vertical stress of an oedometer where K0 <= 1
    mean,        ///< p = tr(sigma) / 3
    octahedral,  ///< tau_oct = sqrt(2) q / 3, shear alone
    energy,      ///< sqrt(p^2 + K/(3G) q^2), the pressure that stores as much energy in a linear elastic body
};

/// Sign that a host gives to compression.
enum class StressSign { compression_positive, compression_negative };

/// The measure sigma_eq of an effective stress, by which stresses of all kinds compare: grains do not feel a tensor, and
/// the model has one load.
///
/// With K/(3G) = 2 (1 + nu) / (9 (1 - 2 nu)) the energy measure is that of breakage mechanics at no breakage (Einav 2007,
/// J. Mech. Phys. Solids 55, 1274 and 1298): first yield at an elastic energy p^2/(2K) + q^2/(6G). Friction's share in its
/// yield surface is left out.
///
/// A tensor is six numbers, xx yy zz yz xz xy, the last three shear stresses (not doubled, as engineering shear strains
/// are). q = sqrt(3/2) |dev sigma|, in an axisymmetric test the difference of the axial and the radial stress. A packing
/// whose mean stress is tensile (p < 0) carries no load: every measure of it is 0. NaN gives NaN, which solvers refuse.
///
/// A value that is copied freely and read by many threads. No evaluation allocates or throws, and none branches on
/// the stress.
///
/// @code{.cpp}
/// const comminute::StressMeasure energy(comminute::StressKind::energy, 0.2);
/// const double sigma[6] = {5.0, 5.0, 10.0, 0.0, 0.0, 0.0};   // an oedometer, K0 = 0.5, z upwards
/// CHECK(energy.equivalent(sigma) == doctest::Approx(7.454).epsilon(1e-4));
/// CHECK(energy.equivalent_vertical(10.0, 0.5) == doctest::Approx(energy.equivalent(sigma)));
/// CHECK(comminute::StressMeasure(comminute::StressKind::largest).equivalent(sigma) == doctest::Approx(10.0));
/// @endcode
class COMMINUTE_API StressMeasure {
  public:
    /// @param poisson  Poisson's ratio of the packing, at least 0 and less than 0.5; only the energy measure uses it
    /// @throws ParameterError for a ratio outside its range, or none where the energy measure needs one
    explicit StressMeasure(StressKind kind, std::optional<double> poisson = std::nullopt);

    StressKind kind() const noexcept { return kind_; }
    std::optional<double> poisson() const noexcept { return poisson_; }

    /// Measure of one tensor.
    /// @param sigma  xx yy zz yz xz xy
    double equivalent(const double sigma[6],
                      StressSign sign = StressSign::compression_positive) const noexcept;

    /// Measure of many tensors.
    /// @param sigma  (P, 6), each row xx yy zz yz xz xy
    /// @param out    (P)
    /// @throws ShapeError for another shape; nothing about the numbers, of which a bad one spoils its own entry
    void equivalent(MatrixView<const double> sigma, VectorView<double> out,
                    StressSign sign = StressSign::compression_positive) const;

    /// Measure of an axisymmetric stress.
    /// @param p  mean stress, positive in compression
    /// @param q  axial less radial stress, negative in extension; the sign matters to the largest principal stress alone
    double equivalent_pq(double p, double q) const noexcept;

    /// Measure of a stress without lateral strain.
    /// @param vertical  vertical stress, positive in compression
    /// @param k0        ratio of the horizontal to the vertical stress
    double equivalent_vertical(double vertical, double k0) const noexcept;

    friend bool operator==(const StressMeasure& a, const StressMeasure& b) {
        return a.kind_ == b.kind_ && a.poisson_ == b.poisson_;
    }
    friend bool operator!=(const StressMeasure& a, const StressMeasure& b) { return !(a == b); }

  private:
    double weighed(double p, double q, double largest) const noexcept;

    StressKind kind_;
    std::optional<double> poisson_;
    // sigma_eq = largest_ sigma_1 + sqrt(mean_ p^2 + shear_ q^2)
    double largest_ = 0.0;
    double mean_ = 0.0;
    double shear_ = 0.0;
};

/// Stress ratios of a material: its measure of a stress over that of the first crush. `Material::stress_scale` makes it,
/// once, and a host calls it at every material point and step.
///
/// @code{.cpp}
/// comminute::Material sand;
/// sand.first_crush_stress = 12.0;   // MPa, a vertical stress
/// sand.k0 = 0.5;                    // in an oedometer
/// sand.stress_measure = comminute::StressMeasure(comminute::StressKind::energy, 0.2);
/// const comminute::StressScale scale = sand.stress_scale();
/// const double oedometer[6] = {6.0, 6.0, 12.0, 0.0, 0.0, 0.0};
/// CHECK(scale.stress_ratio(oedometer) == doctest::Approx(1.0));
/// CHECK(scale.stress_ratio_pq(12.0, 0.0) == doctest::Approx(1.34).epsilon(2e-3));   // an isotropic 12 MPa does more
/// @endcode
class COMMINUTE_API StressScale {
  public:
    /// @param first_crush  value of the measure at which a grain of the reference size among equals crushes
    /// @throws ParameterError unless it is greater than 0 and finite
    StressScale(const StressMeasure& measure, double first_crush);

    const StressMeasure& measure() const noexcept { return measure_; }
    double first_crush() const noexcept { return first_crush_; }

    /// Stress ratio of one tensor; see StressMeasure::equivalent.
    double stress_ratio(const double sigma[6],
                        StressSign sign = StressSign::compression_positive) const noexcept;

    /// Stress ratios of many tensors.
    /// @param sigma  (P, 6)
    /// @param out    (P), as a BatchSolver takes it
    /// @throws ShapeError for another shape
    void stress_ratio(MatrixView<const double> sigma, VectorView<double> out,
                      StressSign sign = StressSign::compression_positive) const;

    /// Stress ratio of an axisymmetric stress; see StressMeasure::equivalent_pq.
    double stress_ratio_pq(double p, double q) const noexcept;

    /// Stress ratio of a stress without lateral strain; see StressMeasure::equivalent_vertical.
    double stress_ratio_vertical(double vertical, double k0) const noexcept;

  private:
    StressMeasure measure_;
    double first_crush_;
};

}  // namespace comminute
