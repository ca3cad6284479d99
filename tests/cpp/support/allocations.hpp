// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace support {

/// One in an optimised build; in others, and under sanitizers, long loops are shortened by it.
#if defined(__OPTIMIZE__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
constexpr int shortened = 1;
#else
constexpr int shortened = 20;
#endif

/// Number of times that this program has asked for memory by operator new.
long long allocations();

}  // namespace support
