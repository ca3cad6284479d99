// SPDX-License-Identifier: BSD-3-Clause
#include "simd/arms.hpp"

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/arms.cpp"
#include <hwy/foreach_target.h>

#include "simd/registers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

// Active part of a mass; 0 where the share is 0, whatever the mass.
HWY_INLINE Numbers active_part(Numbers share, Numbers mass) {
    return hn::IfThenElseZero(hn::Ne(share, zero()), hn::Mul(share, mass));
}

// One arm's part of a few registers of lines.
template <Index Registers>
struct ArmPart {
    Numbers enter[Registers];
    Numbers along[Registers];   // mass arriving along the lines of the arm, and
    Numbers across[Registers];  // along the one that crosses them: apart, so that neither waits for the other
    double* sums;
    const double* crossing;

    HWY_INLINE ArmPart(const Arm& arm, Index terms, Index at)
        : sums(arm.sums + lanes_down(at) * terms + at % lanes), crossing(arm.crossing) {
        for (Index v = 0; v < Registers; ++v) {
            enter[v] = load(arm.enters + at + v * width);
            along[v] = zero();
            across[v] = arm.besides != nullptr ? load(arm.besides + at + v * width) : zero();
        }
    }

    HWY_INLINE void crush(const Shell& shell, const Arm& arm, Index at, Numbers& moved) const {
        for (Index v = 0; v < Registers; ++v, at += width) {
            const Numbers landed =
                hn::Add(along[v], hn::MulAdd(all(shell.diagonal), load(shell.of_diagonal + at), across[v]));
            if (arm.landed != nullptr) store(landed, arm.landed + at);
            const Numbers moving = hn::Add(active_part(load(shell.settled_share + at), load(arm.there + at)),
                                           active_part(load(shell.arrived_share + at), landed));
            store(moving, arm.onto_line + at);
            store(hn::MulAdd(moving, all(shell.below), load(arm.fines + at)), arm.fines + at);
            moved = hn::Add(moved, moving);
        }
    }
};

template <Index Registers>
HWY_INLINE void crush_registers(const Shell& shell, const Arm& first, const Arm& second, Index at,
                                Numbers& moved_first, Numbers& moved_second) {
    const Index terms = shell.terms;
    ArmPart<Registers> arms[2] = {{first, terms, at}, {second, terms, at}};
    const double* const weights = shell.entering;
    const double* const decays = shell.falling;
    const double* power = shell.power + at;
    const Index power_stride = shell.power_stride;
    for (Index a = 0; a < terms; ++a, power += power_stride) {
        const Numbers entering = all(weights[a]);
        const Numbers falling = all(decays[a]);
        const Numbers crossing[2] = {all(arms[0].crossing[a]), all(arms[1].crossing[a])};
        for (Index v = 0; v < Registers; ++v) {
            const Numbers decayed = load(power + v * width);
            for (Index k = 0; k < 2; ++k) {
                double* const line =
                    arms[k].sums + (lanes_down(v * width) * terms + v * width % lanes) + a * lanes;
                const Numbers now = hn::MulAdd(entering, arms[k].enter[v], load(line));
                store(now, line);
                arms[k].along[v] = hn::MulAdd(falling, now, arms[k].along[v]);
                arms[k].across[v] = hn::MulAdd(crossing[k], decayed, arms[k].across[v]);
            }
        }
    }
    arms[0].crush(shell, first, at, moved_first);
    arms[1].crush(shell, second, at, moved_second);
}

// Two registers of each arm at once, or three of the widest where no single one is left over: one alone would wait for
// itself.
Moved crush_arms(const Shell& shell, const Arm& first, const Arm& second, Index count) {
    Numbers moved[2] = {zero(), zero()};
    Index k = 0;
    if constexpr (width < lanes) {
        for (; k < count; k += 2 * width) crush_registers<2>(shell, first, second, k, moved[0], moved[1]);
    } else {
        while (k < count) {
            const Index left = (count - k) / width;
            if (left >= 5 || left == 3) {
                crush_registers<3>(shell, first, second, k, moved[0], moved[1]);
                k += 3 * width;
            } else if (left >= 2) {
                crush_registers<2>(shell, first, second, k, moved[0], moved[1]);
                k += 2 * width;
            } else {
                crush_registers<1>(shell, first, second, k, moved[0], moved[1]);
                k += width;
            }
        }
    }
    return {sum_of(moved[0]), sum_of(moved[1])};
}

struct Leave {
    Staying s;
    double* rest;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        const auto one = hn::Set(d, 1.0);
        const auto stays = hn::Sub(one, hn::LoadU(d, s.settled_share + k));
        const auto stays_landed = hn::Sub(one, hn::LoadU(d, s.arrived_share + k));
        hn::StoreU(
            hn::MulAdd(hn::LoadU(d, s.there + k), stays, hn::Mul(hn::LoadU(d, s.landed + k), stays_landed)),
            d, rest + k);
    }
};
void leave(Staying s, double* rest, Index count) {
    for_each_register(Leave{s, rest}, 0, count);
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace comminute::detail {

HWY_EXPORT(crush_arms);
HWY_EXPORT(leave);

Moved crush_arms(const Shell& shell, const Arm& first, const Arm& second, Index count) {
    return HWY_DYNAMIC_DISPATCH(crush_arms)(shell, first, second, count);
}
void leave(Staying s, double* rest, Index count) {
    HWY_DYNAMIC_DISPATCH(leave)(s, rest, count);
}

}  // namespace comminute::detail
#endif
