// SPDX-License-Identifier: BSD-3-Clause
#include "simd/transport.hpp"

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/transport.cpp"
#include <hwy/foreach_target.h>

#include "simd/registers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

// Sum of (s - s_i)^2 m over sizes beyond s_i follows from that of the size before, a step d nearer to them: it grows by
// d (2 first + d mass), and first by d mass.
struct Arrive {
    ArrivalRow row;
    SizeSums sums;
    double* to;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        const auto from = hn::LoadU(d, row.from + k);
        const auto others = hn::Max(hn::Sub(hn::LoadU(d, row.total + k), from), hn::Zero(d));
        auto arriving = hn::Mul(hn::Set(d, row.any), others);
        if (row.linear != 0.0) {
            const auto step = hn::Set(d, row.step);
            const auto mass = hn::LoadU(d, sums.mass + k);
            auto first = hn::LoadU(d, sums.first + k);
            const auto grown = hn::MulAdd(step, mass, hn::Add(first, first));
            const auto second = hn::MulAdd(step, grown, hn::LoadU(d, sums.second + k));
            first = hn::MulAdd(step, mass, first);
            arriving = hn::MulAdd(hn::Set(d, row.linear), first, arriving);
            arriving = hn::NegMulAdd(hn::Set(d, row.square), second, arriving);
            hn::StoreU(hn::Add(mass, from), d, sums.mass + k);
            hn::StoreU(first, d, sums.first + k);
            hn::StoreU(second, d, sums.second + k);
        }
        hn::StoreU(arriving, d, to + k);
    }
};
void arrive(const ArrivalRow& row, const SizeSums& sums, double* to, Index count) {
    for_each_register(Arrive{row, sums, to}, 0, count);
}

struct ExchangeRow {
    ExchangedRow row;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        const auto stays = hn::LoadU(d, row.stays + k);
        const auto centre_stays = hn::Set(d, row.centre_stays);
        const auto left_stays = hn::Set(d, row.left_stays);
        const auto active = hn::LoadU(d, row.active + k);
        const auto at_rest = hn::Sub(hn::Set(d, 1.0), active);
        const auto old = hn::Mul(hn::Mul(centre_stays, left_stays), stays);
        auto several = hn::MulAdd(stays, hn::LoadU(d, row.both + k), hn::LoadU(d, row.all + k));
        several = hn::MulAdd(left_stays, hn::LoadU(d, row.both_turned + k), several);
        several = hn::MulAdd(centre_stays, hn::LoadU(d, row.sides + k), several);
        const auto centre = hn::Mul(hn::Mul(left_stays, stays), hn::LoadU(d, row.centre + k));
        const auto left = hn::Mul(hn::Mul(centre_stays, stays), hn::LoadU(d, row.left + k));
        const auto settled = hn::Mul(hn::LoadU(d, row.settled[0] + k), old);
        const auto pending = hn::Mul(hn::LoadU(d, row.pending[0] + k), old);
        hn::StoreU(hn::MulAdd(at_rest, several, settled), d, row.settled[0] + k);
        hn::StoreU(hn::MulAdd(active, several, pending), d, row.pending[0] + k);
        hn::StoreU(hn::Mul(at_rest, centre), d, row.settled[1] + k);
        hn::StoreU(hn::Mul(active, centre), d, row.pending[1] + k);
        hn::StoreU(hn::Mul(at_rest, left), d, row.settled[2] + k);
        hn::StoreU(hn::Mul(active, left), d, row.pending[2] + k);
    }
};
void exchange_row(const ExchangedRow& row, Index count) {
    for_each_register(ExchangeRow{row}, 0, count);
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace comminute::detail {

HWY_EXPORT(arrive);
HWY_EXPORT(exchange_row);

void arrive(const ArrivalRow& row, const SizeSums& sums, double* to, Index count) {
    HWY_DYNAMIC_DISPATCH(arrive)(row, sums, to, count);
}
void exchange_row(const ExchangedRow& row, Index count) {
    HWY_DYNAMIC_DISPATCH(exchange_row)(row, count);
}

}  // namespace comminute::detail
#endif
