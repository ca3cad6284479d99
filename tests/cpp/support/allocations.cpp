// SPDX-License-Identifier: BSD-3-Clause
// Operators new that count, for tests of loops that may not ask for memory.
#include "support/allocations.hpp"

#include <atomic>
#include <cstdlib>
#include <new>

namespace {

std::atomic<long long> count{0};

void* counted(void* memory) {
    if (memory == nullptr) throw std::bad_alloc();
    ++count;
    return memory;
}

std::size_t whole_lines(std::size_t size, std::size_t line) {
    return (size + line - 1) / line * line;
}

}  // namespace

long long support::allocations() {
    return count;
}

void* operator new(std::size_t size) {
    return counted(std::malloc(size > 0 ? size : 1));
}
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
    ++count;
    return std::malloc(size > 0 ? size : 1);
}
void* operator new(std::size_t size, std::align_val_t align) {
    const auto line = static_cast<std::size_t>(align);
    return counted(std::aligned_alloc(line, whole_lines(size > 0 ? size : 1, line)));
}
void operator delete(void* memory) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
    std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
    std::free(memory);
}
