// SPDX-License-Identifier: BSD-3-Clause
#include "shell_zone.hpp"

#include <algorithm>
#include <cmath>

#include "multiversion.hpp"

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // of functions that hand packs around; all are inlined
#endif

namespace comminute {
namespace {

COMMINUTE_INLINE Pack all(double value) {
    return Pack{} + value;
}

COMMINUTE_INLINE Pack larger(const Pack& a, const Pack& b) {
    return a > b ? a : b;
}

COMMINUTE_INLINE Pack smaller(const Pack& a, const Pack& b) {
    return a < b ? a : b;
}

// Of what is not negative; 0 of what is.
COMMINUTE_INLINE Pack root_of(const Pack& square) {
    double values[lanes];
    pack_at(values) = larger(square, Pack{});
    for (double& value : values) value = std::sqrt(value);
    return pack_at(values);
}

// Of eight shells side by side. Their zones are measured by s = sqrt(t - tip), from where they begin in the shell.
struct EightShells {
    struct Piece {  // empty where `to` is not beyond `from`
        Pack from;
        Pack to;
    };

    Pack tip;
    Pack begin;
    Pack s_begin;
    Pack s_length;  // 0 in a shell without a zone
    double steepness;
    double root;

    COMMINUTE_INLINE EightShells(double tip_of_0, double shell, double steep)
        : steepness(steep), root(std::sqrt(steep)) {
        for (Index l = 0; l < lanes; ++l) tip[l] = tip_of_0 - (shell + static_cast<double>(l));
        begin = larger(tip, all(-0.5));
        s_begin = root_of(begin - tip);
        s_length = begin < 0.5 ? (0.5 - begin) / (root_of(0.5 - tip) + s_begin) : Pack{};
    }

    // Where omega(t) - t >= distance - 1/2: between the roots of a quadratic in s. An error of a root does not matter,
    // since the length covered begins to grow there.
    COMMINUTE_INLINE Piece wider_than(const Pack& distance) const {
        const Pack c = distance - 0.5 + tip;  // s^2 - root s + c <= 0
        const Pack discriminant = 0.25 * steepness - c;
        const Pack far = 0.5 * root + root_of(discriminant);
        const Pack near = c > 0.0 ? c / far : Pack{};
        const Pack from = discriminant >= 0.0 ? larger(near - s_begin, Pack{}) : Pack{};
        const Pack to = discriminant >= 0.0 ? smaller(far - s_begin, s_length) : Pack{};
        return {from, larger(to, from)};
    }

    // Integral over t of a length that is quadratic in s: with dt = 2 s ds a cubic, exact by two Gauss nodes.
    template <class Length>
    COMMINUTE_INLINE Pack integral(const Pack& from, const Pack& to, const Length& length) const {
        constexpr double node = 0.57735026918962576451;  // 1 / sqrt(3)
        const Pack half = 0.5 * larger(to - from, Pack{});
        const Pack centre = from + half;
        Pack sum{};
        for (const double side : {-node, node}) {
            const Pack step = centre + side * half;
            const Pack s = s_begin + step;
            sum += 2.0 * s * length(s, begin + step * (s_begin + s));
        }
        return half * sum;
    }

    // The zone covers the length clamp(1/2 - d - t + omega, 0, 1) of the smaller grain's cell; `some` is where that is
    // above 0, `whole` where it is 1. At d = 0 it covers twice min(omega, t + 1/2); `whole` is where that is the latter.
    COMMINUTE_INLINE Pack share(const Pack& distance, const Piece& some, Piece whole) const {
        const auto diagonal = distance == 0.0;
        const Pack from = diagonal ? Pack{} : some.from;
        const Pack to = diagonal ? s_length : some.to;
        const auto any = whole.to > whole.from;
        whole = {any ? whole.from : to, any ? whole.to : to};
        const auto partly = [&](const Pack& s, const Pack& t) {
            return diagonal ? 2.0 * root * s : 0.5 - distance - t + root * s;
        };
        const auto wholly = [&](const Pack&, const Pack& t) { return diagonal ? 2.0 * t + 1.0 : all(1.0); };
        const Pack found = integral(from, whole.from, partly) + integral(whole.from, whole.to, wholly) +
                           integral(whole.to, to, partly);
        return smaller(larger(found, Pack{}), all(1.0));
    }
};

COMMINUTE_MULTIVERSION void shares_of_eight(double tip, double shell, double steepness, const Index* first,
                                            Index rows, double* share) {
    const EightShells shells(tip, shell, steepness);
    Pack distance;
    for (Index l = 0; l < lanes; ++l) distance[l] = static_cast<double>(first[l]);
    EightShells::Piece some = shells.wider_than(distance);
    for (Index row = 0; row < rows; ++row, share += lanes) {
        const EightShells::Piece whole = shells.wider_than(distance + 1.0);
        pack_at(share) = shells.share(distance, some, whole);
        some = whole;
        distance += 1.0;
    }
}

// A cell at d >= 1 lies inside where d <= omega(t) - t - 1/2 for all t, one at d = 0 where 0 <= omega(t) - t - 1/2.
// omega(t) - t is concave, so its least value is at an end. A cell lies outside where d >= 1/2 - t + omega(t) for all t,
// which is at most 1 + omega(1/2).
COMMINUTE_MULTIVERSION void widths_of_eight(double tip, double shell, double steepness, double* inner,
                                            double* outer) {
    const EightShells shells(tip, shell, steepness);
    const Pack at_end = shells.root * (shells.s_begin + shells.s_length);
    pack_at(inner) = shells.tip <= -0.5 ? smaller(shells.root * shells.s_begin, at_end - 1.0) : all(-1.0);
    pack_at(outer) = shells.tip < 0.5 ? 1.0 + at_end : all(-1.0);
}

}  // namespace

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
            const double tip = tip_ - static_cast<double>(m + l);
            inner[l] = tip < -0.5 ? steepness_ * (-0.5 - tip) : -1.0;
            outer[l] = tip < 0.5 ? steepness_ * (0.5 - tip) : -1.0;
        }
    } else {
        widths_of_eight(tip_, static_cast<double>(m), steepness_, inner, outer);
    }
    Extents extents;
    for (Index l = 0; l < lanes; ++l) {
        const auto most = static_cast<double>(m + l);
        const auto at = static_cast<std::size_t>(l);
        extents.whole[at] = inner[l] >= 0.0 ? static_cast<Index>(std::min(inner[l], most)) + 1 : 0;
        extents.last[at] = outer[l] >= 0.0 ? static_cast<Index>(std::min(outer[l], most)) : -1;
    }
    return extents;
}

void ShellZones::shares(Index m, const Distances& first, Index rows, double* share) const {
    if (!std::isinf(tip_) && !std::isinf(steepness_)) {
        shares_of_eight(tip_, static_cast<double>(m), steepness_, first.data(), rows, share);
        return;
    }
    for (Index row = 0; row < rows; ++row) {  // the zone is all to the right of the tip
        for (Index l = 0; l < lanes; ++l) {
            const double begin = std::clamp(tip_ - static_cast<double>(m + l), -0.5, 0.5);
            const double above = 0.5 - begin;
            share[row * lanes + l] =
                first[static_cast<std::size_t>(l)] + row == 0 ? above * (2.0 - above) : above;
        }
    }
}

}  // namespace comminute
