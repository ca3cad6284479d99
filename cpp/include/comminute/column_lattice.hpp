// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "comminute/column_drive.hpp"
#include "comminute/export.hpp"
#include "comminute/grading.hpp"
#include "comminute/lattice.hpp"
#include "comminute/material.hpp"

namespace comminute {

/// Which active cell of a row crushes first after an exchange, when several have come to be active at once.
enum class CrushOrder : unsigned char {
    random,   ///< each at the same rate, the limit of a crushing rate that is finite and large
    weakest,  ///< the one of least critical load, as when the load rises
};

/// How probabilities of segregation follow from sizes.
enum class SwapRates : unsigned char {
    pair,     ///< by the difference of the two sizes
    flowslm,  ///< by the difference of each to the mean of its row, as the FlowSLM code has it
};

/// How a column of lattice rows is made and run. The results do not depend on `threads`.
struct ColumnOptions {
    std::uint64_t seed = 0;  ///< of the random numbers; each row has a stream of its own
    Mean mean = Mean::arithmetic;
    Partners partners = Partners::permuted;
    CrushOrder order = CrushOrder::random;
    SwapRates rates = SwapRates::pair;
    double largest_mixing =
        0.1;  ///< in (0, 1], of a swap by mixing in one exchange, beyond which it is divided
    double largest_segregation = 0.25;  ///< in (0, 1], the same of segregation
    Index threads = 1;                  ///< >= 1, at most so many rows are worked on at a time
};

/// A row of a column: its ring, and what the future depends on beside it.
struct ColumnRow {
    LatticeRing
        ring;  ///< whose `crushes` count the draws at a place, not the crushes of the grain that lies there
    std::vector<std::uint32_t> crushes;  ///< of the grain at each place
    std::vector<std::uint32_t> touched;  ///< places whose grain has changed since the row was at rest
    bool at_rest = true;                 ///< but for the places touched
    std::uint64_t activations = 0;       ///< clocks that were drawn
    double mean = 0.0;                   ///< of the sizes over the reference size, before the last exchange
    double largest = 0.0;                ///< the same of the largest
    double smallest = 0.0;               ///< and of the smallest
};

/// Account of an advance.
struct ColumnReport {
    std::uint64_t exchanges = 0;       ///< into which it was divided
    std::uint64_t swaps = 0;           ///< pairs of grains that changed places
    std::uint64_t crushes = 0;         ///< of all rows together
    double largest_probability = 0.0;  ///< of a swap of any pair of sizes that there was
};

/// A column of stochastic lattice rows that mix, segregate and crush: the witness of open systems (Section 8.3).
///
/// A row is a ring of M cells, as of `Lattice`, at one height; each cell stands for the same mass, and each row for the same
/// height of solid. In an exchange every cell of a row may change places with one of the row above: by mixing with the
/// probability Q / (1 + Q), Q = D dt / dz^2, which makes the diffusivity D exact; and, where it is the larger of the two, by
/// segregation with Q / (1 + Q / 2), Q = k_s shear dt (A - B) / (mean dz). Bonds go in two colours, every second one at a
/// time, the colours in turn first and second. A time in which a probability would pass its limit is divided; no
/// probability is ever cut. After each colour, cells that have come to be active crush, in random order; while a load
/// rises, the weakest first.
///
/// Row z is, as long as nothing is exchanged, replica z of a `Lattice` with the same seed, to the bit.
///
/// @code{.cpp}
/// const comminute::Material sand;
/// comminute::ColumnLattice column({comminute::monodisperse(1.0), comminute::monodisperse(0.5)}, 1000, sand, 0.02);
/// const std::vector<double> shear(2, 1.0), load(2, 0.0);
/// column.load_to(load);
/// comminute::ColumnDrive drive;
/// drive.shear_rate = shear;
/// drive.mixing = 1e-4;
/// column.advance(10.0, drive);
/// CHECK(column.mean_size(0) + column.mean_size(1) == doctest::Approx(1.5));  // grains only changed places
/// CHECK(column.mean_size(0) == doctest::Approx(0.75).epsilon(0.1));
/// @endcode
class COMMINUTE_API ColumnLattice {
  public:
    /// @param rows    gradings of the rows, bottom first, two at least; sizes are drawn independently
    /// @param cells   M >= 2 of each row
    /// @param height  > 0, of all rows together [m of solid]
    /// @throws ParameterError naming the parameter, its value and the rule
    ColumnLattice(const std::vector<Grading>& rows, Index cells, const Material& material, double height,
                  const ColumnOptions& options = {});
    /// @param sizes  (rows, M) of the cells around each ring, in the material's unit
    ColumnLattice(MatrixView<const double> sizes, const Material& material, double height,
                  const ColumnOptions& options = {});

