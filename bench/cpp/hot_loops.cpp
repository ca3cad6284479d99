// SPDX-License-Identifier: BSD-3-Clause
// The library's hot loops, each with what it computes and moves at the least, so that its distance from the machine's
// limits is a number.
//
// flops: additions and multiplications of the algorithm, as derived beside each loop. bytes: compulsory traffic, every
// number that must be read or written counted once, as if the cache had no end. Both are shown as rates.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <comminute/comminute.hpp>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "simd/targets.hpp"

namespace {

using comminute::Index;

constexpr double load = 1e4;
constexpr double expected_crushes = 0.58;  // of a cell that starts among equals, up to this load

comminute::LogGrid grid_of(Index bins) {
    return comminute::LogGrid(-6.0, 1.0, bins);
}

comminute::Fabric start_on(const comminute::LogGrid& grid) {
    return comminute::mixed_fabric(comminute::power_law(2.5, 2.5e-3, 1.0), grid);
}

std::vector<double> copy_of(const comminute::Fabric& fabric) {
    const auto state = fabric.probability();
    return {state.data(), state.data() + state.rows() * state.cols()};
}

comminute::MatrixView<double> view(std::vector<double>& state, Index bins) {
    return {state.data(), bins, bins};
}

double total(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum;
}

// Cells of the zone off the diagonal, both arms.
double band_cells(const comminute::CrushZones& zones) {
    double cells = 0.0;
    for (Index m = 1; m < zones.grid().bins(); ++m) {
        cells += 2.0 * static_cast<double>(std::min(std::max<Index>(zones.band(m), 0), m));
    }
    return cells;
}

void count(benchmark::State& state, double flops, double bytes) {
    const auto rate = benchmark::Counter::kIsIterationInvariantRate;
    state.counters["flops"] = benchmark::Counter(flops, rate);
    state.counters["bytes"] = benchmark::Counter(bytes, rate, benchmark::Counter::kIs1024);
    state.counters["flops/byte"] = flops / bytes;
}

void require_whole(benchmark::State& state, double mass) {
    if (std::abs(mass - 1.0) > 1e-12) state.SkipWithError("mass was lost");
}

// memcpy of the state: the rate that memory gives.
void copy_state(benchmark::State& state) {
    const Index bins = state.range(0);
    const auto from = copy_of(start_on(grid_of(bins)));
    auto to = from;
    for (auto turn : state) {
        std::copy(from.begin(), from.end(), to.begin());
        benchmark::ClobberMemory();
    }
    count(state, 0.0, 16.0 * static_cast<double>(bins * bins));
}

// The last of 200 increments. Each active cell of shell m hands its mass to m bins, a multiplication and an addition
// each; every cell that is reached is read and written. Running sums, which it takes here, do with fewer flops.
void slow_update(benchmark::State& state) {
    const Index bins = state.range(0);
    const auto grid = grid_of(bins);
    comminute::SlowUpdate engine(grid, comminute::Material{}, {comminute::Scheme::paper});
    auto before = copy_of(start_on(grid));
    const double factor = std::pow(load, 1.0 / 199.0);
    double stress_ratio = 1.0;
    for (int step = 0; step < 199; ++step, stress_ratio *= factor) {
        engine.step(view(before, bins), stress_ratio, view(before, bins));
    }
    const comminute::CrushZones zones(grid, comminute::Material{}, load);
    double flops = 0.0;
    for (Index i = 0; i < bins; ++i) {
        for (Index j = 0; j < bins; ++j) {
            if (zones.at(i, j) == comminute::Zone::rest ||
                before[static_cast<std::size_t>(i * bins + j)] == 0.0)
                continue;
            flops += 2.0 * static_cast<double>(std::max(i, j)) * (i == j ? 2.0 : 1.0);
        }
    }
    auto p = before;
    for (auto turn : state) {
        state.PauseTiming();
        p = before;
        state.ResumeTiming();
        engine.step(view(p, bins), load, view(p, bins));
    }
    require_whole(state, total(p));
    count(state, flops, 16.0 * static_cast<double>(bins * bins));
}

comminute::FullConvolution exact_step(const comminute::LogGrid& grid, comminute::StepPath path) {
    const comminute::KernelOptions exact{comminute::KernelKind::exact, 0.0, comminute::Scheme::paper};
    return {grid, comminute::Material{}, {exact, path}};
}

// A complex line there and back at 5 L log2 L each, and its product with the filter's spectrum.
double pair_flops(double length) {
    return length * (10.0 * std::log2(length) + 6.0);
}

// Two lines of each row in one complex line, and each two columns; as long as keeps them linear, which is the bins below
// the coarsest source and the extent of the sources: W more than i and 2 W in row i, all and all but i - W in column i.
// The state is read and written, and so is the mass between the two passes.
void full_convolution(benchmark::State& state) {
    const Index bins = state.range(0);
    const auto grid = grid_of(bins);
    auto engine = exact_step(grid, comminute::StepPath::transforms);
    auto p = copy_of(start_on(grid));
    auto out = p;
    for (auto turn : state) engine.step(view(p, bins), load, view(out, bins));
    require_whole(state, total(out));
    const comminute::CrushZones zones(grid, comminute::Material{}, load);
    double flops = 0.0;
    for (Index i = 1; i < bins; ++i) {
        const auto width = static_cast<double>(zones.band(i));
        flops += pair_flops(static_cast<double>(i) + 3.0 * width);
        flops += 0.5 * pair_flops(static_cast<double>(2 * bins - i) + width);
    }
    count(state, flops, 32.0 * static_cast<double>(bins * bins));
}

// The same step by running sums. In each of a row's two lines the sums take in mass and give over the 2 W bins of the
// zone (4 flops a term) and only give below it (2); in a column they do the one from row i - W on and the other below.
void running_sums(benchmark::State& state) {
    const Index bins = state.range(0);
    const auto grid = grid_of(bins);
    auto engine = exact_step(grid, comminute::StepPath::sums);
    auto p = copy_of(start_on(grid));
    auto out = p;
    comminute::StepReport report;
    for (auto turn : state) report = engine.step(view(p, bins), load, view(out, bins));
    require_whole(state, total(out));
    const comminute::CrushZones zones(grid, comminute::Material{}, load);
    double given = 0.0;
    for (Index i = 1; i < bins; ++i) {
        const auto width = static_cast<double>(zones.band(i));
        const double below = std::max(static_cast<double>(i) - width, 0.0);
        given += 2.0 * (4.0 * 2.0 * width + 2.0 * below);
        given += 4.0 * static_cast<double>(bins) - 2.0 * below;
    }
    count(state, static_cast<double>(report.terms) * given, 32.0 * static_cast<double>(bins * bins));
}

// Work of a solve. By sums, a cell of an arm takes K sums that decay and take in mass (3 flops) and K powers of the
// crossing line (3), and a cell outside the band K terms (2). Bin by bin, a cell at distance d takes the W - d shells
// beyond it along either line (2 each), and a cell outside W of them. What moves and what stays: 8.
double solve_flops(const comminute::CrushZones& zones, Index terms, bool whole_state) {
    const Index bins = zones.grid().bins();
    const auto by_sums = static_cast<double>(terms);
    double flops = 0.0;
    for (Index m = 1; m < bins; ++m) {
        const auto width = static_cast<double>(std::min(std::max<Index>(zones.band(m), 0), m));
        const double outside = static_cast<double>(m) - width;
        flops += 2.0 * width * (8.0 + (terms > 0 ? 6.0 * by_sums : 2.0 * width));
        if (whole_state) flops += 2.0 * outside * 2.0 * (terms > 0 ? by_sums : width);
    }
    return flops;
}

// The band is read once.
void grading_solve(benchmark::State& state) {
    const Index bins = state.range(0);
    const auto grid = grid_of(bins);
    comminute::QuasiStatic solver(grid, comminute::Material{});
    const auto start = start_on(grid);
    auto after = solver.marginal(start, load);
    for (auto turn : state) after = solver.marginal(start, load);
    require_whole(state, total(after.grainsize));
    const comminute::CrushZones zones(grid, comminute::Material{}, load);
    count(state, solve_flops(zones, after.report.terms, false), 8.0 * band_cells(zones));
}

// The state is read and written.
void state_solve(benchmark::State& state) {
    const Index bins = state.range(0);
    const auto grid = grid_of(bins);
    comminute::QuasiStatic solver(grid, comminute::Material{});
    const auto before = copy_of(start_on(grid));
    auto after = before;
    comminute::SolveReport report;
    for (auto turn : state) {
        report = solver.solve({before.data(), bins, bins}, load, std::nullopt, view(after, bins));
    }
    require_whole(state, total(after));
    const comminute::CrushZones zones(grid, comminute::Material{}, load);
    count(state, solve_flops(zones, report.terms, true), 16.0 * static_cast<double>(bins * bins));
}

// Three critical loads a crush, with a logarithm and 7 flops each, and a draw with 5 more and three of log, log1p and
// exp; transcendental functions count as one. A cell has 20 bytes, read and written.
void lattice_load(benchmark::State& state) {
    const Index cells = state.range(0);
    const comminute::Lattice start(cells, comminute::Material{}, comminute::monodisperse(1.0));
    double crushes = 0.0;
    for (auto turn : state) {
        state.PauseTiming();
        comminute::Lattice lattice = start;
        state.ResumeTiming();
        crushes = static_cast<double>(lattice.load_to(load));
    }
    if (std::abs(crushes / static_cast<double>(cells) - expected_crushes) > 0.05) {
        state.SkipWithError("not the number of crushes that is to be expected");
    }
    count(state, crushes * (3.0 * 8.0 + 8.0), 40.0 * static_cast<double>(cells));
    state.counters["crushes"] = benchmark::Counter(crushes, benchmark::Counter::kIsIterationInvariantRate);
}

}  // namespace

