// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/grid.hpp"

namespace comminute {

namespace detail {
class FabricAccess;
}

/// How the two neighbours of a grain make its neighbourhood grainsize.
enum class Mean {
    arithmetic,  ///< mean of the sizes (Eq. 48), the model's own
    geometric,   ///< mean of the log sizes (Eq. 65)
};

/// Mass at one exact log size. The size itself stands beside its log, since exp(ln s) is often another number than s:
/// curves jump at the size that the user gave.
struct PointMass {
    double psi;
    double mass;
    double size = std::exp(psi);  ///< in the material's unit
    friend bool operator==(const PointMass& a, const PointMass& b) {
        return a.psi == b.psi && a.mass == b.mass && a.size == b.size;
    }
};

/// Mass at one exact place of the fabric: grains of one size among neighbours of one mean size.
struct Atom {
    double psi;
    double psibar;
    double mass;
    friend bool operator==(const Atom& a, const Atom& b) {
        return a.psi == b.psi && a.psibar == b.psibar && a.mass == b.mass;
    }
};

/// Which of the two log sizes a ridge holds at an exact value.
enum class Axis { grain, neighbour };

/// Mass with one of its two log sizes exact and the other spread over bins: what becomes of an atom once one of its two
/// grains has crushed, or of point masses mixed with a spread grading.
struct Ridge {
    Axis exact;                ///< the log size that is exact
    double at;                 ///< its value
    std::vector<double> mass;  ///< (N) by bin of the other log size
    double above = 0.0;        ///< of the mass in the bin that holds `at`: the part larger than `at`
    friend bool operator==(const Ridge& a, const Ridge& b) {
        return a.exact == b.exact && a.at == b.at && a.mass == b.mass && a.above == b.above;
    }
};

/// All the numbers of a fabric, for a host that stores it. Fabric::from_parts makes the same fabric of them again, to the
/// last bit, and so is all that follows.
struct FabricParts {
    LogGrid grid;
    std::vector<double> probability;  ///< (N*N) mass in bins, row after row, [psi, psibar]
    std::vector<Atom> atoms;          ///< exact masses on top of it
    std::vector<Ridge> ridges;        ///< half-exact masses on top of both
    std::optional<double>
        settled_at;  ///< largest stress ratio under which the state is at rest; none: never loaded
    Mean mean = Mean::arithmetic;
    // The marginals over psi as an engine or a mixing handed them on. They equal the sums of the members above but for
    // rounding, and the next solve or remixing starts from them, so that none sums the state again.
    std::vector<double> rows;    ///< (N) mass by grainsize in bins
    std::vector<double> spread;  ///< (N) the same with the ridges that spread over psi
    std::vector<PointMass>
        points;  ///< mass at the exact sizes of atoms and of the other ridges, fine to coarse
    /// Size that no grain of the start exceeds; 0 where it is not known, and the edges of the bins are all there is.
    double largest = 0.0;
};

/// The grainsize fabric: shares of the mass by log grainsize psi and log neighbourhood grainsize psibar.
///
/// Most of it lies in bins. Point masses of a start (one size, a few sizes) are kept exact until they crush, as atoms
/// and ridges, since smeared over a bin only a part of them would lie in a narrow crush zone.
///
/// Immutable; copies share their numbers, so passing one by value is cheap and safe between threads.
///
/// @code{.cpp}
/// comminute::LogGrid grid(-6.0, 0.0, 16);
/// std::vector<double> p(16 * 16, 1.0 / 256.0);
/// comminute::Fabric fabric(grid, std::move(p));
/// CHECK(fabric.grainsize()[3] == doctest::Approx(1.0 / 16.0));
/// CHECK(fabric.cdf().back() == doctest::Approx(1.0));
/// CHECK(comminute::Fabric::from_parts(fabric.parts()) == fabric);
/// @endcode
class COMMINUTE_API Fabric {
  public:
    /// @param probability  (N*N) row after row, [psi, psibar], entries >= 0
    /// @param atoms        exact masses on top of it, inside the grid and above its fines bin
    /// @param settled_at   largest stress ratio under which this state is at rest; none: never loaded
    /// @param ridges       half-exact masses on top of it
    /// @param largest      size that no grain exceeds; 0 where it is not known
    /// @throws ShapeError for another size; ParameterError for a negative or non-finite entry (its place is given), a
    ///         total of all three other than 1 (to 1e-9), a place off the grid, or a bad stress ratio
    Fabric(const LogGrid& grid, std::vector<double> probability, std::vector<Atom> atoms = {},
           std::optional<double> settled_at = std::nullopt, Mean mean = Mean::arithmetic,
           std::vector<Ridge> ridges = {}, double largest = 0.0);

