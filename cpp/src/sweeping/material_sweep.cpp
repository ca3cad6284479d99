// SPDX-License-Identifier: BSD-3-Clause
// One start and many materials, and the numbers of their gradings (docs/theory/one_sweep.md, section 15).
#include "comminute/material_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/check.hpp"
#include "base/point_curve.hpp"

namespace comminute {

using namespace detail;

namespace {

constexpr double nowhere = std::numeric_limits<double>::quiet_NaN();

}  // namespace

GradingReader::GradingReader(const Fabric& start, std::optional<CurvePoints> measured, GradingNumbers wanted)
    : grid_(start.grid()),
      start_(start.grainsize().begin(), start.grainsize().end()),
      largest_(start.largest()),
      measured_(std::move(measured)),
      wanted_(std::move(wanted)) {
    for (const double percent : wanted_.percents)
        require(percent >= 0.0 && percent <= 100.0, "percents", percent, "between 0 and 100");
    for (const double size : wanted_.sizes)
        require(size > 0.0 && std::isfinite(size), "sizes", size, "greater than 0 and finite");
    require(wanted_.silt >= 0.0 && std::isfinite(wanted_.silt), "silt", wanted_.silt, "a size, or 0");
}

Index GradingReader::count() const {
    return 3 + static_cast<Index>(wanted_.percents.size() + wanted_.sizes.size());
}

CurvePoints GradingReader::curve(const Marginal& grading) const {
    require_bins(static_cast<Index>(grading.grainsize.size()), grid_.bins(), entry("grading"));
    std::vector<double> cdf(grading.grainsize.size());
    std::partial_sum(grading.grainsize.begin(), grading.grainsize.end(), cdf.begin());
    CurvePoints curve = curve_on_grid(grid_, cdf, grading.points, largest_);
    curve.finer_than.back() = 1.0;
    return measured_ ? with_sieves(curve, grid_, grading.grainsize, start_, *measured_) : curve;
}

std::vector<double> GradingReader::read(const Marginal& grading) const {
    const CurvePoints points = curve(grading);
    const double fines = grading.grainsize.front();
    std::vector<double> numbers{fines, points.mean_log(),
                                wanted_.silt > 0.0 ? points.breakage_potential(wanted_.silt) : nowhere};
    for (const double percent : wanted_.percents) {
        const double share = percent / 100.0;
        numbers.push_back(share > fines + share_rounding ? points.quantile(share) : nowhere);
    }
    for (const double size : wanted_.sizes) numbers.push_back(points.finer(size));
    return numbers;
}

MaterialSweep::MaterialSweep(Fabric start, GradingReader reader, const QuasiStaticOptions& options)
    : start_(std::move(start)), reader_(std::move(reader)), solver_(start_.grid(), Material{}, options) {}

void MaterialSweep::run(const Material& material, VectorView<const double> stress_ratios,
                        MatrixView<double> rows) {
    require_entries(rows.rows(), stress_ratios.size(), entry("rows"), "it must have one for each load");
    require_entries(rows.cols(), columns(), entry("rows"), "it must have a column for each number");
    std::vector<double> largest(static_cast<std::size_t>(stress_ratios.size()));
    for (Index t = 0; t < stress_ratios.size(); ++t) {
        const double load = stress_ratios[t];
        require(load >= 0.0, "stress_ratio", load, "at least 0");
        largest[static_cast<std::size_t>(t)] =
            t > 0 ? std::max(largest[static_cast<std::size_t>(t - 1)], load) : load;
    }
    solver_.set_material(material);
    const std::vector<Marginal> gradings = solver_.marginals(start_, largest);
    for (Index t = 0; t < stress_ratios.size(); ++t) {
        const Marginal& grading = gradings[static_cast<std::size_t>(t)];
        double* const row = rows.row(t);
        row[0] = grading.report.crushed;
        row[1] = grading.mass_error();
        const std::vector<double> numbers = reader_.read(grading);
        std::copy(numbers.begin(), numbers.end(), row + 2);
    }
}

}  // namespace comminute
