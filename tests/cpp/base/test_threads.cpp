// SPDX-License-Identifier: BSD-3-Clause
#include <doctest/doctest.h>

#include <thread>
#ifdef COMMINUTE_HAS_FFTW
#include <fftw3.h>

#include <cstdlib>
#include <mutex>
#include <set>
#include <sstream>
#include <string>
#endif

#include "support/helpers.hpp"

using comminute::Fabric;
using comminute::FullConvolution;
using comminute::Kernel;
using comminute::KernelKind;
using comminute::LogGrid;
using comminute::Scheme;
using comminute::SlowUpdate;
using comminute::StepPath;
using helpers::at;
using helpers::Index;
using helpers::material;
using helpers::State;

namespace {

constexpr std::size_t thread_count = 4;

// Runs work(0) .. work(3) on four threads at once; each keeps to its own slot of whatever it writes.
template <class F>
void at_once(const F& work) {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < thread_count; ++t) threads.emplace_back([&work, t] { work(t); });
    for (std::thread& thread : threads) thread.join();
}

template <class E>
void load_to(E& engine, State& p, double largest) {
    for (double stress_ratio = 0.5; stress_ratio < largest; stress_ratio *= 1.7) {
        engine.step(p.view(), stress_ratio, p.view());
    }
}

}  // namespace

TEST_CASE("slow updates on several threads give the bits of a serial run") {
    std::mt19937_64 random(51);
    const State start = helpers::random_state(80, random);
    std::vector<State> result(thread_count, start);
    at_once([&](std::size_t t) {
        SlowUpdate engine(LogGrid(-4.0, 0.2, 80), material(0.3), {Scheme::paper});
        load_to(engine, result[t], 1e3);
    });
    State serial = start;
    SlowUpdate engine(LogGrid(-4.0, 0.2, 80), material(0.3), {Scheme::paper});
    load_to(engine, serial, 1e3);
    for (const State& p : result) CHECK(p.mass == serial.mass);
}

TEST_CASE("one kernel may be read by several threads") {
    for (const KernelKind kind : {KernelKind::exact, KernelKind::slow, KernelKind::fast}) {
        const Kernel kernel(LogGrid(-4.0, 0.2, 40), material(0.3), {kind, 0.0, Scheme::paper});
        std::vector<State> result(thread_count, State(40));
        at_once([&](std::size_t t) {
            for (Index i = 39; i > 20; --i) kernel.cell(i, 39, 50.0, result[t].view());
        });
        State serial(40);
        kernel.cell(21, 39, 50.0, serial.view());
        for (const State& out : result) CHECK(out.mass == serial.mass);
    }
}

TEST_CASE("a fabric is copied, read and remixed on several threads") {
    std::mt19937_64 random(52);
    const LogGrid grid(-4.0, 0.2, 48);
    const Fabric shared(grid, helpers::random_state(48, random).mass, {}, 3.0);
    const Fabric serial = comminute::remix(shared);
    std::vector<std::vector<Fabric>> remixed(thread_count);
    std::vector<int> same(thread_count, 0);
    at_once([&](std::size_t t) {
        for (int repeat = 0; repeat < 20; ++repeat) {
            const Fabric copy = shared;
            same[t] += copy == shared && copy.probability().data() == shared.probability().data() ? 1 : 0;
            remixed[t].push_back(comminute::remix(copy));
        }
    });
    for (std::size_t t = 0; t < thread_count; ++t) {
        CHECK(same[t] == 20);
        for (const Fabric& fabric : remixed[t]) CHECK(fabric == serial);
    }
}

#ifdef COMMINUTE_HAS_FFTW

TEST_CASE("full convolutions and copies of one on several threads give the bits of a serial run") {
    std::mt19937_64 random(53);
    const State start = helpers::random_state(80, random);
    for (const KernelKind kind : {KernelKind::exact, KernelKind::slow, KernelKind::fast, KernelKind::blend}) {
        const comminute::KernelOptions kernel{kind, kind == KernelKind::blend ? 0.4 : 0.0, Scheme::paper};
        for (const StepPath path : {StepPath::automatic, StepPath::transforms}) {
            const LogGrid grid(-4.0, 0.2, 80);
            FullConvolution engine(grid, material(0.3), {kernel, path});
            std::vector<State> result(thread_count, start);
            at_once([&](std::size_t t) {
                FullConvolution own =
                    t % 2 == 0 ? FullConvolution(grid, material(0.3), {kernel, path}) : engine;
                load_to(own, result[t], 1e3);
            });
            State serial = start;
            load_to(engine, serial, 1e3);
            for (const State& p : result) CHECK(p.mass == serial.mass);
        }
    }
}

