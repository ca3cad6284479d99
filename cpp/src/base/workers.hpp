// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>

namespace comminute::detail {

/// Calls work(index, ask) for index = 0 .. count - 1, at most `threads` at a time. The work asks `ask()` now and then
/// and returns early when the answer is false. `go_on` itself is only ever asked in the calling thread, since a
/// host's hook may not know of others; what it, or any work, throws is thrown here once all threads have stopped.
void for_each_index(std::size_t count, std::size_t threads,
                    const std::function<void(std::size_t, const std::function<bool()>&)>& work,
                    const std::function<bool()>& go_on);

}  // namespace comminute::detail
