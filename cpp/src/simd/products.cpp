// SPDX-License-Identifier: BSD-3-Clause
#include "simd/products.hpp"

#include <algorithm>

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/products.cpp"
#include <hwy/foreach_target.h>

#include "simd/registers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

// A block of Rows rows and one pack of columns stays in registers while the terms go by.
template <Index Rows>
HWY_INLINE void multiply_block(const LowerProduct& p, Index row, Index column, Index first_term, double* to) {
    constexpr Index registers = lanes / width;
    Numbers sums[Rows][registers];
    for (auto& of_row : sums) {
        for (Numbers& s : of_row) s = zero();
    }
    const double* from = p.from + row * p.stride;
    for (Index t = first_term; t < p.terms; ++t) {
        const double* factor = p.factor + t * p.stride + column;
        Numbers factors[registers];
        for (Index v = 0; v < registers; ++v) factors[v] = load(factor + v * width);
        for (Index r = 0; r < Rows; ++r) {
            const Numbers mass = all(from[r * p.stride + t]);
            for (Index v = 0; v < registers; ++v) sums[r][v] = hn::MulAdd(mass, factors[v], sums[r][v]);
        }
    }
    for (Index r = 0; r < Rows; ++r) {
        for (Index v = 0; v < registers; ++v) {
            store(sums[r][v], to + (row + r) * p.stride + column + v * width);
        }
    }
}

// Four rows of eight doubles fill half of AVX2's sixteen registers and a quarter of AVX-512's.
void multiply_lower(const LowerProduct& p, double* to, Index rows) {
    constexpr Index at_once = 4;
    const Index end = p.terms > 0 ? p.column[p.terms - 1] + 1 : 0;
    Index first_term = 0;
    for (Index column = 0; column < p.stride; column += lanes) {
        while (first_term < p.terms && p.column[first_term] < column) ++first_term;
        if (column >= end) {
            for (Index z = 0; z < rows; ++z) {
                for (Index v = 0; v < lanes; v += width) store(zero(), to + z * p.stride + column + v);
            }
            continue;
        }
        Index z = 0;
        for (; z + at_once <= rows; z += at_once) multiply_block<at_once>(p, z, column, first_term, to);
        for (; z < rows; ++z) multiply_block<1>(p, z, column, first_term, to);
    }
}

struct ReplaceNeighbours {
    double left;
    const double* leaves;
    const double* arriving;
    double* row;
    template <class D>
    HWY_INLINE void operator()(D d, Index k) const {
        const auto gone = hn::Add(hn::Set(d, left), hn::LoadU(d, leaves + k));
        const auto share = hn::Sub(hn::Set(d, 1.0), gone);
        hn::StoreU(hn::MulAdd(hn::LoadU(d, row + k), share, hn::LoadU(d, arriving + k)), d, row + k);
    }
};
void replace_neighbours(double left, const double* leaves, const double* arriving, double* row, Index count) {
    for_each_register(ReplaceNeighbours{left, leaves, arriving, row}, 0, count);
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include "simd/loops.hpp"

namespace comminute::detail {

HWY_EXPORT(multiply_lower);
HWY_EXPORT(replace_neighbours);

void multiply_lower(const LowerProduct& product, double* to, Index rows) {
    HWY_DYNAMIC_DISPATCH(multiply_lower)(product, to, rows);
}
void replace_neighbours(double left, const double* leaves, const double* arriving, double* row, Index count) {
    HWY_DYNAMIC_DISPATCH(replace_neighbours)(left, leaves, arriving, row, count);
}

void add_transposed(double* table, Index stride, Index size) {
    double turned[lanes * lanes];
    for (Index i = 0; i < size; i += lanes) {
        for (Index j = 0; j <= i; j += lanes) {
            double* lower = table + i * stride + j;
            double* upper = table + j * stride + i;
            transpose(upper, stride, turned, lanes);  // turned[r, c] = upper[c, r]
            for (Index r = 0; r < lanes; ++r) {
                for (Index c = 0; c < lanes; ++c) lower[r * stride + c] += turned[r * lanes + c];
            }
            if (i != j) transpose(lower, stride, upper, stride);
        }
    }
}

}  // namespace comminute::detail
#endif