TEST_CASE("full convolutions are made, used, moved and dropped at the same time on several threads") {
    const auto run = [](Index bins) {
        const auto effort = bins % 12 == 0 ? comminute::PlanEffort::measure : comminute::PlanEffort::estimate;
        FullConvolution first(LogGrid(-3.0, 0.0, bins), material(0.3),
                              {{KernelKind::slow, 0.0, Scheme::paper}, StepPath::transforms, effort});
        FullConvolution engine(std::move(first));
        State p(bins);
        p(bins - 1, bins - 1) = 1.0;
        comminute::settle(engine, p.view(), 20.0);
        return p;
    };
    const auto bins_of = [](std::size_t t, int repeat) { return static_cast<Index>(8 + 3 * t) + repeat; };
    std::vector<std::vector<State>> result(thread_count);
    at_once([&](std::size_t t) {
        for (int repeat = 0; repeat < 12; ++repeat) result[t].push_back(run(bins_of(t, repeat)));
    });
    for (std::size_t t = 0; t < thread_count; ++t) {
        for (int repeat = 0; repeat < 12; ++repeat) {
            const Index bins = bins_of(t, repeat);
            SlowUpdate engine(LogGrid(-3.0, 0.0, bins), material(0.3), {Scheme::paper});
            State p(bins);
            p(bins - 1, bins - 1) = 1.0;
            comminute::settle(engine, p.view(), 20.0);
            CHECK(helpers::largest_difference(p.mass, result[t][at(repeat)].mass) < 1e-13);
        }
    }
}

TEST_CASE("a host's threads and the library plan transforms under the host's lock") {
    struct Host {
        std::mutex planner;
        int taken = 0;  // both guarded by the planner's mutex
        bool held = false;
        int overlaps = 0;
    } host;
    const auto lock = [](void* data) {
        auto& own = *static_cast<Host*>(data);
        own.planner.lock();
        ++own.taken;
        if (own.held) ++own.overlaps;
        own.held = true;
    };
    const auto unlock = [](void* data) {
        auto& own = *static_cast<Host*>(data);
        own.held = false;
        own.planner.unlock();
    };
    const auto wisdom = [] {  // one plan a line, in no particular order
        char* text = fftw_export_wisdom_to_string();
        std::istringstream lines(text);
        std::free(text);
        std::multiset<std::string> plans;
        for (std::string line; std::getline(lines, line);) plans.insert(line);
        return plans;
    };
    CHECK_REFUSED(comminute::set_fft_planner_lock(lock, nullptr),
                  "unlock is null but lock is not; give both, or neither");
    CHECK_REFUSED(comminute::set_fft_planner_lock(nullptr, unlock),
                  "lock is null but unlock is not; give both, or neither");
    const LogGrid grid(-3.0, 0.0, 40);
    const comminute::FullConvolutionOptions options{{}, StepPath::transforms};
    comminute::set_fft_planner_lock(lock, unlock, &host);
    at_once([&](std::size_t t) {
        for (int repeat = 0; repeat < 12; ++repeat) {
            if (t % 2 == 0) {
                FullConvolution engine(grid, material(0.3), options);
                FullConvolution copy = engine;
                continue;
            }
            std::vector<double> line(at(2 * (64 + repeat)), 1.0);
            auto* numbers = reinterpret_cast<fftw_complex*>(line.data());
            lock(&host);
            fftw_plan plan = fftw_plan_dft_1d(64 + repeat, numbers, numbers, FFTW_FORWARD, FFTW_ESTIMATE);
            unlock(&host);
            fftw_execute(plan);
            lock(&host);
            fftw_destroy_plan(plan);
            unlock(&host);
        }
    });
    CHECK(host.overlaps == 0);
    const int by_host = 2 * 12 * 2;
    CHECK(host.taken >= by_host + 2 * 12);
    // Nothing of what the library planned, and all of what the host did, is left in FFTW's wisdom.
    const auto before = wisdom();
    const int taken = host.taken;
    { FullConvolution engine(LogGrid(-3.0, 0.0, 97), material(0.3), options); }
    CHECK(host.taken > taken);
    const bool same = wisdom() == before;
    CHECK(same);
    comminute::set_fft_planner_lock(nullptr, nullptr);
    const int last = host.taken;
    { FullConvolution engine(grid, material(0.3), options); }
    CHECK(host.taken == last);
}

#endif
