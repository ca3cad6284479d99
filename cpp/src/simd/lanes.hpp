// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>

#include "base/arrays.hpp"
#include "comminute/view.hpp"

namespace comminute::detail {

/// Doubles in a cache line, and in the widest register that any of the vector loops uses. Tables are laid out in packs of
/// as many, whatever registers the machine has.
constexpr Index lanes = 8;

/// Allocator whose memory begins with a cache line, so that packs in step with it never straddle two.
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
/// Numbers in packs of lines, each pack a cache line.
using LaneArray = Array<double, CacheLineAllocator<double>>;

/// Largest multiple of `lanes` that is not above n.
constexpr Index lanes_down(Index n) {
    return n / lanes * lanes;
}
/// Smallest multiple of `lanes` that is not below n.
constexpr Index lanes_up(Index n) {
    return lanes_down(n + lanes - 1);
}

/// Length for rows of a table that are read side by side: an odd number of cache lines, so that they do not all fall into
/// one set of the cache where N is a power of two.
constexpr Index row_stride(Index n) {
    return (lanes_up(n) / lanes | 1) * lanes;
}

}  // namespace comminute::detail
