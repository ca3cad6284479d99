// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace support {

/// Number of times that this program has asked for memory by operator new.
long long allocations();

}  // namespace support