    /// A column that goes on where another, with these rows, loads and exchanges, stood.
    ColumnLattice(std::vector<ColumnRow> rows, std::vector<double> loads, std::uint64_t sweeps,
                  const Material& material, double height, const ColumnOptions& options);

    Index rows() const { return static_cast<Index>(rows_.size()); }
    Index cells() const { return static_cast<Index>(rows_.front().ring.cells.size()); }
    const Material& material() const { return material_; }
    const ColumnOptions& options() const { return options_; }
    double height() const { return height_; }

    /// Takes each row to a load of its own; the weakest cell first where that is a raise. A lower load than before leaves
    /// everything as it is, and is the load of what is exchanged from then on.
    /// @param stress_ratio  (rows) >= 0
    /// @param go_on  asked some times a second; if it answers false (or throws) the column stops there, not yet at rest
    /// @return       whether it came to the end
    /// @throws ShapeError, ParameterError for loads that do not fit
    bool load_to(VectorView<const double> stress_ratio, const std::function<bool()>& go_on = {});

    /// Stands under loads without a crush: what they activate crushes as time goes on, at the drive's rate.
    /// @throws as load_to()
    void stand_under(VectorView<const double> stress_ratio);

    /// Exchanges and crushes for a time, under the loads that stand.
    /// @throws ShapeError, ParameterError for a time or a drive outside its range; of the load that is due: every row must
    ///         have been loaded, be it with 0
    ColumnReport advance(double time, const ColumnDrive& drive, const std::function<bool()>& go_on = {});

    /// (cells) log sizes of a row, ln(size in the material's unit). @throws ShapeError, ParameterError
    void psi(Index row, VectorView<double> out) const;
    /// (cells) how often each grain of a row has crushed, wherever it was then. @throws ParameterError
    VectorView<const std::uint32_t> crushes(Index row) const;
    double mean_crushes(Index row) const;
    /// Mean size by mass.
    double mean_size(Index row) const;
    /// (rows) loads that stand; empty before the first.
    const std::vector<double>& loads() const { return loads_; }
    /// Everything that the future depends on beside loads(), for storage; a constructor takes it back.
    const std::vector<ColumnRow>& state() const { return rows_; }
    /// Exchanges of a colour since the start.
    std::uint64_t sweeps() const { return sweeps_; }

    /// Equal state and equal future; the number of threads does not count.
    friend COMMINUTE_API bool operator==(const ColumnLattice& a, const ColumnLattice& b);
    friend bool operator!=(const ColumnLattice& a, const ColumnLattice& b) { return !(a == b); }

  private:
    struct Bond {
        double mixing, segregation;  // Q of mixing, and of segregation over the difference of the two sizes
        double lower, upper;         // FlowSLM's factors of the rows
        double lower_mean, upper_mean;
    };
    class Settling;

    void require_all(Index rows);
    void add(LatticeRing ring);
    const ColumnRow& checked(Index row) const;
    /// Number that stands for remixings in the keys of a ring.
    std::uint32_t exchanges_so_far() const { return static_cast<std::uint32_t>(sweeps_); }
    void measure();
    Bond bond(Index lower, double time, const ColumnDrive& drive) const;
    double segregation(const Bond& bond, double lower, double upper) const;
    double divided(double time, const ColumnDrive& drive, ColumnReport& report) const;
    std::uint64_t exchange(Index lower, const Bond& bond);
    std::uint64_t crush_weakest(ColumnRow& row, double load, const std::function<bool()>& ask);
    std::uint64_t settle(Index row, double clock);
    std::uint64_t settle_all(const ColumnDrive& drive, double time, const std::function<bool()>& go_on);

    Material material_;
    ColumnOptions options_;
    double height_;
    double largest_psi_ = 0.0;  // of all grains at the start
    std::vector<ColumnRow> rows_;
    std::vector<double> loads_;
    std::uint64_t stream_ = 0;
    std::uint64_t sweeps_ = 0;
};

}  // namespace comminute
