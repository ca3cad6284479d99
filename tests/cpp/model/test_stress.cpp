// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <array>
#include <type_traits>

#include "support/helpers.hpp"

using comminute::Material;
using comminute::MatrixView;
using comminute::ParameterError;
using comminute::ShapeError;
using comminute::StressKind;
using comminute::StressMeasure;
using comminute::StressScale;
using comminute::StressSign;
using helpers::at;
using helpers::Index;
using helpers::infinity;
using helpers::log_uniform;
using helpers::not_a_number;

namespace {

constexpr std::array<StressKind, 4> kinds = {StressKind::largest, StressKind::mean, StressKind::octahedral,
                                             StressKind::energy};

using Voigt = std::array<double, 6>;

Voigt voigt(const Eigen::Matrix3d& s) {
    return {s(0, 0), s(1, 1), s(2, 2), s(1, 2), s(0, 2), s(0, 1)};
}

Eigen::Matrix3d rotation(std::mt19937_64& random) {
    std::normal_distribution<double> normal;
    const Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
    return q.normalized().toRotationMatrix();
}

Eigen::Matrix3d rotated(const Eigen::Vector3d& principal, std::mt19937_64& random) {
    const Eigen::Matrix3d r = rotation(random);
    const Eigen::Matrix3d s = r * principal.asDiagonal() * r.transpose();
    return 0.5 * (s + s.transpose());
}

// Compressive principal stresses, of which a third of the draws has two that are equal or nearly so.
Eigen::Vector3d principal_stresses(std::mt19937_64& random) {
    Eigen::Vector3d s(log_uniform(random, 0.1, 10.0), log_uniform(random, 0.1, 10.0),
                      log_uniform(random, 0.1, 10.0));
    const auto pick = random() % 9;
    if (pick == 0) s[1] = s[0];
    if (pick == 1) s[1] = s[0] * (1.0 + log_uniform(random, 1e-16, 1e-2));
    if (pick == 2) s[2] = s[1] = s[0] * (1.0 + log_uniform(random, 1e-16, 1e-8));
    return s;
}

// The measures from principal stresses, as the textbooks have them.
double by_definition(StressKind kind, double nu, const Eigen::Vector3d& s) {
    const double p = s.mean();
    const double q =
        std::sqrt(0.5 * (std::pow(s[0] - s[1], 2) + std::pow(s[1] - s[2], 2) + std::pow(s[2] - s[0], 2)));
    switch (kind) {
        case StressKind::largest:
            return s.maxCoeff();
        case StressKind::mean:
            return p;
        case StressKind::octahedral:
            return std::sqrt(2.0) / 3.0 * q;
        case StressKind::energy:
            break;
    }
    const double bulk = 1.0 / (3.0 * (1.0 - 2.0 * nu));  // of a Young's modulus of 1
    const double shear = 1.0 / (2.0 * (1.0 + nu));
    return std::sqrt(p * p + bulk / (3.0 * shear) * q * q);
}

StressMeasure measure_of(StressKind kind, double nu = 0.2) {
    return StressMeasure(kind, nu);
}

}  // namespace

static_assert(std::is_trivially_copyable_v<StressMeasure> && std::is_trivially_copyable_v<StressScale>);
static_assert(noexcept(std::declval<StressMeasure>().equivalent(static_cast<const double*>(nullptr))));
static_assert(noexcept(std::declval<StressScale>().stress_ratio(static_cast<const double*>(nullptr))));
static_assert(noexcept(std::declval<StressScale>().stress_ratio_pq(1.0, 1.0)));
static_assert(noexcept(std::declval<StressScale>().stress_ratio_vertical(1.0, 1.0)));

TEST_CASE("an isotropic stress is its pressure by every measure, to the bit") {
    std::mt19937_64 random(1);
    for (int draw = 0; draw < 2000; ++draw) {
        const double s = log_uniform(random, 1e-12, 1e12);
        const Voigt sigma = {s, s, s, 0.0, 0.0, 0.0};
        for (const StressKind kind : kinds) {
            const double wanted = kind == StressKind::octahedral ? 0.0 : s;
            CHECK(measure_of(kind).equivalent(sigma.data()) == wanted);
            CHECK(measure_of(kind).equivalent_pq(s, 0.0) == wanted);
        }
    }
}

