// SPDX-License-Identifier: BSD-3-Clause
// Highway's registers of doubles by their width. Included once per instruction set, by the .cpp files of this folder,
// hence the unusual guard.
#if defined(COMMINUTE_REGISTERS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef COMMINUTE_REGISTERS_INL
#undef COMMINUTE_REGISTERS_INL
#else
#define COMMINUTE_REGISTERS_INL
#endif

#include <hwy/highway.h>

#include "simd/lanes.hpp"

HWY_BEFORE_NAMESPACE();
namespace comminute::detail::HWY_NAMESPACE {

// Operations that move numbers about within a register are called without this prefix, in templates: an instruction set
// whose registers hold one number has none of them, and an argument's type finds them where they exist.
namespace hn = hwy::HWY_NAMESPACE;

/// Tag of a register of `Width` doubles, or of the machine's widest one where that holds fewer.
template <Index Width>
using Tag = hn::CappedTag<double, static_cast<std::size_t>(Width)>;

/// Doubles in the widest register of this instruction set, at most a pack.
constexpr Index width = static_cast<Index>(hn::MaxLanes(Tag<lanes>()));
static_assert(lanes % width == 0);

using Numbers = hn::Vec<Tag<lanes>>;
constexpr Tag<lanes> widest{};

HWY_INLINE Numbers load(const double* from) {
    return hn::LoadU(widest, from);
}
HWY_INLINE void store(Numbers numbers, double* to) {
    hn::StoreU(numbers, widest, to);
}
HWY_INLINE Numbers all(double value) {
    return hn::Set(widest, value);
}
HWY_INLINE Numbers zero() {
    return hn::Zero(widest);
}

/// Calls loop(tag, k) for registers that cover [k, count): the widest ones first, and at the end, where less than one is
/// left, ones of half, a quarter and an eighth of its width.
template <Index Width = width, class Loop>
HWY_INLINE void for_each_register(const Loop& loop, Index k, Index count) {
    for (; k + Width <= count; k += Width) loop(Tag<Width>(), k);
    if constexpr (Width > 1) {
        if (k < count) for_each_register<Width / 2>(loop, k, count);
    }
}

HWY_INLINE double sum_of(Numbers numbers) {
    return hn::GetLane(hn::SumOfLanes(widest, numbers));
}

}  // namespace comminute::detail::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
