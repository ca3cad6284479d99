// SPDX-License-Identifier: BSD-3-Clause
#include "simd/zone_shares.hpp"

#include <cmath>

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/zone_shares.cpp"
#include <hwy/foreach_target.h>

#include "simd/registers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

// 0 for what is negative.
HWY_INLINE Numbers root_of(Numbers square) {
    return hn::Sqrt(hn::Max(square, zero()));
}

// Piece of a shell; empty where `to` is not beyond `from`.
struct Piece {
    Numbers from;
    Numbers to;
};

// A register of shells. Places in them are measured by s = sqrt(t - tip), from where the zone begins in the shell.
struct Shells {
    Numbers tip;
    Numbers begin;     // the t where the zone begins
    Numbers s_begin;   // the s of it
    Numbers s_length;  // extent of the zone in s, 0 in a shell without a zone
    double steepness;
    double root;

    HWY_INLINE Shells(SlowZone zone, Index first)
        : tip(hn::Sub(all(zone.tip), hn::Iota(widest, static_cast<double>(first)))),
          begin(hn::Max(tip, all(-0.5))),
          s_begin(root_of(hn::Sub(begin, tip))),
          steepness(zone.steepness),
          root(std::sqrt(zone.steepness)) {
        const Numbers length = hn::Sub(all(0.5), begin);
        s_length = hn::IfThenElseZero(hn::Lt(begin, all(0.5)),
                                      hn::Div(length, hn::Add(root_of(hn::Sub(all(0.5), tip)), s_begin)));
    }

    // The piece with omega(t) - t >= distance - 1/2. In s it lies between the roots of s^2 - root s + c. An error of a
    // root does not matter, since the length that the zone covers begins to grow there.
    HWY_INLINE Piece wider_than(Numbers distance) const {
        const Numbers c = hn::Add(hn::Sub(distance, all(0.5)), tip);
        const Numbers discriminant = hn::Sub(all(0.25 * steepness), c);
        const auto real = hn::Ge(discriminant, zero());
        const Numbers far = hn::Add(all(0.5 * root), root_of(discriminant));
        const Numbers near = hn::IfThenElseZero(hn::Gt(c, zero()), hn::Div(c, far));
        const Numbers from = hn::IfThenElseZero(real, hn::Max(hn::Sub(near, s_begin), zero()));
        const Numbers to = hn::IfThenElseZero(real, hn::Min(hn::Sub(far, s_begin), s_length));
        return {from, hn::Max(to, from)};
    }

    // Integral over t of a length that is quadratic in s: with dt = 2 s ds a cubic, exact by two Gauss nodes.
    template <class Length>
    HWY_INLINE Numbers integral(Numbers from, Numbers to, const Length& length) const {
        constexpr double node = 0.57735026918962576451;  // 1 / sqrt(3)
        const Numbers half = hn::Mul(all(0.5), hn::Max(hn::Sub(to, from), zero()));
        const Numbers centre = hn::Add(from, half);
        Numbers sum = zero();
        for (const double side : {-node, node}) {
            const Numbers step = hn::MulAdd(all(side), half, centre);
            const Numbers s = hn::Add(s_begin, step);
            const Numbers t = hn::MulAdd(step, hn::Add(s_begin, s), begin);
            sum = hn::MulAdd(hn::Add(s, s), length(s, t), sum);
        }
        return hn::Mul(half, sum);
    }

    HWY_INLINE Numbers share(Numbers distance, Piece some, Piece whole) const;
};

using Mask = hn::Mask<Tag<lanes>>;

// Length that the zone covers of the smaller grain's bin where it ends in it.
struct PartLength {
    Mask diagonal;
    Numbers distance;
    double root;
    HWY_INLINE Numbers operator()(Numbers s, Numbers t) const {
        const Numbers omega = hn::Mul(all(root), s);
        return hn::IfThenElse(diagonal, hn::Add(omega, omega),
                              hn::Add(hn::Sub(hn::Sub(all(0.5), distance), t), omega));
    }
};

// The same where the zone goes beyond the bin.
struct WholeLength {
    Mask diagonal;
    HWY_INLINE Numbers operator()(Numbers, Numbers t) const {
        return hn::IfThenElse(diagonal, hn::MulAdd(all(2.0), t, all(1.0)), all(1.0));
    }
};

// Share of the cells at a distance. The zone covers something of the smaller grain's bin in the piece `some`, and all of it
// in the piece `whole`.
HWY_INLINE Numbers Shells::share(Numbers distance, Piece some, Piece whole) const {
    const Mask diagonal = hn::Eq(distance, zero());
    const Numbers from = hn::IfThenZeroElse(diagonal, some.from);
    const Numbers to = hn::IfThenElse(diagonal, s_length, some.to);
    const Mask any = hn::Gt(whole.to, whole.from);
    const Numbers whole_from = hn::IfThenElse(any, whole.from, to);
    const Numbers whole_to = hn::IfThenElse(any, whole.to, to);
    const PartLength partly{diagonal, distance, root};
    const Numbers found = hn::Add(
        hn::Add(integral(from, whole_from, partly), integral(whole_from, whole_to, WholeLength{diagonal})),
        integral(whole_to, to, partly));
    return hn::Min(hn::Max(found, zero()), all(1.0));
}

// A cell at d >= 1 lies inside where d <= omega(t) - t - 1/2 for all t, one at d = 0 where 0 <= omega(t) - t - 1/2.
// omega(t) - t is concave, so its least value is at an end. A cell lies outside where d >= 1/2 - t + omega(t) for all t,
// which is at most 1 + omega(1/2).
void zone_widths(SlowZone zone, Index shell, double* inner, double* outer) {
    for (Index lane = 0; lane < lanes; lane += width) {
        const Shells shells(zone, shell + lane);
        const Numbers at_begin = hn::Mul(all(shells.root), shells.s_begin);
        const Numbers at_end = hn::Mul(all(shells.root), hn::Add(shells.s_begin, shells.s_length));
        const Numbers none = all(-1.0);
        const Numbers within = hn::Min(at_begin, hn::Sub(at_end, all(1.0)));
        store(hn::IfThenElse(hn::Le(shells.tip, all(-0.5)), within, none), inner + lane);
        store(hn::IfThenElse(hn::Lt(shells.tip, all(0.5)), hn::Add(all(1.0), at_end), none), outer + lane);
    }
}

void zone_shares(SlowZone zone, Index shell, const double* first, Index rows, double* share) {
    for (Index lane = 0; lane < lanes; lane += width) {
        const Shells shells(zone, shell + lane);
        Numbers distance = load(first + lane);
        Piece some = shells.wider_than(distance);
        for (Index row = 0; row < rows; ++row) {
            const Numbers next = hn::Add(distance, all(1.0));
            const Piece whole = shells.wider_than(next);
            store(shells.share(distance, some, whole), share + row * lanes + lane);
            some = whole;
            distance = next;
        }
    }
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace comminute::detail {

HWY_EXPORT(zone_widths);
HWY_EXPORT(zone_shares);

void zone_widths(SlowZone zone, Index shell, double* inner, double* outer) {
    HWY_DYNAMIC_DISPATCH(zone_widths)(zone, shell, inner, outer);
}
void zone_shares(SlowZone zone, Index shell, const double* first, Index rows, double* share) {
    HWY_DYNAMIC_DISPATCH(zone_shares)(zone, shell, first, rows, share);
}

}  // namespace comminute::detail
#endif
