// SPDX-License-Identifier: BSD-3-Clause
// Confined compression of a measured sand: sieve curve and stress path in, gradings and indices out.
//
//     oedometer sand.csv path.csv OUT
//
// leaves gradings.csv and indices.csv in the folder OUT, from which draw_oedometer.py makes the figure.
#include <algorithm>
#include <cmath>
#include <comminute/comminute.hpp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using Rows = std::vector<std::vector<double>>;

/// Rows of numbers of a table; lines that begin with no number are comments or headings.
Rows read(const std::string& path) {
    std::ifstream file(path);
    if (!file) throw std::runtime_error(path + " cannot be read");
    Rows rows;
    for (std::string line; std::getline(file, line);) {
        std::vector<double> row;
        std::istringstream cells(line);
        for (std::string cell; std::getline(cells, cell, ',');) {
            char* end = nullptr;
            const double value = std::strtod(cell.c_str(), &end);
            if (end == cell.c_str()) break;
            row.push_back(value);
        }
        if (!row.empty()) rows.push_back(row);
    }
    return rows;
}

/// Mean log size of the mass in bins.
double mean_log_size(const comminute::LogGrid& grid, const std::vector<double>& masses) {
    double mean = 0.0;
    for (std::size_t i = 0; i < masses.size(); ++i)
        mean += masses[i] * grid.centre(static_cast<comminute::Index>(i));
    return mean;
}

std::vector<double> finer(const std::vector<double>& masses) {
    std::vector<double> cdf;
    double sum = 0.0;
    for (const double mass : masses) cdf.push_back(sum += mass);
    return cdf;
}

void run(const std::string& sieves, const std::string& path, const std::string& out) {
    std::vector<double> size, percent;
    for (const auto& row : read(sieves)) {
        size.push_back(row.at(0));
        percent.push_back(row.at(1));
    }
    const comminute::Grading sand = comminute::sieve_grading(size, percent, {"mm"});

    constexpr double k0 = 0.5;
    comminute::Material material;
    material.reference_size = sand.largest();
    material.fabric_width = 0.2;        // assumed: neighbours cushion grains less than with the paper's 0.05
    material.first_crush_stress = 2.0;  // MPa, assumed: the vertical stress of an oedometer with this K0
    material.k0 = k0;
    material.stress_measure = comminute::StressMeasure(comminute::StressKind::energy, 0.2);
    const comminute::StressScale scale = material.stress_scale();

    std::vector<double> vertical;
    for (const auto& row : read(path)) vertical.push_back(row.at(0));
    const double most = *std::max_element(vertical.begin(), vertical.end());
    const comminute::LogGrid grid =
        comminute::fitting_grid(sand, material, scale.stress_ratio_vertical(most, k0));
    comminute::MaterialPoints point(material, comminute::mixed_fabric(sand, grid), 1);

    // Einav's breakage index: 0 for the start, 1 for a power law of fractal dimension 2.6 with the same largest grain.
    std::vector<double> masses(static_cast<std::size_t>(grid.bins()));
    point.grading(0, masses);
    const double start = mean_log_size(grid, masses);
    const double ultimate = std::log(sand.largest()) - 1.0 / (3.0 - 2.6);

    std::ofstream gradings(out + "/gradings.csv"), indices(out + "/indices.csv");
    gradings << "vertical_MPa,size_mm,percent_finer\n";
    indices << "vertical_MPa,stress_ratio,breakage,D10_mm,D50_mm,D60_mm,crushed\n";
    for (const double stress : vertical) {
        const double sigma[6] = {k0 * stress, k0 * stress, stress, 0.0, 0.0, 0.0};
        const std::vector<double> load{scale.stress_ratio(sigma)};
        if (!point.update({load})) throw std::runtime_error(point.message(0));
        point.grading(0, masses);
        const std::vector<double> cdf = finer(masses);
        for (comminute::Index i = 0; i < grid.bins(); ++i) {
            gradings << stress << ',' << std::exp(grid.edge(i + 1)) << ','
                     << 100.0 * cdf[static_cast<std::size_t>(i)] << '\n';
        }
        const auto d = [&](double share) { return comminute::percentile(grid, cdf, share, true); };
        indices << stress << ',' << load[0] << ','
                << (start - mean_log_size(grid, masses)) / (start - ultimate) << ',' << d(10.0) << ','
                << d(50.0) << ',' << d(60.0) << ',' << point.crushed()[0] << '\n';
    }
    std::printf("%zu stresses up to %g MPa; D50 of %.3g mm at the end\n", vertical.size(), most,
                comminute::percentile(grid, finer(masses), 50.0));
}

}  // namespace

int main(int count, char** given) {
    if (count != 4) {
        std::fprintf(stderr, "usage: oedometer sand.csv path.csv OUT\n");
        return 2;
    }
    try {
        run(given[1], given[2], given[3]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "oedometer: %s\n", error.what());
        return 1;
    }
    return 0;
}
