// SPDX-License-Identifier: BSD-3-Clause
#include "simd/pairs.hpp"

#include "simd/targets.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/pairs.cpp"
#include <hwy/foreach_target.h>

#include "simd/registers-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

// One complex number.
HWY_INLINE void multiply_one(double* z, const double* by) {
    const double re = z[0];
    const double im = z[1];
    z[0] = re * by[0] - im * by[1];
    z[1] = re * by[1] + im * by[0];
}

// (re + im i) by = re by + im (i by).
template <class D>
HWY_INLINE void multiply_by(D d, double* z, const double* by, Index count) {
    constexpr auto each = static_cast<Index>(hn::MaxLanes(D()));
    Index k = 0;
    if constexpr (each > 1) {
        const auto minus = OddEven(hn::Zero(d), hn::Set(d, -0.0));  // the sign of the even numbers
        for (; k + each <= 2 * count; k += each) {
            const auto number = hn::LoadU(d, z + k);
            const auto factor = hn::LoadU(d, by + k);
            const auto turned = hn::Xor(hn::Reverse2(d, factor), minus);
            hn::StoreU(hn::MulAdd(hn::DupEven(number), factor, hn::Mul(DupOdd(number), turned)), d, z + k);
        }
    }
    for (; k < 2 * count; k += 2) multiply_one(z + k, by + k);
}
void multiply(double* z, const double* by, Index count) {
    multiply_by(widest, z, by, count);
}

std::array<double, 2> keep_positive(double* pair, Index coarsest, std::array<double, 2> factor) {
    constexpr Index registers = lanes / width;
    double pattern[lanes];
    for (std::size_t l = 0; l < lanes; ++l) pattern[l] = factor[l % 2];
    Numbers factors[registers];
    Numbers sums[registers];
    for (Index v = 0; v < registers; ++v) {
        factors[v] = load(pattern + v * width);
        sums[v] = zero();
    }
    const Index end = 2 * (coarsest + 1);
    Index k = 2;
    for (; k + lanes <= end; k += lanes) {
        for (Index v = 0; v < registers; ++v) {
            const Numbers product = hn::Mul(load(pair + k + v * width), factors[v]);
            const Numbers kept = hn::IfThenZeroElse(hn::Lt(product, zero()), product);
            store(kept, pair + k + v * width);
            sums[v] = hn::Add(sums[v], kept);
        }
    }
    double partial[lanes];
    for (Index v = 0; v < registers; ++v) store(sums[v], partial + v * width);
    for (; k < end; ++k) {
        const double product = pair[k] * factor[static_cast<std::size_t>(k % 2)];
        pair[k] = product < 0.0 ? 0.0 : product;
        partial[k % 2] += pair[k];
    }
    return {(partial[0] + partial[2]) + (partial[4] + partial[6]),
            (partial[1] + partial[3]) + (partial[5] + partial[7])};
}

template <class D>
HWY_INLINE void add_line_by(D d, const double* line, double* to, Index bins) {
    constexpr auto each = static_cast<Index>(hn::MaxLanes(D()));
    Index i = 0;
    if constexpr (each > 1) {
        for (; i + each < bins; i += each) {  // the last number of all is this line's, not the other's
            const auto numbers = ConcatEven(d, hn::LoadU(d, line + 2 * i + each), hn::LoadU(d, line + 2 * i));
            hn::StoreU(hn::Add(hn::LoadU(d, to + i), numbers), d, to + i);
        }
    }
    for (; i < bins; ++i) to[i] += line[2 * i];
}
void add_line(const double* line, double* to, Index bins) {
    add_line_by(widest, line, to, bins);
}

// A number of each of a pair's two lines at once, where registers hold two.
constexpr Tag<2> bin_of_pair{};
constexpr auto bin_width = static_cast<Index>(hn::MaxLanes(bin_of_pair));

void gather_columns(const double* columns, Index stride, Index rows, double* pairs, Index distance,
                    double* pushed) {
    constexpr Index registers = lanes / bin_width;
    hn::Vec<Tag<2>> sums[registers];
    for (Index v = 0; v < registers; ++v) sums[v] = hn::LoadU(bin_of_pair, pushed + v * bin_width);
    for (Index i = 0; i < rows; ++i) {
        const double* from = columns + i * stride;
        for (Index v = 0; v < registers; ++v) {
            const Index c = v * bin_width;
            const auto numbers = hn::LoadU(bin_of_pair, from + c);
            hn::StoreU(numbers, bin_of_pair, pairs + c / 2 * distance + 2 * i + c % 2);
            sums[v] = hn::Add(sums[v], numbers);
        }
    }
    for (Index v = 0; v < registers; ++v) hn::StoreU(sums[v], bin_of_pair, pushed + v * bin_width);
}

void add_columns(const double* pairs, Index distance, Index rows, MatrixView<double> out, Index begin) {
    if (begin + lanes > out.cols()) {
        for (Index c = 0; begin + c < out.cols(); ++c) {
            const double* line = pairs + c / 2 * distance + c % 2;
            for (Index i = 0; i < rows; ++i) out(i, begin + c) += line[2 * i];
        }
        return;
    }
    for (Index i = 0; i < rows; ++i) {
        double* to = out.row(i) + begin;
        for (Index c = 0; c < lanes; c += bin_width) {
            const auto numbers = hn::LoadU(bin_of_pair, pairs + c / 2 * distance + 2 * i + c % 2);
            hn::StoreU(hn::Add(hn::LoadU(bin_of_pair, to + c), numbers), bin_of_pair, to + c);
        }
    }
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace comminute::detail {

HWY_EXPORT(multiply);
HWY_EXPORT(keep_positive);
HWY_EXPORT(add_line);
HWY_EXPORT(gather_columns);
HWY_EXPORT(add_columns);

void multiply(double* z, const double* by, Index count) {
    HWY_DYNAMIC_DISPATCH(multiply)(z, by, count);
}
std::array<double, 2> keep_positive(double* pair, Index coarsest, std::array<double, 2> factor) {
    return HWY_DYNAMIC_DISPATCH(keep_positive)(pair, coarsest, factor);
}
void add_line(const double* line, double* to, Index bins) {
    HWY_DYNAMIC_DISPATCH(add_line)(line, to, bins);
}
void gather_columns(const double* columns, Index stride, Index rows, double* pairs, Index distance,
                    double* pushed) {
    HWY_DYNAMIC_DISPATCH(gather_columns)(columns, stride, rows, pairs, distance, pushed);
}
void add_columns(const double* pairs, Index distance, Index rows, MatrixView<double> out, Index begin) {
    HWY_DYNAMIC_DISPATCH(add_columns)(pairs, distance, rows, out, begin);
}

}  // namespace comminute::detail
#endif