BENCHMARK(copy_state)->Arg(250)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);
BENCHMARK(slow_update)->Arg(250)->Arg(1000)->Arg(2000)->Unit(benchmark::kMicrosecond);
BENCHMARK(full_convolution)->Arg(250)->Arg(1000)->Arg(2000)->Unit(benchmark::kMicrosecond);
BENCHMARK(running_sums)->Arg(250)->Arg(1000)->Arg(2000)->Unit(benchmark::kMicrosecond);
BENCHMARK(grading_solve)->Arg(250)->Arg(1000)->Arg(1024)->Arg(4000)->Unit(benchmark::kMicrosecond);
BENCHMARK(state_solve)->Arg(64)->Arg(250)->Arg(1000)->Arg(4000)->Unit(benchmark::kMicrosecond);
BENCHMARK(lattice_load)->Arg(10'000)->Arg(1'000'000)->Unit(benchmark::kMillisecond);

// Beside the options of Google Benchmark, `--vectors=AVX2` takes the vector loops of that instruction set.
int main(int argc, char** argv) {
    const std::string option = "--vectors=";
    if (argc > 1 && std::string(argv[1]).rfind(option, 0) == 0) {
        const std::string wanted = argv[1] + option.size();
        std::int64_t set = 0;
        for (std::int64_t rest = HWY_TARGETS & (hwy::SupportedTargets() | HWY_STATIC_TARGET); rest != 0;
             rest &= rest - 1) {
            if (wanted == hwy::TargetName(rest & -rest)) set = rest & -rest;
        }
        if (set == 0) {
            std::fprintf(stderr, "%s: this build or this machine has no such instruction set\n", argv[1]);
            return 1;
        }
        hwy::SetSupportedTargetsForTest(set);
        std::copy(argv + 2, argv + argc, argv + 1);
        --argc;
    }
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
    benchmark::RunSpecifiedBenchmarks();
    return 0;
}
