// SPDX-License-Identifier: BSD-3-Clause
#include "simd/loops.hpp"

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/loops.cpp"
#include <hwy/foreach_target.h>

#include "simd/registers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

struct AddScaled {
    double factor;
    const double* from;
    double* to;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        hn::StoreU(hn::MulAdd(hn::Set(d, factor), hn::LoadU(d, from + k), hn::LoadU(d, to + k)), d, to + k);
    }
};
void add_scaled(double factor, const double* from, double* to, Index count) {
    for_each_register(AddScaled{factor, from, to}, 0, count);
}

double sum(const double* values, Index count) {
    constexpr Index registers = lanes / width;
    Numbers sums[registers];
    for (Numbers& s : sums) s = zero();
    Index k = 0;
    for (; k + lanes <= count; k += lanes) {
        for (Index v = 0; v < registers; ++v) sums[v] = hn::Add(sums[v], load(values + k + v * width));
    }
    double partial[lanes];
    for (Index v = 0; v < registers; ++v) store(sums[v], partial + v * width);
    for (; k < count; ++k) partial[k % lanes] += values[k];
    return ((partial[0] + partial[1]) + (partial[2] + partial[3])) +
           ((partial[4] + partial[5]) + (partial[6] + partial[7]));
}

// A finite number times 0 is 0 or -0, any other NaN, whose bits survive being or-ed together.
bool all_finite(const double* values, Index count) {
    Numbers bits = zero();
    Index k = 0;
    for (; k + width <= count; k += width) bits = hn::Or(bits, hn::Mul(zero(), load(values + k)));
    double rest = 0.0;
    for (; k < count; ++k) rest += 0.0 * values[k];
    return rest == 0.0 && hn::AllTrue(widest, hn::Eq(bits, zero()));
}

struct SettleRow {
    Landing landing;
    double* row;
    double* fines;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        const auto crushing = hn::LoadU(d, landing.crushing + k);
        const auto arrived = hn::Add(hn::LoadU(d, row + k), hn::LoadU(d, landing.arriving + k));
        hn::StoreU(hn::MulAdd(hn::Set(d, landing.stays), crushing, arrived), d, row + k);
        hn::StoreU(hn::MulAdd(hn::Set(d, landing.below), crushing, hn::LoadU(d, fines + k)), d, fines + k);
    }
};
void settle_row(Landing landing, double* row, double* fines, Index count) {
    for_each_register(SettleRow{landing, row, fines}, 0, count);
}

// Transposes a square of `Side` rows and columns, a register a row; a register of 8 is left to two of 4, which need two
// rounds of exchanges and no tables.
template <Index Side>
HWY_INLINE void transpose_square(const double* from, Index from_stride, double* to, Index to_stride) {
    if constexpr (Side == 1) {
        *to = *from;
    } else {
        constexpr Tag<Side> d{};
        hn::Vec<Tag<Side>> row[Side];
        for (Index r = 0; r < Side; ++r) row[r] = hn::LoadU(d, from + r * from_stride);
        for (Index r = 0; r < Side; r += 2) {
            const auto even = InterleaveLower(d, row[r], row[r + 1]);
            row[r + 1] = InterleaveUpper(d, row[r], row[r + 1]);
            row[r] = even;
        }
        if constexpr (Side == 4) {
            for (Index r = 0; r < 2; ++r) {
                const auto lower = ConcatLowerLower(d, row[r + 2], row[r]);
                row[r + 2] = ConcatUpperUpper(d, row[r + 2], row[r]);
                row[r] = lower;
            }
        }
        for (Index r = 0; r < Side; ++r) hn::StoreU(row[r], d, to + r * to_stride);
    }
}
void transpose(const double* from, Index from_stride, double* to, Index to_stride, Index size) {
    constexpr Index side = width < 4 ? width : 4;
    for (Index i = 0; i < size; i += side) {
        for (Index j = 0; j < size; j += side) {
            transpose_square<side>(from + i * from_stride + j, from_stride, to + j * to_stride + i,
                                   to_stride);
        }
    }
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace comminute::detail {

HWY_EXPORT(add_scaled);
HWY_EXPORT(sum);
HWY_EXPORT(all_finite);
HWY_EXPORT(settle_row);
HWY_EXPORT(transpose);

void add_scaled(double factor, const double* from, double* to, Index count) {
    HWY_DYNAMIC_DISPATCH(add_scaled)(factor, from, to, count);
}
double sum(const double* values, Index count) {
    return HWY_DYNAMIC_DISPATCH(sum)(values, count);
}
bool all_finite(const double* values, Index count) {
    return HWY_DYNAMIC_DISPATCH(all_finite)(values, count);
}
void settle_row(Landing landing, double* row, double* fines, Index count) {
    HWY_DYNAMIC_DISPATCH(settle_row)(landing, row, fines, count);
}
void transpose(const double* from, Index from_stride, double* to, Index to_stride, Index size) {
    HWY_DYNAMIC_DISPATCH(transpose)(from, from_stride, to, to_stride, size);
}

}  // namespace comminute::detail
#endif
