// SPDX-License-Identifier: BSD-3-Clause
#include "shell_zone.hpp"

#include <algorithm>
#include <cmath>

#include "multiversion.hpp"

namespace comminute {

double zone_onset(const Material& material, double log_stress_ratio) {
    return std::log(material.reference_size) - material.weibull_modulus / 3.0 * log_stress_ratio;
}

ShellZones::ShellZones(const LogGrid& grid, const Material& material, double log_stress_ratio)
    : tip_((zone_onset(material, log_stress_ratio) - grid.centre(0)) / grid.spacing()),
      steepness_(material.k() / grid.spacing()),
      root_(std::sqrt(steepness_)) {}

ShellZone::ShellZone(double tip, double steepness, double root)
    : tip_(tip), steepness_(steepness), root_(root), begin_(std::max(-0.5, tip)) {
    if (!(begin_ < 0.5) || std::isinf(tip_)) return;
    s_begin_ = std::sqrt(begin_ - tip_);
    s_length_ = (0.5 - begin_) / (std::sqrt(0.5 - tip_) + s_begin_);
}

// Where omega(t) - t >= distance - 1/2: between the roots of a quadratic in s. An error of a root does not matter, since
// the length covered begins to grow there.
COMMINUTE_INLINE ShellZone::Piece ShellZone::wider_than(double distance) const {
    const double c = distance - 0.5 + tip_;  // s^2 - root s + c <= 0
    const double discriminant = 0.25 * steepness_ - c;
    if (!(discriminant >= 0.0)) return {};
    const double larger = 0.5 * root_ + std::sqrt(discriminant);
    const double smaller = c > 0.0 ? c / larger : 0.0;
    return {std::max(smaller - s_begin_, 0.0), std::min(larger - s_begin_, s_length_)};
}

// Integral over t of a length that is quadratic in s: with dt = 2 s ds a cubic, exact by two Gauss nodes.
template <class Length>
COMMINUTE_INLINE double ShellZone::integral(const Piece& piece, const Length& length) const {
    if (piece.empty()) return 0.0;
    constexpr double node = 0.57735026918962576451;  // 1 / sqrt(3)
    const double half = 0.5 * (piece.to - piece.from);
    const double centre = piece.from + half;
    double sum = 0.0;
    for (const double step : {centre - node * half, centre + node * half}) {
        const double s = s_begin_ + step;
        sum += 2.0 * s * length(s, begin_ + from_begin(step));
    }
    return half * sum;
}

// The zone covers the length clamp(1/2 - d - t + omega, 0, 1) of the smaller grain's cell; `some` is where that is
// above 0, `all` where it is 1. At d = 0 it covers twice min(omega, t + 1/2); `all` is then where that is the latter.
COMMINUTE_INLINE double ShellZone::share_between(double distance, const Piece& some, const Piece& all) const {
    const bool diagonal = distance == 0.0;
    const auto partly = [&](double s, double t) {
        return diagonal ? 2.0 * root_ * s : 0.5 - distance - t + root_ * s;
    };
    const Piece outer = diagonal ? Piece{0.0, s_length_} : some;
    if (all.empty()) return std::clamp(integral(outer, partly), 0.0, 1.0);
    const double wholly = diagonal ? integral(all, [](double, double t) { return 2.0 * t + 1.0; })
                                   : from_begin(all.to) - from_begin(all.from);
    const double sides = integral({outer.from, all.from}, partly) + integral({all.to, outer.to}, partly);
    return std::clamp(wholly + sides, 0.0, 1.0);
}

void ShellZone::shares(Index first, Index last, double* share) const {
    if (!(begin_ < 0.5) || std::isinf(steepness_) || std::isinf(tip_)) {
        const double above = begin_ < 0.5 ? 0.5 - begin_ : 0.0;
        for (Index d = first; d <= last; ++d) *share++ = d == 0 ? above * (2.0 - above) : above;
        return;
    }
    Piece some = wider_than(static_cast<double>(first));
    for (Index d = first; d <= last; ++d) {
        const auto distance = static_cast<double>(d);
        const Piece all = wider_than(distance + 1.0);
        *share++ = share_between(distance, some, all);
        some = all;
    }
}

double ShellZone::share(Index distance) const {
    double found = 0.0;
    shares(distance, distance, &found);
    return found;
}

// A cell at d >= 1 lies inside where d <= omega(t) - t - 1/2 for all t, one at d = 0 where 0 <= omega(t) - t - 1/2.
// omega(t) - t is concave, so its least value is at an end.
Index ShellZone::surely_whole(Index at_most) const {
    if (!(tip_ <= -0.5)) return 0;
    const double inner = std::isinf(tip_) ? steepness_ * -tip_
                                          : std::min(root_ * s_begin_, root_ * (s_begin_ + s_length_) - 1.0);
    if (!(inner >= 0.0)) return 0;
    return static_cast<Index>(std::min(inner, static_cast<double>(at_most))) + 1;
}

// It lies outside where d >= 1/2 - t + omega(t) for all t; that is less than 1 + omega(1/2).
Index ShellZone::surely_last(Index at_most) const {
    if (!(tip_ < 0.5)) return -1;
    const double widest = std::isinf(tip_) ? steepness_ * -tip_ : root_ * (s_begin_ + s_length_);
    return static_cast<Index>(std::min(2.0 + widest, static_cast<double>(at_most)));
}

}  // namespace comminute