TEST_CASE("measures are those of the principal stresses, however the axes are turned") {
    std::mt19937_64 random(2);
    double worst = 0.0;
    for (int draw = 0; draw < 20000; ++draw) {
        const double nu = std::uniform_real_distribution<double>(0.0, 0.45)(random);
        const Eigen::Vector3d principal = principal_stresses(random);
        const Voigt sigma = voigt(rotated(principal, random));
        for (const StressKind kind : kinds) {
            const double found = measure_of(kind, nu).equivalent(sigma.data());
            worst =
                std::max(worst, std::abs(found - by_definition(kind, nu, principal)) / principal.maxCoeff());
        }
    }
    CHECK(worst < 1e-14);
}

TEST_CASE("the largest principal stress keeps its digits where others meet it, at any scale") {
    std::mt19937_64 random(3);
    double worst = 0.0;
    for (int draw = 0; draw < 20000; ++draw) {
        const double scale = std::pow(10.0, std::uniform_real_distribution<double>(-290.0, 290.0)(random));
        const Eigen::Matrix3d s = rotated(principal_stresses(random), random);
        const double wanted =
            Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(s, Eigen::EigenvaluesOnly).eigenvalues()[2];
        const Voigt sigma = voigt(scale * s);
        const double found = measure_of(StressKind::largest).equivalent(sigma.data()) / scale;
        worst = std::max(worst, std::abs(found - wanted) / wanted);
    }
    CHECK(worst < 1e-14);
}

TEST_CASE("the square of the energy measure over 2 K is the energy of a linear elastic body") {
    std::mt19937_64 random(4);
    for (int draw = 0; draw < 1000; ++draw) {
        const double nu = std::uniform_real_distribution<double>(0.0, 0.45)(random);
        const double young = log_uniform(random, 0.1, 100.0);
        const Eigen::Matrix3d s = rotated(principal_stresses(random), random);
        const Eigen::Matrix3d strain =
            ((1.0 + nu) * s - nu * s.trace() * Eigen::Matrix3d::Identity()) / young;
        const double energy = 0.5 * s.cwiseProduct(strain).sum();
        const double bulk = young / (3.0 * (1.0 - 2.0 * nu));
        const double found = measure_of(StressKind::energy, nu).equivalent(voigt(s).data());
        CHECK(std::abs(found * found / (2.0 * bulk) - energy) < 1e-13 * energy);
    }
}

TEST_CASE("without lateral strain, K0 = nu / (1 - nu), the energy measure has a closed form") {
    for (const double nu : {0.0, 0.1, 0.2, 0.3, 0.4, 0.49}) {
        const double wanted = 12.0 * std::sqrt((1.0 + nu) / (3.0 * (1.0 - nu)));
        const double found = measure_of(StressKind::energy, nu).equivalent_vertical(12.0, nu / (1.0 - nu));
        CHECK(std::abs(found - wanted) < 1e-14 * wanted);
    }
}

TEST_CASE("an oedometer by energy and by mean stress: the table") {
    constexpr std::array<double, 5> k0 = {0.3, 0.4, 0.5, 0.6, 1.0};
    constexpr std::array<double, 5> fifth = {0.709, 0.721, 0.745, 0.780, 1.0};
    constexpr std::array<double, 5> three_tenths = {0.799, 0.787, 0.791, 0.808, 1.0};
    constexpr std::array<double, 5> mean = {0.533, 0.6, 0.667, 0.733, 1.0};
    for (std::size_t k = 0; k < 5; ++k) {
        CHECK(std::abs(measure_of(StressKind::energy, 0.2).equivalent_vertical(1.0, k0[k]) - fifth[k]) <
              5e-4);
        CHECK(std::abs(measure_of(StressKind::energy, 0.3).equivalent_vertical(1.0, k0[k]) -
                       three_tenths[k]) < 5e-4);
        CHECK(std::abs(measure_of(StressKind::mean).equivalent_vertical(1.0, k0[k]) - mean[k]) < 5e-4);
        CHECK(measure_of(StressKind::largest).equivalent_vertical(1.0, k0[k]) == 1.0);
        CHECK(std::abs(measure_of(StressKind::octahedral).equivalent_vertical(1.0, k0[k]) -
                       std::sqrt(2.0) * (1.0 - k0[k]) / 3.0) < 1e-15);
    }
    CHECK(1.0 / measure_of(StressKind::mean).equivalent_vertical(1.0, 0.5) == doctest::Approx(1.5));
    CHECK(std::abs(1.0 / measure_of(StressKind::energy).equivalent_vertical(1.0, 0.5) - 1.34) < 5e-3);
}

