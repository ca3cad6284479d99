// SPDX-License-Identifier: BSD-3-Clause
// Integrals of the zone over cells, several shells side by side (docs/theory/one_sweep.md, section 3).
#include "zones/shell_zone.hpp"

#include <algorithm>
#include <cmath>

#include "simd/multiversion.hpp"

namespace comminute::detail {
namespace {

template <Index Width>
COMMINUTE_INLINE Vector<Width> all(double value) {
    return Vector<Width>{} + value;
}

template <Index Width>
COMMINUTE_INLINE Vector<Width> larger(const Vector<Width>& a, const Vector<Width>& b) {
    return a > b ? a : b;
}

template <Index Width>
COMMINUTE_INLINE Vector<Width> smaller(const Vector<Width>& a, const Vector<Width>& b) {
    return a < b ? a : b;
}

// Of what is not negative; 0 of what is.
template <Index Width>
COMMINUTE_INLINE Vector<Width> root_of(const Vector<Width>& square) {
    double values[Width];
    store<Width>(larger<Width>(square, Vector<Width>{}), values);
    for (double& value : values) value = std::sqrt(value);
    return load<Width>(values);
}

// Of a few shells side by side. Their zones are measured by s = sqrt(t - tip), from where they begin in the shell.
template <Index Width>
struct SideBySide {
    using Numbers = Vector<Width>;
    struct Piece {  // empty where `to` is not beyond `from`
        Numbers from;
        Numbers to;
    };

    Numbers tip;
    Numbers begin;
    Numbers s_begin;
    Numbers s_length;  // 0 in a shell without a zone
    double steepness;
    double root;

    COMMINUTE_INLINE SideBySide(double tip_of_0, double shell, double steep)
        : steepness(steep), root(std::sqrt(steep)) {
        for (Index l = 0; l < Width; ++l) tip[l] = tip_of_0 - (shell + static_cast<double>(l));
        begin = larger<Width>(tip, all<Width>(-0.5));
        s_begin = root_of<Width>(begin - tip);
        s_length = begin < 0.5 ? (0.5 - begin) / (root_of<Width>(0.5 - tip) + s_begin) : Numbers{};
    }

    // Where omega(t) - t >= distance - 1/2: between the roots of a quadratic in s. An error of a root does not matter,
    // since the length covered begins to grow there.
    COMMINUTE_INLINE Piece wider_than(const Numbers& distance) const {
        const Numbers zero{};
        const Numbers c = distance - 0.5 + tip;  // s^2 - root s + c <= 0
        const Numbers discriminant = 0.25 * steepness - c;
        const Numbers far = 0.5 * root + root_of<Width>(discriminant);
        const Numbers near = c > 0.0 ? c / far : zero;
        const Numbers from = discriminant >= 0.0 ? larger<Width>(near - s_begin, zero) : zero;
        const Numbers to = discriminant >= 0.0 ? smaller<Width>(far - s_begin, s_length) : zero;
        return {from, larger<Width>(to, from)};
    }

    // Integral over t of a length that is quadratic in s: with dt = 2 s ds a cubic, exact by two Gauss nodes.
    template <class Length>
    COMMINUTE_INLINE Numbers integral(const Numbers& from, const Numbers& to, const Length& length) const {
        constexpr double node = 0.57735026918962576451;  // 1 / sqrt(3)
        const Numbers half = 0.5 * larger<Width>(to - from, Numbers{});
        const Numbers centre = from + half;
        Numbers sum{};
        for (const double side : {-node, node}) {
            const Numbers step = centre + side * half;
            const Numbers s = s_begin + step;
            sum += 2.0 * s * length(s, begin + step * (s_begin + s));
        }
        return half * sum;
    }

