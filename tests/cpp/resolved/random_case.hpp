// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <numeric>
#include <random>
#include <vector>

#include "support/helpers.hpp"

namespace helpers {

inline comminute::Material with_width(double n) {
    comminute::Material material;
    material.fabric_width = n;
    return material;
}

/// A packing of two exact sizes and a band between them, of any material: all that the law of three cells distinguishes.
struct RandomCase {
    comminute::ResolvedGrid grid;
    comminute::Material material;
    std::vector<double> pmf;
    comminute::ResolvedOptions options;

    static RandomCase draw(unsigned seed) {
        std::mt19937_64 random(seed);
        std::uniform_real_distribution<double> share(0.0, 1.0);
        comminute::Material material;
        material.fabric_width = 0.03 * std::pow(15.0, share(random));
        material.weibull_modulus = 2.0 + 5.0 * share(random);
        const int law = static_cast<int>(4.0 * share(random));
        if (law == 1) material.fragments = comminute::PowerLawFragments{0.6 + share(random)};
        if (law == 2) material.fragments = comminute::LogNormalFragments{-0.8, 0.4};
        if (law == 3) material.fragments = comminute::TabulatedFragments{{0.1, 0.5, 1.0}, {0.1, 0.4, 1.0}};
        material.strength_scatter = seed % 3 == 0;
        comminute::ResolvedOptions options;
        options.mean = share(random) < 0.5 ? comminute::Mean::arithmetic : comminute::Mean::geometric;
        comminute::NodeOptions nodes;
        nodes.spacing = 0.3;
        const double second = -0.1 - 2.0 * share(random);
        comminute::ResolvedGrid grid = comminute::ResolvedGrid::graded(
            material.fabric_width, -5.0, {second, 0.0}, {{second - 0.7, second - 0.2}}, nodes);
        std::vector<double> pmf(at(grid.nodes()), 0.0);
        for (Index i = 0; i < grid.nodes(); ++i) {
            const bool spread = grid.lower(i) >= second - 0.7 && grid.upper(i) <= second - 0.2;
            if (spread) pmf[at(i)] = grid.width(i) * share(random);
            if (grid.exact(i)) pmf[at(i)] = 0.3 * share(random);
        }
        const double total = std::accumulate(pmf.begin(), pmf.end(), 0.0);
        for (double& mass : pmf) mass /= total;
        return {grid, material, pmf, options};
    }
};

}  // namespace helpers
