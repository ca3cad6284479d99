// SPDX-License-Identifier: BSD-3-Clause
// A host code: installed headers, C++17, no Eigen, no FFTW header.
#include <comminute/comminute.hpp>
#include <cstdio>

int main() {
    const comminute::Material material;
    const auto grading = comminute::gap_graded(1.0, 0.1);
    const auto grid = comminute::fitting_grid(grading, material, 100.0, 0.1);
    const auto fabric = comminute::mixed_fabric(grading, grid);
    comminute::QuasiStatic solver(grid, material);
    comminute::SolveReport report;
    const comminute::Fabric after = solver.solve(fabric, 100.0, &report);
    std::printf("comminute %s: %.3f crushes a cell, %.1f %% finer than 0.5\n", comminute::version,
                report.crushed, 100.0 * after.cdf()[static_cast<std::size_t>(grid.bin_of(-0.7))]);
    const auto binned = fabric.binned();
    const auto before = binned.probability();
    std::vector<double> state(before.data(), before.data() + before.rows() * before.cols());
    comminute::SlowUpdate engine(grid, material, {comminute::Scheme::paper});
    const auto steps = comminute::settle(engine, {state.data(), grid.bins(), grid.bins()}, 100.0);

    std::vector<double> points;  // two material points, in place
    for (int b = 0; b < 2; ++b) {
        points.insert(points.end(), before.data(), before.data() + before.rows() * before.cols());
    }
    const comminute::StackView<double> both(points.data(), 2, grid.bins());
    const std::vector<double> loads{2.0, 100.0};
    std::vector<double> settled_at{0.0, 0.0};
    std::vector<comminute::SolveReport> said(2);
    comminute::BatchSolver batch(solver);
    batch.solve({both, loads, settled_at}, both, {settled_at, said});
    return report.crushed > 0.0 && steps.crushed > 0.0 && said[1].crushed > said[0].crushed ? 0 : 1;
}