    // The zone covers the length clamp(1/2 - d - t + omega, 0, 1) of the smaller grain's cell; `some` is where that is
    // above 0, `whole` where it is 1. At d = 0 it covers twice min(omega, t + 1/2); `whole` is where that is the latter.
    COMMINUTE_INLINE Numbers share(const Numbers& distance, const Piece& some, const Piece& whole) const {
        const auto diagonal = distance == 0.0;
        const Numbers from = diagonal ? Numbers{} : some.from;
        const Numbers to = diagonal ? s_length : some.to;
        const auto any = whole.to > whole.from;
        const Numbers whole_from = any ? whole.from : to;
        const Numbers whole_to = any ? whole.to : to;
        // Inlined come what may: left to itself it would return by another convention than its callers', whose registers
        // are wider.
        const auto partly = [&](const Numbers& s, const Numbers& t) COMMINUTE_INLINE_LAMBDA {
            return diagonal ? 2.0 * root * s : 0.5 - distance - t + root * s;
        };
        const auto wholly = [&](const Numbers&, const Numbers& t) COMMINUTE_INLINE_LAMBDA {
            return diagonal ? 2.0 * t + 1.0 : all<Width>(1.0);
        };
        const Numbers found = integral(from, whole_from, partly) + integral(whole_from, whole_to, wholly) +
                              integral(whole_to, to, partly);
        return smaller<Width>(larger<Width>(found, Numbers{}), all<Width>(1.0));
    }
};

template <Index Width>
COMMINUTE_INLINE void shares_of_eight_by(double tip, Index m, double steepness, const Index* first,
                                         Index rows, double* share) {
    for (Index lane = 0; lane < lanes; lane += Width) {
        const SideBySide<Width> shells(tip, static_cast<double>(m + lane), steepness);
        Vector<Width> distance;
        for (Index l = 0; l < Width; ++l) distance[l] = static_cast<double>(first[lane + l]);
        auto some = shells.wider_than(distance);
        for (Index row = 0; row < rows; ++row) {
            const auto whole = shells.wider_than(distance + 1.0);
            store<Width>(shells.share(distance, some, whole), share + row * lanes + lane);
            some = whole;
            distance += 1.0;
        }
    }
}

// A cell at d >= 1 lies inside where d <= omega(t) - t - 1/2 for all t, one at d = 0 where 0 <= omega(t) - t - 1/2.
// omega(t) - t is concave, so its least value is at an end. A cell lies outside where d >= 1/2 - t + omega(t) for all t,
// which is at most 1 + omega(1/2).
template <Index Width>
COMMINUTE_INLINE void widths_of_eight_by(double tip, Index m, double steepness, double* inner,
                                         double* outer) {
    for (Index lane = 0; lane < lanes; lane += Width) {
        const SideBySide<Width> shells(tip, static_cast<double>(m + lane), steepness);
        const Vector<Width> at_begin = shells.root * shells.s_begin;
        const Vector<Width> at_end = shells.root * (shells.s_begin + shells.s_length);
        const Vector<Width> none = all<Width>(-1.0);
        store<Width>(shells.tip <= -0.5 ? smaller<Width>(at_begin, at_end - 1.0) : none, inner + lane);
        store<Width>(shells.tip < 0.5 ? 1.0 + at_end : none, outer + lane);
    }
}

}  // namespace

COMMINUTE_VERSIONS(static void, shares_of_eight,
                   (double tip, Index m, double steepness, const Index* first, Index rows, double* share),
                   (tip, m, steepness, first, rows, share))

COMMINUTE_VERSIONS(static void, widths_of_eight,
                   (double tip, Index m, double steepness, double* inner, double* outer),
                   (tip, m, steepness, inner, outer))

double zone_onset(const Material& material, double log_stress_ratio) {
    return std::log(material.reference_size) - material.weibull_modulus / 3.0 * log_stress_ratio;
}

ShellZones::ShellZones(const LogGrid& grid, const Material& material, double log_stress_ratio)
    : tip_((zone_onset(material, log_stress_ratio) - grid.centre(0)) / grid.spacing()),
      steepness_(material.k() / grid.spacing()) {}

ShellZones::Extents ShellZones::extents(Index m) const {
    double inner[lanes];
    double outer[lanes];
    if (std::isinf(tip_) || std::isinf(steepness_)) {
        for (Index l = 0; l < lanes; ++l) {
            const double tip = steepness_ > 0.0 ? tip_ - static_cast<double>(m + l) : 0.5;
            inner[l] = tip < -0.5 ? steepness_ * (-0.5 - tip) : -1.0;
            outer[l] = tip < 0.5 ? steepness_ * (0.5 - tip) : -1.0;
        }
    } else {
        widths_of_eight(tip_, m, steepness_, inner, outer);
    }
    Extents extents;
    for (Index l = 0; l < lanes; ++l) {
        const auto most = static_cast<double>(m + l);
        extents.whole.data()[l] = inner[l] >= 0.0 ? static_cast<Index>(std::min(inner[l], most)) + 1 : 0;
        extents.last.data()[l] = outer[l] >= 0.0 ? static_cast<Index>(std::min(outer[l], most)) : -1;
    }
    return extents;
}

void ShellZones::shares(Index m, const Distances& first, Index rows, double* share) const {
    if (!std::isinf(tip_) && !std::isinf(steepness_)) {
        shares_of_eight(tip_, m, steepness_, first.data(), rows, share);
        return;
    }
    // With the fabric off the zone holds all sizes above the tip; a fabric so narrow that its square is 0 has none.
    for (Index row = 0; row < rows; ++row) {
        for (Index l = 0; l < lanes; ++l) {
            const double begin = std::clamp(tip_ - static_cast<double>(m + l), -0.5, 0.5);
            const double above = steepness_ > 0.0 ? 0.5 - begin : 0.0;
            share[row * lanes + l] = first.data()[l] + row == 0 ? above * (2.0 - above) : above;
        }
    }
}

}  // namespace comminute::detail
