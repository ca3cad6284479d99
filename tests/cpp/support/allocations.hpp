// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace support {

/// One where the compiler optimises; where it does not, long loops are shortened by it.
#ifdef __OPTIMIZE__
constexpr int shortened = 1;
#else
constexpr int shortened = 20;
#endif

/// Number of times that this program has asked for memory by operator new.
long long allocations();

}  // namespace support