TEST_CASE("pairs and vertical stresses are the tensors that they stand for") {
    std::mt19937_64 random(5);
    for (int draw = 0; draw < 1000; ++draw) {
        const double axial = log_uniform(random, 0.1, 10.0);
        const double radial = log_uniform(random, 0.1, 10.0);
        const Voigt sigma = {radial, radial, axial, 0.0, 0.0, 0.0};
        for (const StressKind kind : kinds) {
            const StressMeasure measure = measure_of(kind);
            const double wanted = measure.equivalent(sigma.data());
            const double tolerance = 1e-14 * std::max(axial, radial);
            CHECK(std::abs(measure.equivalent_pq((axial + 2.0 * radial) / 3.0, axial - radial) - wanted) <
                  tolerance);
            CHECK(std::abs(measure.equivalent_vertical(axial, radial / axial) - wanted) < tolerance);
        }
    }
}

TEST_CASE("measures are of degree 1, and the sign of compression is the host's") {
    std::mt19937_64 random(6);
    for (int draw = 0; draw < 1000; ++draw) {
        const double factor = log_uniform(random, 1e-100, 1e100);
        const Eigen::Matrix3d s = rotated(principal_stresses(random), random);
        const Voigt sigma = voigt(s);
        const Voigt scaled = voigt(factor * s);
        const Voigt turned = voigt(-s);
        for (const StressKind kind : kinds) {
            const StressMeasure measure = measure_of(kind);
            const double once = measure.equivalent(sigma.data());
            CHECK(std::abs(measure.equivalent(scaled.data()) / factor - once) <
                  2e-15 * measure_of(StressKind::largest).equivalent(sigma.data()));
            CHECK(measure.equivalent(turned.data(), StressSign::compression_negative) == once);
            CHECK(measure.equivalent(turned.data()) == 0.0);
        }
    }
}

TEST_CASE("a packing in tension carries no load, and what is no number stays none") {
    const Voigt nothing = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    const Voigt pulled = {1.0, 1.0, -3.0, 0.0, 0.0, 0.0};  // p < 0 < sigma_1
    const Voigt uniaxial = {0.0, 0.0, -1.0, 0.0, 0.0, 0.0};
    for (const StressKind kind : kinds) {
        const StressMeasure measure = measure_of(kind);
        CHECK(measure.equivalent(nothing.data()) == 0.0);
        CHECK_FALSE(std::signbit(measure.equivalent(uniaxial.data())));
        CHECK(measure.equivalent(pulled.data()) == 0.0);
        CHECK(measure.equivalent(uniaxial.data()) == 0.0);
        CHECK(measure.equivalent_pq(-1.0, 9.0) == 0.0);
        CHECK(measure.equivalent_pq(0.0, 0.0) == 0.0);
        CHECK(measure.equivalent_vertical(-1.0, 0.5) == 0.0);
        CHECK(measure.equivalent_vertical(0.0, 0.5) == 0.0);
        for (std::size_t k = 0; k < 6; ++k) {
            Voigt sigma = {1.0, 2.0, 3.0, 0.1, 0.2, 0.3};
            sigma[k] = not_a_number;
            CHECK(std::isnan(measure.equivalent(sigma.data())));
            CHECK(std::isnan(measure.equivalent(sigma.data(), StressSign::compression_negative)));
        }
        CHECK(std::isnan(measure.equivalent_pq(not_a_number, 1.0)));
        CHECK(std::isnan(measure.equivalent_pq(1.0, not_a_number)));
        CHECK(std::isnan(measure.equivalent_pq(-1.0, not_a_number)));
        CHECK(std::isnan(measure.equivalent_vertical(1.0, not_a_number)));
    }
}

