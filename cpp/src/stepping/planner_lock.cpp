// SPDX-License-Identifier: BSD-3-Clause
#include "stepping/planner_lock.hpp"

#include <mutex>

#include "comminute/error.hpp"
#include "comminute/full_convolution.hpp"

namespace comminute {

namespace {

std::mutex own_mutex;

struct Functions {
    void (*lock)(void*);
    void (*unlock)(void*);
    void* data;
};

constexpr Functions own{[](void*) { own_mutex.lock(); }, [](void*) { own_mutex.unlock(); }, nullptr};
Functions in_use = own;

}  // namespace

void set_fft_planner_lock(void (*lock)(void*), void (*unlock)(void*), void* data) {
    if ((lock == nullptr) != (unlock == nullptr)) {
        const bool no_lock = lock == nullptr;
        throw ParameterError({.parameter = no_lock ? "lock" : "unlock",
                              .value = "null",
                              .finding = no_lock ? "is null but unlock is not" : "is null but lock is not",
                              .rule = "give both, or neither"});
    }
    in_use = lock == nullptr ? own : Functions{lock, unlock, data};
}

namespace detail {

PlannerLock::PlannerLock() : unlock_(in_use.unlock), data_(in_use.data) {
    in_use.lock(data_);
}

PlannerLock::~PlannerLock() {
    unlock_(data_);
}

}  // namespace detail
}  // namespace comminute
