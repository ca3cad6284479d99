// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "comminute/export.hpp"
#include "comminute/fabric.hpp"
#include "comminute/grid.hpp"
#include "comminute/material.hpp"
#include "comminute/resolved_grid.hpp"

namespace comminute {

namespace detail {
class ResolvedAccess;
}

/// How a law of three cells is stepped.
struct ResolvedOptions {
    Mean mean = Mean::arithmetic;
    double tolerance = 0.02;  ///< > 0, mass that the zone may overrun in one step
    double max_step = 0.25;   ///< > 0, of ln(stress ratio)
    Index threads = 1;        ///< 1 or 2: the coarse and the fine state at a time; the same bits
};

/// All that the future of one state depends on.
struct TripleRecord {
    std::vector<double> settled;  ///< (N, N, N)
    std::vector<double> pending;  ///< (N, N, N) mass that is active and about to crush
    std::vector<double>
        endured;  ///< (N, N, N) hazard that the settled mass has borne, times it; where strengths scatter
    double level = 0.0;  ///< load
    double crushes = 0.0;
    double avalanches = 0.0;

    friend bool operator==(const TripleRecord& a, const TripleRecord& b) {
        return a.settled == b.settled && a.pending == b.pending && a.endured == b.endured &&
               a.level == b.level && a.crushes == b.crushes && a.avalanches == b.avalanches;
    }
};

/// All that the future of a `Resolved` depends on beside its grid, material and options, for storage.
struct ResolvedRecord {
    TripleRecord coarse;
    TripleRecord fine;
    double log_load = 0.0;  ///< node of the clock
    double hint = 0.0;      ///< step that is tried first after it
    double settled_at = 0.0;
    Index nodes = 0;              ///< of the clock, since the last mixing
    double crushes_before = 0.0;  ///< the last mixing
    double avalanches_before = 0.0;

    friend bool operator==(const ResolvedRecord& a, const ResolvedRecord& b) {
        return a.coarse == b.coarse && a.fine == b.fine && a.log_load == b.log_load && a.hint == b.hint &&
               a.settled_at == b.settled_at && a.nodes == b.nodes && a.crushes_before == b.crushes_before &&
               a.avalanches_before == b.avalanches_before;
    }
};

/// The neighbour-resolved continuum: the law P(b; a, c) of three adjacent cells, a centre between two neighbours, in place
/// of the paper's law of a cell and the mean of its neighbours. One crush of the lattice reads exactly these three, so
/// the law needs one closure alone: given two adjacent cells, what is left of them knows nothing of what is right. It
/// has no fitted constant, and its gradings agree with the lattice's to 0.0005 to 0.006, where the paper's are off by
/// 0.065 for equal grains. The derivation stands in docs/theory/three_cells.md.
///
/// Quasi-static and free of noise. A coarse and a fine state go along one clock of loads, of which neither the loads asked
/// for nor their number change a bit, and results are extrapolated from both: second order in the step. Between loads
/// that fall nothing changes.
///
/// Memory is 14 N^3 numbers and some N^2, time N^4 a step, some 200 to 500 of them: for 46 nodes a tenth of a second in
/// all.
///
/// @code{.cpp}
/// comminute::Material material;                                     // fabric width 0.05
/// auto grid = comminute::ResolvedGrid::graded(material.fabric_width, -8.0, {0.0}, {});
/// comminute::Resolved grains(grid, material, comminute::node_pmf(comminute::monodisperse(1.0), grid));
/// grains.load_to(1.0);
/// // random sequential adsorption: (1 - e^-2) / 2 of the grains crush, for 1/2 in the paper's model
/// CHECK(grains.crushes() == doctest::Approx(0.4323324).epsilon(1e-4));
/// CHECK(grains.pmf().back() == doctest::Approx(0.5676676).epsilon(1e-4));
/// grains.load_to(8.0);
/// const auto crushed = grains.pmf();
/// grains.load_to(2.0);                                              // unloading
/// CHECK(grains.pmf() == crushed);
/// @endcode
class COMMINUTE_API Resolved {
  public:
    /// A random mixture at no load.
    /// @param pmf  (N) mass of each node, as `node_pmf` gives it
    /// @throws ShapeError for another number of nodes; ParameterError for a bad material, an infinite fabric width, an
    ///         option outside its range, a negative mass or a total other than 1
    Resolved(const ResolvedGrid& grid, const Material& material, const std::vector<double>& pmf,
             const ResolvedOptions& options = {});
    /// A packing whose neighbours are known, at no load.
    /// @param triples  (N, N, N) mass of the centre b between a and c at [b, a, c], as `count_triples` gives it
    /// @throws as the other, and ParameterError unless a and c are alike, and any two cells adjacent either way
    static Resolved of_triples(const ResolvedGrid& grid, const Material& material,
                               const std::vector<double>& triples, const ResolvedOptions& options = {});
    /// Goes on, to the same bits, from where `record` was taken.
    /// @throws ShapeError for a record of another number of nodes
    Resolved(const ResolvedGrid& grid, const Material& material, const ResolvedRecord& record,
             const ResolvedOptions& options = {});
    ~Resolved();
    Resolved(const Resolved& other);
    Resolved& operator=(const Resolved& other);
    Resolved(Resolved&&) noexcept;
    Resolved& operator=(Resolved&&) noexcept;

    const ResolvedGrid& grid() const;
    const Material& material() const;
    const ResolvedOptions& options() const;

    /// Raises the load; a lower one changes nothing.
    /// @throws ParameterError for a stress ratio that is negative, NaN or above e^700
    void load_to(double stress_ratio);
    /// Mixes the packing anew: a random mixture of the same grains, at no load.
    void remix();

    ResolvedRecord record() const;

    /// (N) mass by node.
    std::vector<double> pmf() const;
    /// (N, N, N) mass of the centre b between a and c at [b, a, c]. Single entries may fall below 0 by the error of a step.
    std::vector<double> triples() const;
    /// (N, N) mass by bins of log grainsize and log neighbourhood grainsize; an exact size goes to the bin that holds it.
    /// @throws ParameterError for a grid below the largest grain
    std::vector<double> joint(const LogGrid& grid) const;
    /// Mean number of crushes a cell has been through since the start.
    double crushes() const;
    /// Avalanches a cell has begun since the start: crushes that the load brought about, not a neighbour's crush.
    double avalanches() const;
    /// Largest difference of the coarse and the fine curve, as a rule several times the error of the result by the steps.
    double step_error() const;
    /// Largest load since the last mixing; 0 before any.
    double settled_at() const;
    /// Steps of both states since the last mixing.
    Index steps() const;

  private:
    friend class detail::ResolvedAccess;
    struct Work;
    explicit Resolved(std::unique_ptr<Work> work);
    std::unique_ptr<Work> work_;
};

/// Counts the triples of a ring of cells.
/// @param psi  log sizes around the ring, at least 3
/// @return     (N, N, N) share of the cells, half of each triple in either direction, as `Resolved::of_triples` takes it
/// @throws     ParameterError for a size that no node holds
COMMINUTE_API std::vector<double> count_triples(VectorView<const double> psi, const ResolvedGrid& grid);

}  // namespace comminute
