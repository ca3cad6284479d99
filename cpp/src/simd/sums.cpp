// SPDX-License-Identifier: BSD-3-Clause
#include "simd/sums.hpp"

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/sums.cpp"
#include <hwy/foreach_target.h>

#include "simd/registers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

constexpr double negligible = 1e-290;  // denormal numbers would take a hundred times as long to add

// Registers at once, so that a term's weights are loaded once for all of them, and what arrives stays in registers. They
// begin with a pack, or lie in one.
template <Index Registers>
HWY_INLINE void advance_registers(const Falling& f, const double* enters, double* arriving, Index at) {
    Numbers enter[Registers];
    Numbers sum[Registers];
    for (Index v = 0; v < Registers; ++v) {
        enter[v] = load(enters + at + v * width);
        sum[v] = zero();
    }
    const Index terms = f.terms;
    const double* const weights = f.entering;
    const double* const decays = f.falling;
    double* sums = f.sums + lanes_down(at) * terms + at % lanes;
    for (Index a = 0; a < terms; ++a, sums += lanes) {
        const Numbers entering = all(weights[a]);  // here, lest they be loaded again after every store
        const Numbers falling = all(decays[a]);
        for (Index v = 0; v < Registers; ++v) {
            double* const line = sums + lanes_down(v * width) * terms + v * width % lanes;
            const Numbers now = hn::MulAdd(entering, enter[v], load(line));
            store(now, line);
            sum[v] = hn::MulAdd(falling, now, sum[v]);
        }
    }
    for (Index v = 0; v < Registers; ++v) store(sum[v], arriving + at + v * width);
}

void advance(const Falling& f, const double* enters, double* arriving, Index count) {
    Index k = 0;
    for (; k + 4 * width <= count; k += 4 * width) advance_registers<4>(f, enters, arriving, k);
    for (; k < count; k += lanes) advance_registers<lanes / width>(f, enters, arriving, k);
}

void decay(const double* factor, Index terms, double* sums, Index count) {
    for (Index k = 0; k < count; k += lanes) {
        for (Index a = 0; a < terms; ++a, sums += lanes) {
            for (Index l = 0; l < lanes; l += width) {
                const Numbers now = hn::Mul(load(sums + l), all(factor[a]));
                store(hn::IfThenElseZero(hn::Gt(hn::Abs(now), all(negligible)), now), sums + l);
            }
        }
    }
}

struct AddTerms {
    const double* factors;
    TermRows rows;
    Index terms;
    double* to;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        auto sum = hn::LoadU(d, to + k);
        const double* from = rows.first + k;
        for (Index a = 0; a < terms; ++a, from += rows.stride) {
            sum = hn::MulAdd(hn::Set(d, factors[a]), hn::LoadU(d, from), sum);
        }
        hn::StoreU(sum, d, to + k);
    }
};
void add_terms(const double* factors, TermRows rows, Index terms, double* to, Index count) {
    for_each_register(AddTerms{factors, rows, terms, to}, 0, count);
}

struct AddProducts {
    TermRows one;
    TermRows other;
    Index terms;
    double* to;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        auto sum = hn::LoadU(d, to + k);
        const double* from = one.first + k;
        const double* by = other.first + k;
        for (Index a = 0; a < terms; ++a, from += one.stride, by += other.stride) {
            sum = hn::MulAdd(hn::LoadU(d, from), hn::LoadU(d, by), sum);
        }
        hn::StoreU(sum, d, to + k);
    }
};
void add_products(TermRows one, TermRows other, Index terms, double* to, Index count) {
    for_each_register(AddProducts{one, other, terms, to}, 0, count);
}

template <Index Registers>
HWY_INLINE void add_to_rows_at(const Terms& of, const double* factors, Index terms, double* rows,
                               Index row_stride, Index at) {
    double* const row = rows + at;
    Numbers sum[rows_at_once][Registers];
    for (Index r = 0; r < rows_at_once; ++r) {
        for (Index v = 0; v < Registers; ++v) sum[r][v] = load(row + r * row_stride + v * width);
    }
    const double* line = of.lines + at / lanes * of.pack_stride + at % lanes;
    const Index pack_stride = of.pack_stride;
    const Index term_stride = of.term_stride;
    for (Index a = 0; a < terms; ++a, line += term_stride, factors += rows_at_once) {
        for (Index v = 0; v < Registers; ++v) {
            const Numbers by = load(line + v * width / lanes * pack_stride + v * width % lanes);
            for (Index r = 0; r < rows_at_once; ++r) sum[r][v] = hn::MulAdd(all(factors[r]), by, sum[r][v]);
        }
    }
    for (Index r = 0; r < rows_at_once; ++r) {
        for (Index v = 0; v < Registers; ++v) store(sum[r][v], row + r * row_stride + v * width);
    }
}

void add_to_rows(const Terms& of, const double* factors, Index terms, double* rows, Index row_stride,
                 Index count) {
    Index k = 0;
    for (; k + 2 * width <= count; k += 2 * width) {
        add_to_rows_at<2>(of, factors, terms, rows, row_stride, k);
    }
    if (k < count) add_to_rows_at<1>(of, factors, terms, rows, row_stride, k);
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace comminute::detail {

HWY_EXPORT(advance);
HWY_EXPORT(decay);
HWY_EXPORT(add_terms);
HWY_EXPORT(add_products);
HWY_EXPORT(add_to_rows);

void advance(const Falling& f, const double* enters, double* arriving, Index count) {
    HWY_DYNAMIC_DISPATCH(advance)(f, enters, arriving, count);
}
void decay(const double* factor, Index terms, double* sums, Index count) {
    HWY_DYNAMIC_DISPATCH(decay)(factor, terms, sums, count);
}
void add_terms(const double* factors, TermRows rows, Index terms, double* to, Index count) {
    HWY_DYNAMIC_DISPATCH(add_terms)(factors, rows, terms, to, count);
}
void add_products(TermRows one, TermRows other, Index terms, double* to, Index count) {
    HWY_DYNAMIC_DISPATCH(add_products)(one, other, terms, to, count);
}
void add_to_rows(const Terms& of, const double* factors, Index terms, double* rows, Index row_stride,
                 Index count) {
    HWY_DYNAMIC_DISPATCH(add_to_rows)(of, factors, terms, rows, row_stride, count);
}

}  // namespace comminute::detail
#endif