TEST_CASE("many tensors in one call are each its own, also with rows apart") {
    std::mt19937_64 random(7);
    const Index points = 50;
    std::vector<double> rows(at(8 * points), not_a_number);
    std::vector<double> found(at(points));
    for (Index i = 0; i < points; ++i) {
        const Voigt sigma = voigt(rotated(principal_stresses(random), random));
        std::copy(sigma.begin(), sigma.end(), rows.begin() + 8 * i);
    }
    rows[at(8 * 3)] = not_a_number;
    const MatrixView<const double> sigma(rows.data(), points, 6, 8);
    const StressScale scale(measure_of(StressKind::energy), 2.0);
    scale.stress_ratio(sigma, found);
    for (Index i = 0; i < points; ++i) {
        if (i == 3) continue;
        CHECK(found[at(i)] == scale.measure().equivalent(sigma.row(i)) / 2.0);
        CHECK(found[at(i)] == scale.stress_ratio(sigma.row(i)));
    }
    CHECK(std::isnan(found[3]));

    CHECK_THROWS_WITH_AS(scale.stress_ratio(MatrixView<const double>(rows.data(), points, 5), found),
                         "sigma has shape (50, 5); a stress has six numbers, xx yy zz yz xz xy, a row each",
                         ShapeError);
    std::vector<double> few(3);
    CHECK_THROWS_WITH_AS(scale.stress_ratio(sigma, few), "out has 3 entries; there are 50 stresses",
                         ShapeError);
}

TEST_CASE("measures and materials refuse what makes no measure") {
    CHECK_REFUSED(StressMeasure(StressKind::energy, 0.5),
                  "poisson is 0.5; it must be at least 0 and less than 0.5");
    CHECK_REFUSED(StressMeasure(StressKind::mean, -0.1),
                  "poisson is -0.1; it must be at least 0 and less than 0.5");
    CHECK_REFUSED(StressMeasure(StressKind::energy, not_a_number),
                  "poisson is nan; it must be at least 0 and less than 0.5");
    CHECK_REFUSED(
        StressMeasure{StressKind::energy},
        "poisson is missing; the energy measure of a stress needs it, at least 0 and less than 0.5");
    CHECK_REFUSED(StressScale(measure_of(StressKind::mean), 0.0),
                  "first_crush is 0; it must be greater than 0 and finite");

    Material sand;
    sand.first_crush_stress = 12.0;
    CHECK_REFUSED(sand.stress_scale(),
                  "stress_measure is missing; stresses that are not single numbers need it. Set "
                  "Material::stress_measure, the measure in which first_crush_stress is known");
    sand.k0 = 0.5;
    CHECK_REFUSED(sand.validate(),
                  "k0 is 0.5; it belongs to a stress measure, which is not set. Set "
                  "Material::stress_measure, the measure in which first_crush_stress is known");
    sand.stress_measure = measure_of(StressKind::octahedral);
    for (const double wrong : {-0.1, infinity, not_a_number}) {
        sand.k0 = wrong;
        CHECK_THROWS_AS(sand.validate(), ParameterError);
    }
    sand.k0 = 1.0;
    CHECK_REFUSED(sand.validate(),
                  "k0 is 1; it must be other than 1 with the octahedral measure, which is 0 there");
    sand.k0 = 0.5;
    sand.first_crush_stress.reset();
    CHECK_REFUSED(sand.stress_scale(),
                  "stress is a tensor; it needs first_crush_stress, which is not set. Set it on the "
                  "Material, or give stress_ratio");
}

TEST_CASE("a material's first crush stress is a value of its measure, or a vertical stress with K0") {
    Material sand;
    sand.first_crush_stress = 12.0;
    for (const StressKind kind : kinds) {
        sand.stress_measure = measure_of(kind);
        sand.k0.reset();
        CHECK(sand.stress_scale().first_crush() == 12.0);
        sand.k0 = 0.5;
        const StressScale scale = sand.stress_scale();
        CHECK(scale.first_crush() == measure_of(kind).equivalent_vertical(12.0, 0.5));
        CHECK(scale.stress_ratio_vertical(12.0, 0.5) == 1.0);
        CHECK(scale.stress_ratio_vertical(36.0, 0.5) == doctest::Approx(sand.stress_ratio(36.0)));
    }
    Material other = sand;
    CHECK(other == sand);
    other.k0 = 0.4;
    CHECK_FALSE(other == sand);
    other = sand;
    other.stress_measure = measure_of(StressKind::energy, 0.3);
    CHECK_FALSE(other == sand);
    other.stress_measure.reset();
    CHECK_FALSE(other == sand);
}
