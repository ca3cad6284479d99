// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "comminute/grid.hpp"

namespace comminute {

/// How the two neighbours of a grain make its neighbourhood grainsize.
enum class Mean {
    arithmetic,  ///< mean of the sizes (Eq. 48), the model's own
    geometric,   ///< mean of the log sizes (Eq. 65)
};

/// The grainsize fabric: shares of the mass by log grainsize psi and log neighbourhood grainsize psibar.
///
/// Immutable; copies share their numbers, so passing one by value is cheap and safe between threads.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 16);
/// std::vector<double> p(16 * 16, 1.0 / 256.0);
/// comminute::Fabric fabric(grid, std::move(p));
/// CHECK(fabric.grainsize()[3] == doctest::Approx(1.0 / 16.0));
/// CHECK(fabric.cdf().back() == doctest::Approx(1.0));
/// @endcode
class Fabric {
  public:
    /// @param probability  (N*N) row after row, [psi, psibar], entries >= 0 that add up to 1 (to 1e-9)
    /// @param settled_at   largest stress ratio under which this state is at rest; none: never loaded
    /// @throws ShapeError for another size; ParameterError for a negative or non-finite entry (its place is
    /// given),
    ///         another sum, or a bad stress ratio
    Fabric(const LogGrid& grid, std::vector<double> probability,
           std::optional<double> settled_at = std::nullopt, Mean mean = Mean::arithmetic);

    const LogGrid& grid() const { return data_->grid; }
    Mean mean() const { return data_->mean; }
    std::optional<double> settled_at() const { return data_->settled_at; }

    MatrixView<const double> probability() const;
    /// (N) mass by grainsize, the marginal over psibar (Eq. 62).
    VectorView<const double> grainsize() const { return data_->grainsize; }
    /// (N) mass by neighbourhood grainsize, the marginal over psi.
    std::vector<double> neighbourhood() const;
    /// (N) mass fraction finer than the upper edge of each bin.
    std::vector<double> cdf() const;

    friend bool operator==(const Fabric& a, const Fabric& b);
    friend Fabric mixed_fabric(const LogGrid& grid, std::vector<double> grainsize, Mean mean);

  private:
    struct Data {
        LogGrid grid;
        std::vector<double> probability;
        std::vector<double> grainsize;
        std::optional<double> settled_at;
        Mean mean;
    };
    explicit Fabric(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

    std::shared_ptr<const Data> data_;
};

/// (N) law of psibar for two independent neighbours drawn from `grainsize` (Eqs. 65, 66; 48 without
/// sampling).
///
/// Bins act as points at their centres, the fines bin too. Each pair is shared between the two nearest
/// centres such that the mean is kept exactly: E[sbar] = E[s] for the arithmetic mean, E[psibar] = E[psi] for
/// the geometric one. O(N^2). @throws ShapeError
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 16);
/// std::vector<double> equal(16, 0.0);
/// equal[9] = 1.0;
/// CHECK(comminute::neighbourhood_pmf(grid, equal, comminute::Mean::arithmetic) == equal);
/// @endcode
std::vector<double> neighbourhood_pmf(const LogGrid& grid, VectorView<const double> grainsize, Mean mean);

/// Complete mixing (Eq. 64): neighbours independent of the grain. Never loaded.
/// @param grainsize  (N) mass by bin, entries >= 0 that add up to 1 (to 1e-9)
/// @throws ShapeError, ParameterError
Fabric mixed_fabric(const LogGrid& grid, std::vector<double> grainsize, Mean mean = Mean::arithmetic);

/// The same grains, mixed anew; forgets the load, since grains meet new neighbours.
Fabric remix(const Fabric& fabric);

}  // namespace comminute