    const LogGrid& grid() const { return data_->grid; }
    Mean mean() const { return data_->mean; }
    std::optional<double> settled_at() const { return data_->settled_at; }

    /// (N, N) the mass in bins; atoms and ridges are not in it.
    MatrixView<const double> probability() const;
    const std::vector<Atom>& atoms() const { return data_->atoms; }
    const std::vector<Ridge>& ridges() const { return data_->ridges; }

    /// (N) mass by grainsize, the marginal over psibar (Eq. 62); atoms and ridges are in the bins that hold them.
    VectorView<const double> grainsize() const { return data_->grainsize; }
    /// The exact sizes in that marginal, fine to coarse: where its cdf jumps.
    const std::vector<PointMass>& points() const { return data_->points; }
    /// Size that no grain exceeds, the largest of the start: curves end there. 0 where it is not known, as in a fabric
    /// made of bins alone.
    double largest() const { return data_->largest; }
    /// (N) mass by neighbourhood grainsize, the marginal over psi.
    std::vector<double> neighbourhood() const;
    /// (N) mass fraction finer than the upper edge of each bin.
    std::vector<double> cdf() const;

    /// The same with every atom and ridge in the bin that holds it, for engines that know bins only. Never loaded
    /// where that moved any mass, since bins are not tested as points are; a point then fills its bin, so that the largest
    /// size is not known any more.
    Fabric binned() const;

    /// The numbers themselves, to be stored.
    const FabricParts& parts() const { return *data_; }
    /// The same fabric from its stored numbers.
    /// @throws as the constructor; ShapeError for marginals of another size, ParameterError for marginals that are not
    ///         those of the other members (to 1e-9)
    static Fabric from_parts(FabricParts parts);

    friend COMMINUTE_API bool operator==(const Fabric& a, const Fabric& b);

  private:
    friend class detail::FabricAccess;
    struct Data : FabricParts {
        std::vector<double> grainsize;  // (N) `spread` with the points in their bins
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
COMMINUTE_API std::vector<double> neighbourhood_pmf(const LogGrid& grid, VectorView<const double> grainsize,
                                                    Mean mean);

/// Complete mixing (Eq. 64): neighbours independent of the grain. Never loaded.
///
/// Two exact sizes have an exact mean and make an atom; an exact size beside a bin makes a ridge.
/// @param grainsize  (N) mass by bin, entries >= 0
/// @param points     exact sizes on top of it, inside the grid; those in its fines bin join it
/// @param largest    size that no grain exceeds; 0 where it is not known
/// @throws ShapeError; ParameterError for a bad entry, a size above the grid, or a total other than 1 (to 1e-9)
COMMINUTE_API Fabric mixed_fabric(const LogGrid& grid, std::vector<double> grainsize,
                                  Mean mean = Mean::arithmetic, std::vector<PointMass> points = {},
                                  double largest = 0.0);

/// The same grains, mixed anew; forgets the load, since grains meet new neighbours. Exact sizes stay exact.
COMMINUTE_API Fabric remix(const Fabric& fabric);

}  // namespace comminute
