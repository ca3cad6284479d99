// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/fabric.hpp"
#include "comminute/grading.hpp"
#include "comminute/material.hpp"

namespace comminute {

/// How a stochastic lattice is made and run. The results depend on `seed`, `replicas` and `mean` alone.
///
/// @code{.cpp}
/// comminute::LatticeOptions options;
/// options.replicas = 10;
/// options.threads = 2;   // changes no bit of the results
/// @endcode
struct LatticeOptions {
    std::uint64_t seed = 0;          ///< of the random numbers; each replica has a stream of its own
    Index replicas = 1;              ///< >= 1, independent rings
    Mean mean = Mean::arithmetic;    ///< how two neighbours make a neighbourhood grainsize (Eq. 48 or 65)
    Index threads = 1;               ///< >= 1, at most this many rings are worked on at a time
    bool record_avalanches = false;  ///< keep the size of every avalanche, 16 bytes each (`Lattice` only)
};

/// One cell of a ring, which stands for grains of a fixed mass and of one size.
struct LatticeCell {
    double psi;   ///< ln(size / reference size)
    double size;  ///< exp(psi), so that the mean of two neighbours needs no exponential

    static LatticeCell of(double psi) { return {psi, std::exp(psi)}; }
    friend bool operator==(const LatticeCell& a, const LatticeCell& b) {
        return a.psi == b.psi && a.size == b.size;
    }
};

/// Crushes at one value of the load: what a single raise of the load sets off, before it has to rise again.
struct Avalanche {
    double stress_ratio;    ///< the load
    std::uint64_t crushes;  ///< how many, >= 1
    friend bool operator==(const Avalanche& a, const Avalanche& b) {
        return a.stress_ratio == b.stress_ratio && a.crushes == b.crushes;
    }
};

/// One replica: a ring of cells, how often each has crushed, and where its random numbers stand.
struct LatticeRing {
    std::vector<LatticeCell> cells;
    std::vector<std::uint32_t> crushes;  ///< per cell, since the start
    std::vector<double>
        log_strength;  ///< per cell, ln of its factor of the critical load; empty unless strengths scatter
    std::uint64_t stream = 0;           ///< key of its random numbers
    std::uint32_t remixes = 0;          ///< since the start
    std::uint64_t passes = 0;           ///< of the time-stepped lattice, since the start
    std::optional<double> loaded_to;    ///< largest stress ratio since the start or the last remixing
    bool at_rest = true;                ///< false after an interruption: `loaded_to` is still to be finished
    double stepped_to = 0.0;            ///< load of the last pass of the time-stepped lattice
    std::vector<Avalanche> avalanches;  ///< where recorded
    std::size_t avalanches_in_order = 0;  ///< so many of them are complete and in the order of their loads
};

/// A mean over replicas, bin by bin, and its standard error (NaN with a single replica).
struct LatticeEstimate {
    std::vector<double> mean;
    std::vector<double> standard_error;
};

/// The state of the stochastic lattice (Section 2) and what is read from it; `Lattice` and
/// `TimeSteppedLattice` know how to load it.
///
/// Every replica is a ring of M cells of equal mass. A cell crushes at the stress ratio of Eq. 2, where its
/// neighbourhood size is the mean of its two neighbours; it is then made smaller by a factor X drawn from the
/// fragment law. The test is closed, to rounding, as in CrushZones. Copies are independent and go on alike.
///
/// Where strengths scatter (`Material::strength_scatter`), the critical load is that of Eq. 2 times a factor of the cell's
/// own, drawn from the Weibull law of the material's modulus and scale 1 for each grain of the start and for each
/// fragment. A grain keeps its factor when the packing is remixed.
class COMMINUTE_API LatticeState {
  public:
    virtual ~LatticeState() = default;

    Index cells() const { return static_cast<Index>(rings_.front().cells.size()); }
    Index replicas() const { return static_cast<Index>(rings_.size()); }
    const Material& material() const { return material_; }
    const LatticeOptions& options() const { return options_; }

