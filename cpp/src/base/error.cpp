// SPDX-License-Identifier: BSD-3-Clause
#include "comminute/error.hpp"

#include <array>
#include <charconv>

namespace comminute {

std::string text(double value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return {digits.data(), end};
}

std::string rounded(double value) {
    std::array<char, 32> digits{};
    const auto end =
        std::to_chars(digits.data(), digits.data() + digits.size(), value, std::chars_format::general, 6).ptr;
    return {digits.data(), end};
}

void require(bool ok, const char* parameter, double value, const char* rule) {
    if (ok) return;
    throw ParameterError(std::string(parameter) + " is " + text(value) + "; it must be " + rule);
}

}  // namespace comminute
