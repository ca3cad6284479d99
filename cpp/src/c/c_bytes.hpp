// SPDX-License-Identifier: BSD-3-Clause
// Bytes into a buffer of a caller in C.
#pragma once

#include <algorithm>
#include <vector>

#include "c/c_call.hpp"

namespace comminute::detail {

/// Says how many bytes there are, and copies them where there is a buffer that holds them.
inline int give_bytes(const std::vector<unsigned char>& from, unsigned char* bytes, std::size_t count,
                      std::size_t* needed) {
    if (needed != nullptr) *needed = from.size();
    if (bytes == nullptr) {
        known(needed, "needed");
        return COMMINUTE_OK;
    }
    if (count < from.size()) {
        throw ShapeError({.parameter = "bytes",
                          .value = std::to_string(count),
                          .number = static_cast<double>(count),
                          .finding = "has room for " + std::to_string(count),
                          .rule = std::to_string(from.size()) + " are needed"});
    }
    std::copy(from.begin(), from.end(), bytes);
    return COMMINUTE_OK;
}

}  // namespace comminute::detail