    /// Loads every ring to a stress ratio; nothing happens where a larger one has been reached before.
    ///
    /// @param go_on  asked some times a second; if it answers false (or throws) the lattice stops there, with a
    ///               state that is valid but between loads: the next call, whatever its load, first finishes this one
    /// @return       number of crushes, of all replicas together
    /// @throws ParameterError for a stress ratio that is negative, NaN, or so large that the grains it crushes
    ///         have sizes that a double cannot hold
    std::uint64_t load_to(double stress_ratio, const std::function<bool()>& go_on = {});

    /// Largest stress ratio under which every ring is at rest; none before the first load, after a remixing
    /// and while an interrupted load is unfinished.
    std::optional<double> settled_at() const;

    /// Random permutation of the cells of every ring; forgets the load, since grains meet new neighbours.
    void remix();

    /// (cells) log sizes of one replica, ln(size in the material's unit). @throws ShapeError, ParameterError
    void psi(Index replica, VectorView<double> out) const;
    /// (cells) how often each cell of a replica has crushed since the start; a view. @throws ParameterError
    VectorView<const std::uint32_t> crushes(Index replica) const;
    /// (replicas) crushes per cell since the start.
    std::vector<double> mean_crushes() const;

    /// (replicas, N) mass by bin. What is finer than the grid goes to the fines bin.
    /// @throws ParameterError if a cell is larger than the grid's last edge
    std::vector<std::vector<double>> grainsizes(const LogGrid& grid) const;
    /// Mass fraction finer than the upper edge of each bin, mean over replicas. @throws as grainsizes()
    LatticeEstimate cdf(const LogGrid& grid) const;
    /// Joint histogram of psi and psibar over all replicas on the continuum's own grid. @throws as grainsizes()
    Fabric fabric(const LogGrid& grid) const;

    /// Mass of the cells that have never crushed, by size, mean over replicas, fine to coarse; empty where the start has
    /// more than 16 sizes. In a packing of a few sizes these are the jumps of its cdf.
    std::vector<PointMass> points() const;

    /// Grid that fits the cells as they are and the loads to come: fitting_grid() of sizes spread evenly in ln s between
    /// the finest and the coarsest cell.
    /// @param max_stress_ratio  largest load to come, >= 0 and finite
    /// @throws ParameterError for a load or option outside its range
    LogGrid fitting_grid(double max_stress_ratio, const GridOptions& options = {}) const;

    /// Everything that the future depends on, for storage; the constructors take it back.
    const std::vector<LatticeRing>& rings() const { return rings_; }

    /// Equal state and equal future; the number of threads does not count.
    friend COMMINUTE_API bool operator==(const LatticeState& a, const LatticeState& b);

  protected:
    LatticeState(Index cells, Material material, const Grading& grading, const LatticeOptions& options);
    LatticeState(VectorView<const double> sizes, Material material, const LatticeOptions& options);
    LatticeState(std::vector<LatticeRing> rings, Material material, const LatticeOptions& options);
    LatticeState(const LatticeState&) = default;
    LatticeState(LatticeState&&) = default;
    LatticeState& operator=(const LatticeState&) = default;
    LatticeState& operator=(LatticeState&&) = default;

    /// Takes one ring to a load above the one it stands at; whether it came to the end.
    virtual bool load_ring(LatticeRing& ring, double stress_ratio,
                           const std::function<bool()>& go_on) const = 0;

    std::size_t checked(Index replica) const;
    void require_load(double stress_ratio) const;
    std::uint64_t total_crushes() const;
    void for_each_ring(const std::function<void(LatticeRing&, const std::function<bool()>&)>& work,
                       const std::function<bool()>& go_on);

  private:
    void note_sizes(const std::vector<double>& exact);
    bool come_to_rest(const std::function<bool()>& go_on);

