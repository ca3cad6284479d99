// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

namespace comminute::detail {

/// Counter-based random bits, Philox 2x64-10 (Salmon et al. 2011): a pure function of key and counter, so a draw
/// depends on its use and not on when, or in which thread, it is made.
inline std::array<std::uint64_t, 2> philox(std::uint64_t key, std::uint64_t low, std::uint64_t high) {
    for (int round = 0; round < 10; ++round) {
        __extension__ const auto product = static_cast<unsigned __int128>(low) * 0xD2B74407B1CE6E93U;
        low = static_cast<std::uint64_t>(product >> 64) ^ key ^ high;
        high = static_cast<std::uint64_t>(product);
        key += 0x9E3779B97F4A7C15U;
    }
    return {low, high};
}

/// Use of a random number; part of the counter, so that no two uses share a draw.
enum class Purpose : std::uint64_t {
    stream,
    start,
    fragment,
    tie,
    shuffle,
    decision,
    first_strength,
    strength,
    exchange,
    partner,
    clock
};

/// Random bits for place `where` (a cell) at instant `when` of one stream.
inline std::uint64_t random_bits(std::uint64_t stream, Purpose purpose, std::uint64_t where,
                                 std::uint64_t when) {
    return philox(stream, where | static_cast<std::uint64_t>(purpose) << 56, when)[0];
}

/// The same as a number in (0, 1): the centre of one of 2^52 equal intervals.
inline double random_uniform(std::uint64_t stream, Purpose purpose, std::uint64_t where, std::uint64_t when) {
    const auto bits = random_bits(stream, purpose, where, when) >> 12;
    return (static_cast<double>(bits) + 0.5) * 0x1p-52;
}

/// Random bits of equal quality for many places at one instant, at a fraction of the cost: the `where`-th number of a
/// SplitMix64 sequence (Steele et al. 2014) that begins at `origin`.
inline std::uint64_t random_key(std::uint64_t origin, std::uint64_t where) {
    std::uint64_t z = origin + (where + 1) * 0x9E3779B97F4A7C15U;
    z = (z ^ z >> 30) * 0xBF58476D1CE4E5B9U;
    z = (z ^ z >> 27) * 0x94D049BB133111EBU;
    return z ^ z >> 31;
}

}  // namespace comminute::detail
