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
    const double* from;
    const double* total;
    SizeSums sums;
    double* to;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        const auto here = hn::LoadU(d, from + k);
        const auto others = hn::Max(hn::Sub(hn::LoadU(d, total + k), here), hn::Zero(d));
        auto arriving = hn::Mul(hn::Set(d, row.any), others);
        if (row.by_size) {
            const auto step = hn::Set(d, row.step);
            const auto mass = hn::LoadU(d, sums.mass + k);
            auto first = hn::LoadU(d, sums.first + k);
            const auto grown = hn::MulAdd(step, mass, hn::Add(first, first));
            const auto second = hn::MulAdd(step, grown, hn::LoadU(d, sums.second + k));
            first = hn::MulAdd(step, mass, first);
            arriving = hn::MulAdd(hn::Set(d, row.linear), first, arriving);
            arriving = hn::NegMulAdd(hn::Set(d, row.square), second, arriving);
            hn::StoreU(hn::Add(mass, here), d, sums.mass + k);
            hn::StoreU(first, d, sums.first + k);
            hn::StoreU(second, d, sums.second + k);
        }
        hn::StoreU(arriving, d, to + k);
    }
};
void arrive(const ArrivalRow& row, const double* from, const double* total, const SizeSums& sums, double* to,
            Index count) {
    for_each_register(Arrive{row, from, total, sums, to}, 0, count);
}

struct AddTo {
    const double* from;
    double* to;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        hn::StoreU(hn::Add(hn::LoadU(d, to + k), hn::LoadU(d, from + k)), d, to + k);
    }
};
void sum_columns(const double* table, double* sums, Index nodes, Index stride) {
    for (Index r = 0; r < nodes; ++r) for_each_register(AddTo{table + r * stride, sums}, 0, stride);
}

void arrive_rows(const ArrivalRow* rows, const Index* order, const double* from, double* sums, double* to,
                 Index nodes, Index stride) {
    for (Index k = 0; k < 4 * stride; k += width) store(zero(), sums + k);
    sum_columns(from, sums, nodes, stride);
    const SizeSums running{sums + stride, sums + 2 * stride, sums + 3 * stride};
    for (Index k = 0; k < nodes; ++k) {
        const Index r = order[k];
        for_each_register(Arrive{rows[r], from + r * stride, sums, running, to + r * stride}, 0, stride);
    }
}

struct ExchangeRow {
    const ExchangedCentre& of;
    Index row;
    double left_stays;
    template <class D>
    HWY_INLINE void operator()(D d, Index c) const {
        const Index k = row + c;
        const auto stays = hn::LoadU(d, of.stays + c);
        const auto centre_stays = hn::Set(d, of.centre_stays);
        const auto left = hn::Set(d, left_stays);
        const auto active = hn::LoadU(d, of.active + k);
        const auto at_rest = hn::Sub(hn::Set(d, 1.0), active);
        const auto old = hn::Mul(hn::Mul(centre_stays, left), stays);
        auto several = hn::MulAdd(stays, hn::LoadU(d, of.both + k), hn::LoadU(d, of.all + k));
        several = hn::MulAdd(left, hn::LoadU(d, of.both_turned + k), several);
        several = hn::MulAdd(centre_stays, hn::LoadU(d, of.sides + k), several);
        const auto new_centre = hn::Mul(hn::Mul(left, stays), hn::LoadU(d, of.centre + k));
        const auto new_left = hn::Mul(hn::Mul(centre_stays, stays), hn::LoadU(d, of.left + k));
        const auto settled = hn::Mul(hn::LoadU(d, of.settled[0] + k), old);
        const auto pending = hn::Mul(hn::LoadU(d, of.pending[0] + k), old);
        hn::StoreU(hn::MulAdd(at_rest, several, settled), d, of.settled[0] + k);
        hn::StoreU(hn::MulAdd(active, several, pending), d, of.pending[0] + k);
        hn::StoreU(hn::Mul(at_rest, new_centre), d, of.settled[1] + k);
        hn::StoreU(hn::Mul(active, new_centre), d, of.pending[1] + k);
        hn::StoreU(hn::Mul(at_rest, new_left), d, of.settled[2] + k);
        hn::StoreU(hn::Mul(active, new_left), d, of.pending[2] + k);
    }
};
void exchange_centre(const ExchangedCentre& centre, Index nodes, Index stride) {
    for (Index a = 0; a < nodes; ++a)
        for_each_register(ExchangeRow{centre, a * stride, centre.stays[a]}, 0, stride);
}

void sum_rows(const double* table, double* sums, Index nodes, Index stride) {
    for (Index r = 0; r < nodes; ++r) {
        Numbers sum = load(table + r * stride);
        for (Index k = width; k < stride; k += width) sum = hn::Add(sum, load(table + r * stride + k));
        sums[r] += sum_of(sum);
    }
}

struct ReplaceSides {
    const ReplacedSides& of;
    double* settled;
    Index row;
    double left;
    template <class D>
    HWY_INLINE void operator()(D d, Index c) const {
        const Index k = row + c;
        const auto one = hn::Set(d, 1.0);
        const auto stays = hn::Sub(one, hn::Add(hn::Set(d, left), hn::LoadU(d, of.right + c)));
        const auto at_rest = hn::Sub(one, hn::LoadU(d, of.active + k));
        const auto arriving = hn::Mul(at_rest, hn::LoadU(d, of.arriving + k));
        hn::StoreU(hn::MulAdd(hn::LoadU(d, settled + k), stays, arriving), d, settled + k);
    }
};
void replace_sides(const ReplacedSides& sides, double* settled, Index nodes, Index stride) {
    for (Index a = 0; a < nodes; ++a)
        for_each_register(ReplaceSides{sides, settled, a * stride, sides.left[a]}, 0, stride);
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace comminute::detail {

HWY_EXPORT(arrive);
HWY_EXPORT(arrive_rows);
HWY_EXPORT(exchange_centre);
HWY_EXPORT(sum_rows);
HWY_EXPORT(sum_columns);
HWY_EXPORT(replace_sides);

void arrive(const ArrivalRow& row, const double* from, const double* total, const SizeSums& sums, double* to,
            Index count) {
    HWY_DYNAMIC_DISPATCH(arrive)(row, from, total, sums, to, count);
}
void arrive_rows(const ArrivalRow* rows, const Index* order, const double* from, double* sums, double* to,
                 Index nodes, Index stride) {
    HWY_DYNAMIC_DISPATCH(arrive_rows)(rows, order, from, sums, to, nodes, stride);
}
void exchange_centre(const ExchangedCentre& centre, Index nodes, Index stride) {
    HWY_DYNAMIC_DISPATCH(exchange_centre)(centre, nodes, stride);
}
void sum_rows(const double* table, double* sums, Index nodes, Index stride) {
    HWY_DYNAMIC_DISPATCH(sum_rows)(table, sums, nodes, stride);
}
void sum_columns(const double* table, double* sums, Index nodes, Index stride) {
    HWY_DYNAMIC_DISPATCH(sum_columns)(table, sums, nodes, stride);
}
void replace_sides(const ReplacedSides& sides, double* settled, Index nodes, Index stride) {
    HWY_DYNAMIC_DISPATCH(replace_sides)(sides, settled, nodes, stride);
}

}  // namespace comminute::detail
#endif