    Material material_;
    LatticeOptions options_;
    std::vector<LatticeRing> rings_;
    std::vector<PointMass>
        exact_;  // sizes of the start, where they are few: ln(size / reference_size), no mass, size
    double largest_ = 0.0;  // of the start
};

/// The quasi-static lattice: the load rises to the smallest critical stress ratio, that cell crushes, and the
/// avalanche it sets off runs at constant load, weakest cell first, before the load rises again. Equally weak cells
/// crush in random order.
///
/// The end of a load does not depend on where the load paused on the way: 2 and then 8 is 8 at once, to the bit.
///
/// @code{.cpp}
/// comminute::Lattice lattice(100'000, comminute::Material{}, comminute::monodisperse(1.0));
/// lattice.load_to(1.0);   // random sequential adsorption: (1 - exp(-2)) / 2 of the cells crush
/// CHECK(lattice.mean_crushes()[0] == doctest::Approx(0.432332).epsilon(0.01));
/// @endcode
class COMMINUTE_API Lattice : public LatticeState {
  public:
    /// @param cells    M >= 2 of each ring, at most 2^32 - 2
    /// @param grading  sizes are drawn from it independently
    /// @throws ParameterError naming the parameter, its value and the rule
    Lattice(Index cells, const Material& material, const Grading& grading,
            const LatticeOptions& options = {});
    /// @param sizes  of the cells around the ring, > 0, in the material's unit; every replica starts with them
    Lattice(VectorView<const double> sizes, const Material& material, const LatticeOptions& options = {});
    /// A lattice that goes on where another, with these rings, stood.
    Lattice(std::vector<LatticeRing> rings, const Material& material, const LatticeOptions& options);

    /// Avalanches of one replica since the start, in the order of their loads (of each stretch between remixings).
    /// @throws ParameterError unless they are recorded
    const std::vector<Avalanche>& avalanches(Index replica) const;

  private:
    bool load_ring(LatticeRing& ring, double stress_ratio, const std::function<bool()>& go_on) const override;
};

/// How a time-stepped lattice raises its load. With the defaults its grading curve is about 0.02 off the quasi-static
/// one for equal sizes, a few thousandths otherwise (stress ratio 8).
///
/// @code{.cpp}
/// comminute::TimeSteppedLattice lattice(1000, {}, comminute::monodisperse(1.0), {0.02, 1.001});
/// CHECK(lattice.stepping().load_factor == 1.001);
/// @endcode
struct TimeStepping {
    double crush_probability = 0.1;  ///< of an active cell in one pass, in (0, 1]
    double load_factor = 1.01;       ///< > 1, from one load to the next; inf: at once to the load asked for
};

/// The lattice of published time-stepping codes, for comparison: neighbourhoods are frozen at the start of a pass,
/// every active cell crushes in it with a given probability, passes are repeated until none is active, and then the
/// load rises by a factor, beginning with the first load that crushes anything.
///
/// As the load factor goes to 1 and the probability to 0 together this becomes `Lattice`. With probability 1 a
/// monodisperse ring crushes whole at once, which is another model.
///
/// @code{.cpp}
/// comminute::TimeSteppedLattice lattice(1000, comminute::Material{}, comminute::monodisperse(1.0), {1.0, 1.01});
/// lattice.pass(1.0);
/// CHECK(lattice.mean_crushes()[0] == 1.0);
/// @endcode
class COMMINUTE_API TimeSteppedLattice : public LatticeState {
  public:
    /// @throws ParameterError as Lattice, and for a probability or a factor outside its range
    TimeSteppedLattice(Index cells, const Material& material, const Grading& grading,
                       const TimeStepping& stepping = {}, const LatticeOptions& options = {});
    TimeSteppedLattice(VectorView<const double> sizes, const Material& material,
                       const TimeStepping& stepping = {}, const LatticeOptions& options = {});
    TimeSteppedLattice(std::vector<LatticeRing> rings, const Material& material, const TimeStepping& stepping,
                       const LatticeOptions& options);

    const TimeStepping& stepping() const { return stepping_; }

    /// One single pass at a load, whether it leaves active cells or not.
    /// @return number of crushes, of all replicas together. @throws ParameterError as load_to()
    std::uint64_t pass(double stress_ratio);

  private:
    bool load_ring(LatticeRing& ring, double stress_ratio, const std::function<bool()>& go_on) const override;

    TimeStepping stepping_;
};

}  // namespace comminute
