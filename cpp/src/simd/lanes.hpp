// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>
#include <vector>

#include "comminute/view.hpp"
#include "simd/multiversion.hpp"

namespace comminute::detail {

/// Doubles in a cache line, and in the widest register that any of these loops uses. Tables are laid out in packs of as
/// many, whatever the registers at hand.
constexpr Index lanes = 8;

#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"  // of functions that hand vectors around: all are inlined
#endif

// NOLINTBEGIN(modernize-use-using): in a using clang drops the alignment
template <Index Width>
struct VectorTypes;
template <>
struct VectorTypes<2> {
    using Value = double __attribute__((vector_size(16)));
    typedef double Anywhere __attribute__((vector_size(16), aligned(8), may_alias));
};
template <>
struct VectorTypes<4> {
    using Value = double __attribute__((vector_size(32)));
    typedef double Anywhere __attribute__((vector_size(32), aligned(8), may_alias));
};
template <>
struct VectorTypes<8> {
    using Value = double __attribute__((vector_size(64)));
    typedef double Anywhere __attribute__((vector_size(64), aligned(8), may_alias));
};
// NOLINTEND(modernize-use-using)

/// Doubles side by side, 2, 4 or 8: as many as a register of the machine holds.
template <Index Width>
using Vector = typename VectorTypes<Width>::Value;

template <Index Width>
COMMINUTE_INLINE Vector<Width> load(const double* from) {
    return *reinterpret_cast<const typename VectorTypes<Width>::Anywhere*>(from);
}
template <Index Width>
COMMINUTE_INLINE void store(const Vector<Width>& vector, double* to) {
    *reinterpret_cast<typename VectorTypes<Width>::Anywhere*>(to) = vector;
}

/// Gives memory that begins with a cache line, so that packs in step with it never straddle two.
template <class T>
struct CacheLineAllocator {
    using value_type = T;
    static constexpr std::align_val_t line{64};

    CacheLineAllocator() = default;
    template <class U>
    CacheLineAllocator(const CacheLineAllocator<U>&) {}
    T* allocate(std::size_t n) { return static_cast<T*>(::operator new(n * sizeof(T), line)); }
    void deallocate(T* memory, std::size_t) { ::operator delete(memory, line); }
    friend bool operator==(const CacheLineAllocator&, const CacheLineAllocator&) { return true; }
};
using LaneVector = std::vector<double, CacheLineAllocator<double>>;

constexpr Index lanes_down(Index n) {
    return n / lanes * lanes;
}
constexpr Index lanes_up(Index n) {
    return lanes_down(n + lanes - 1);
}

/// Length for rows of a table that are read side by side: an odd number of cache lines, so that they do not all fall into
/// one set of the cache where N is a power of two.
constexpr Index row_stride(Index n) {
    return (lanes_up(n) / lanes | 1) * lanes;
}

}  // namespace comminute::detail
