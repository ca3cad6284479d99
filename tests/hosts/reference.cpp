// SPDX-License-Identifier: BSD-3-Clause
// The numbers that hosts in other languages have to print: the cycles of host.c by single solves, as runs of the Python
// package take them.
#include <comminute/comminute.hpp>
#include <cstdio>

int main() {
    comminute::Material material;
    material.reference_size = 2.0;
    const auto sand = comminute::sieve_grading({2.0, 1.0, 0.5, 0.25}, {100.0, 70.0, 20.0, 0.0});
    comminute::GridOptions wanted;
    wanted.bins = 64;
    const auto grid = comminute::fitting_grid(sand, material, 100.0, wanted);
    comminute::QuasiStatic solver(grid, material);
    const auto print = [](const comminute::Marginal& grading) {
        for (const double mass : grading.grainsize) std::printf("%a\n", mass);
    };
    const auto start = comminute::mixed_fabric(sand, grid);
    for (int load = 0; load < 3; ++load) print(solver.marginal(start, 50.0));  // unloading changes nothing
    const auto mixed = comminute::remix(solver.solve(start, 50.0));
    print(solver.marginal(mixed, 20.0));
    print(solver.marginal(mixed, 60.0));
    return 0;
}
