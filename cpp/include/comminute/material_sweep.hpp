// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/fabric.hpp"
#include "comminute/grading.hpp"
#include "comminute/quasi_static.hpp"

namespace comminute {

/// Numbers that are read off every grading of a sweep beside the fixed ones.
struct GradingNumbers {
    std::vector<double> percents;  ///< in [0, 100]: sizes D_x are wanted
    std::vector<double> sizes;     ///< > 0, mass finer than each is wanted
    double silt = 0.0;             ///< size below which Hardin's potential is 0; 0 where that has no unit
    friend bool operator==(const GradingNumbers& a, const GradingNumbers& b) {
        return a.percents == b.percents && a.sizes == b.sizes && a.silt == b.silt;
    }
};

/// Reads the same numbers off one grading after another.
///
/// They are, in this order: the mass in the fines bin; the mean of ln d (CurvePoints::mean_log); Hardin's potential, NaN
/// where no silt size is given; the sizes D_x, NaN for one that lies in the fines bin; the mass finer than each size.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-8.0, 0.0, 201);
/// const auto start = comminute::mixed_fabric(comminute::monodisperse(1.0), grid);
/// const comminute::GradingReader reader(start, std::nullopt, {{50.0}, {0.5}, 0.0});
/// comminute::QuasiStatic solver(grid, comminute::Material{});
/// const auto numbers = reader.read(solver.marginal(start, 8.0));
/// CHECK(numbers.size() == 5);
/// CHECK((numbers[3] < 0.5) == (numbers[4] > 0.5));  // D50 and the mass finer than .5
/// @endcode
class COMMINUTE_API GradingReader {
  public:
    /// @param start     before the first load, on the grid of all gradings
    /// @param measured  sieve data that the start was made of, in whose sieves curves bend; see with_sieves()
    /// @throws ParameterError for a percentage or a size outside its range
    GradingReader(const Fabric& start, std::optional<CurvePoints> measured, GradingNumbers wanted);

    const LogGrid& grid() const { return grid_; }
    /// How many numbers there are: 3 and the sizes that are wanted of either kind.
    Index count() const;

    /// Curve of a grading, as `curve_on_grid` and `with_sieves` give it, its last value 1.
    CurvePoints curve(const Marginal& grading) const;
    /// @throws ShapeError for a grading on another grid
    std::vector<double> read(const Marginal& grading) const;

  private:
    LogGrid grid_;
    std::vector<double> start_;
    double largest_;
    std::optional<CurvePoints> measured_;
    GradingNumbers wanted_;
};

/// Numbers of the gradings of one start under loads, for one material after another: the members of a sweep.
///
/// The start is mixed once for all, and one solver's memory serves all members, which do not know of each other. One object
/// per thread.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-8.0, 0.0, 201);
/// const auto start = comminute::mixed_fabric(comminute::monodisperse(1.0), grid);
/// comminute::MaterialSweep sweep(start, comminute::GradingReader(start, std::nullopt, {{50.0}, {}, 0.0}));
/// const std::vector<double> loads{1.0, 10.0};
/// std::vector<double> rows(2 * 6);
/// comminute::Material sand;
/// sweep.run(sand, loads, {rows.data(), 2, sweep.columns()});
/// CHECK(rows[0] == doctest::Approx(0.5));           // crushes a cell: of two equal grains either may be the first
/// sand.fabric_width = 0.5;
/// sweep.run(sand, loads, {rows.data(), 2, sweep.columns()});
/// CHECK(rows[6] > 0.5);                             // under the second load
/// @endcode
class COMMINUTE_API MaterialSweep {
  public:
    MaterialSweep(Fabric start, GradingReader reader, const QuasiStaticOptions& options = {});

    /// How many numbers a load has: the crushes of a cell, the total mass less 1, and those of the reader.
    Index columns() const { return reader_.count() + 2; }

    /// Takes the start through loads.
    /// @param stress_ratios  (T) in any order; as on any slow path, the largest so far counts
    /// @param rows           (T, columns) out
    /// @throws ParameterError for a bad material or load, ShapeError for another shape of `rows`
    void run(const Material& material, VectorView<const double> stress_ratios, MatrixView<double> rows);

  private:
    Fabric start_;
    GradingReader reader_;
    QuasiStatic solver_;  // of the member before
};

}  // namespace comminute
