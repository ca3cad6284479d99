// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/stress.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>

#include "base/check.hpp"
#include "comminute/error.hpp"

namespace comminute {

namespace {

/// The deviator of a stress as a vector: the diagonal, and off it sqrt(2) times the entries, so that products of vectors
/// are those of tensors.
using Deviator = std::array<double, 6>;

constexpr double root_two = 1.4142135623730951;

double dot(const Deviator& a, const Deviator& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 6; ++k) sum += a[k] * b[k];
    return sum;
}

/// Area of the parallelogram of two vectors, from its projections: no difference of large numbers, however thin it is.
double area(const Deviator& a, const Deviator& b) {
    double sum = 0.0;
    for (std::size_t k = 0; k < 6; ++k) {
        for (std::size_t l = k + 1; l < 6; ++l) {
            const double minor = a[k] * b[l] - a[l] * b[k];
            sum += minor * minor;
        }
    }
    return std::sqrt(sum);
}

/// Deviator of the square of a deviator.
Deviator squared(const Deviator& s) {
    const double yz = s[3] / root_two;
    const double xz = s[4] / root_two;
    const double xy = s[5] / root_two;
    const double third = dot(s, s) / 3.0;
    return {s[0] * s[0] + xy * xy + xz * xz - third,   s[1] * s[1] + xy * xy + yz * yz - third,
            s[2] * s[2] + xz * xz + yz * yz - third,   s[3] * (s[1] + s[2]) + root_two * xy * xz,
            s[4] * (s[0] + s[2]) + root_two * xy * yz, s[5] * (s[0] + s[1]) + root_two * xz * yz};
}

/// Largest eigenvalue of a deviator of the norm `size`.
///
/// A deviator and its square commute, so both lie in one plane of deviators, the one at the Lode angle theta and the other
/// at -2 theta: the angle between them is 3 theta. As an angle between vectors it keeps its digits where two eigenvalues
/// meet, and where all three do it is 0.
double largest_of(const Deviator& s, double size) {
    const Deviator square = squared(s);
    const double theta = std::atan2(area(s, square), dot(s, square)) / 3.0;
    return std::sqrt(2.0 / 3.0) * size * std::cos(theta);
}

/// The unit in which a stress is weighed, so that no square of it over- or underflows; 0 has one too.
double unit_of(double largest_component) {
    return std::max(largest_component, DBL_MIN);
}

void require_voigt(MatrixView<const double> sigma, VectorView<double> out) {
    if (sigma.cols() != 6 || sigma.stride() < 6) {
        const std::string found = detail::shape_text(sigma.rows(), sigma.cols());
        throw ShapeError({.parameter = "sigma",
                          .value = found,
                          .finding = "has shape " + found,
                          .rule = "a stress has six numbers, xx yy zz yz xz xy, a row each"});
    }
    detail::require_entries(out.size(), sigma.rows(), {.name = "out"},
                            "there are " + std::to_string(sigma.rows()) + " stresses");
}

}  // namespace

StressMeasure::StressMeasure(StressKind kind, std::optional<double> poisson)
    : kind_(kind), poisson_(poisson) {
    if (poisson)
        require(*poisson >= 0.0 && *poisson < 0.5, "poisson", *poisson, "at least 0 and less than 0.5");
    switch (kind) {
        case StressKind::largest:
            largest_ = 1.0;
            return;
        case StressKind::mean:
            mean_ = 1.0;
            return;
        case StressKind::octahedral:
            shear_ = 2.0 / 9.0;
            return;
        case StressKind::energy:
            break;
    }
    if (!poisson) {
        throw ParameterError(
            {.parameter = "poisson",
             .value = "missing",
             .rule = "the energy measure of a stress needs it, at least 0 and less than 0.5"});
    }
    mean_ = 1.0;
    shear_ = 2.0 * (1.0 + *poisson) / (9.0 * (1.0 - 2.0 * *poisson));  // K / 3G
}

double StressMeasure::weighed(double p, double q, double largest) const noexcept {
    const double measure = largest_ * largest + std::sqrt(mean_ * p * p + shear_ * q * q);
    return (p < 0.0 ? 0.0 : 1.0) * std::abs(measure);  // a product, since a NaN must stay one
}

double StressMeasure::equivalent(const double sigma[6], StressSign sign) const noexcept {
    const double unit = unit_of(std::max({std::abs(sigma[0]), std::abs(sigma[1]), std::abs(sigma[2]),
                                          std::abs(sigma[3]), std::abs(sigma[4]), std::abs(sigma[5])}));
    const double compression = sign == StressSign::compression_positive ? unit : -unit;
    Deviator s;
    for (std::size_t k = 0; k < 6; ++k) s[k] = sigma[k] / compression;
    const double p =
        s[0] + ((s[1] - s[0]) + (s[2] - s[0])) / 3.0;  // an isotropic stress has no deviator, to the bit
    for (std::size_t k = 0; k < 3; ++k) s[k] -= p;
    for (std::size_t k = 3; k < 6; ++k) s[k] *= root_two;
    const double size = std::sqrt(dot(s, s));
    // The kind decides and not the stress: an angle takes longer than all the rest.
    const double largest = kind_ == StressKind::largest ? p + largest_of(s, size) : 0.0;
    return unit * weighed(p, std::sqrt(1.5) * size, largest);
}

void StressMeasure::equivalent(MatrixView<const double> sigma, VectorView<double> out,
                               StressSign sign) const {
    require_voigt(sigma, out);
    for (Index i = 0; i < sigma.rows(); ++i) out[i] = equivalent(sigma.row(i), sign);
}

double StressMeasure::equivalent_pq(double p, double q) const noexcept {
    const double unit = unit_of(std::max(std::abs(p), std::abs(q)));
    const double to_largest =
        std::max(2.0 / 3.0 * q, -q / 3.0);  // of the axial stress, or of both radial ones
    return unit * weighed(p / unit, q / unit, (p + to_largest) / unit);
}

double StressMeasure::equivalent_vertical(double vertical, double k0) const noexcept {
    const double unit = unit_of(std::max(std::abs(vertical), std::abs(k0 * vertical)));
    const double axial = vertical / unit;
    const double radial = k0 * vertical / unit;
    return unit * weighed((axial + 2.0 * radial) / 3.0, axial - radial, std::max(axial, radial));
}

StressScale::StressScale(const StressMeasure& measure, double first_crush)
    : measure_(measure), first_crush_(first_crush) {
    require(first_crush > 0.0 && std::isfinite(first_crush), "first_crush", first_crush,
            "greater than 0 and finite");
}

double StressScale::stress_ratio(const double sigma[6], StressSign sign) const noexcept {
    return measure_.equivalent(sigma, sign) / first_crush_;
}

void StressScale::stress_ratio(MatrixView<const double> sigma, VectorView<double> out,
                               StressSign sign) const {
    measure_.equivalent(sigma, out, sign);
    for (double& measure : out) measure /= first_crush_;
}

double StressScale::stress_ratio_pq(double p, double q) const noexcept {
    return measure_.equivalent_pq(p, q) / first_crush_;
}

double StressScale::stress_ratio_vertical(double vertical, double k0) const noexcept {
    return measure_.equivalent_vertical(vertical, k0) / first_crush_;
}

}  // namespace comminute
