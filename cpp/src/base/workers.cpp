// SPDX-License-Identifier: BSD-3-Clause
#include "base/workers.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

namespace comminute::detail {
namespace {

void one_after_another(std::size_t count,
                       const std::function<void(std::size_t, const std::function<bool()>&)>& work,
                       const std::function<bool()>& go_on) {
    bool stopped = false;
    const std::function<bool()> ask = [&] {
        if (!stopped && go_on && !go_on()) stopped = true;
        return !stopped;
    };
    for (std::size_t index = 0; index < count && !stopped; ++index) work(index, ask);
}

}  // namespace

void for_each_index(std::size_t count, std::size_t threads,
                    const std::function<void(std::size_t, const std::function<bool()>&)>& work,
                    const std::function<bool()>& go_on) {
    threads = std::min(threads, count);
    if (threads <= 1) {
        one_after_another(count, work, go_on);
        return;
    }
    std::atomic<std::size_t> next{0};
    std::atomic<bool> stopped{false};
    std::mutex mutex;
    std::condition_variable ended;
    std::size_t running = threads;
    std::exception_ptr failure;
    const std::function<bool()> ask = [&] { return !stopped.load(std::memory_order_relaxed); };
    const auto keep = [&](std::exception_ptr thrown) {
        const std::lock_guard lock(mutex);
        if (!failure) failure = std::move(thrown);
        stopped = true;
    };
    const auto worker = [&] {
        try {
            for (std::size_t index = next++; index < count && !stopped; index = next++) work(index, ask);
        } catch (...) {
            keep(std::current_exception());
        }
        const std::lock_guard lock(mutex);
        --running;
        ended.notify_one();
    };
    std::vector<std::thread> pool;
    pool.reserve(threads);
    for (std::size_t t = 0; t < threads; ++t) pool.emplace_back(worker);
    std::unique_lock lock(mutex);
    while (!ended.wait_for(lock, std::chrono::milliseconds(20), [&] { return running == 0; })) {
        if (!go_on || stopped) continue;
        lock.unlock();
        try {
            if (!go_on()) stopped = true;
        } catch (...) {
            keep(std::current_exception());
        }
        lock.lock();
    }
    lock.unlock();
    for (auto& thread : pool) thread.join();
    if (failure) std::rethrow_exception(failure);
}

}  // namespace comminute::detail
