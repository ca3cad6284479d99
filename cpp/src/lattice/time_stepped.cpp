// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/check.hpp"
#include "comminute/lattice.hpp"
#include "lattice/crush.hpp"
#include "lattice/ring_criterion.hpp"

namespace comminute {

using namespace detail;

namespace {

using Cell = std::uint32_t;

void require_stepping(const TimeStepping& stepping) {
    require(stepping.crush_probability > 0.0 && stepping.crush_probability <= 1.0, "crush_probability",
            stepping.crush_probability, "greater than 0 and at most 1");
    require(stepping.load_factor > 1.0, "load_factor", stepping.load_factor,
            "greater than 1 (inf: no loads on the way)");
}

class Passes {
  public:
    Passes(LatticeRing& ring, const Material& material, Mean mean, double probability)
        : ring_(ring),
          material_(material),
          draw_(material.fragments),
          limit_(material, mean, largest_psi(ring), 0.0),
          probability_(probability),
          listed_(ring.cells.size(), 0) {}

    void set_load(double stress_ratio) {
        limit_.set(closed_log_load(ring_, material_, stress_ratio),
                   std::numeric_limits<std::uint64_t>::max());
        active_.clear();
        for (Cell cell = 0; cell < ring_.cells.size(); ++cell) {
            if (is_active(cell)) active_.push_back(cell);
        }
    }

    bool at_rest() const { return active_.empty(); }

    /// Smallest critical stress ratio of all cells.
    double weakest() {
        limit_.set(std::numeric_limits<double>::infinity(), std::numeric_limits<std::uint64_t>::max());
        double smallest = std::numeric_limits<double>::infinity();
        for (Cell cell = 0; cell < ring_.cells.size(); ++cell) {
            double critical = 0.0;
            look(cell, critical);
            smallest = std::min(smallest, critical);
        }
        return std::exp(smallest);
    }

    // Who crushes is decided for all before the first is crushed: that freezes the neighbourhoods.
    void pass() {
        crushing_.clear();
        for (const Cell cell : active_) {
            if (probability_ == 1.0 ||
                random_uniform(ring_.stream, Purpose::decision, cell, ring_.passes) < probability_)
                crushing_.push_back(cell);
        }
        ++ring_.passes;
        for (const Cell cell : crushing_) crush(ring_, cell, draw_, material_);
        // Only cells that were active, or stand next to one that crushed, can be active now.
        candidates_.swap(active_);
        active_.clear();
        for (const Cell cell : crushing_) {
            candidates_.push_back(previous(cell));
            candidates_.push_back(next(cell));
        }
        for (const Cell cell : candidates_) {
            if (listed_[cell] != 0 || !is_active(cell)) continue;
            listed_[cell] = 1;
            active_.push_back(cell);
        }
        for (const Cell cell : active_) listed_[cell] = 0;
    }

  private:
    Cell next(Cell cell) const { return cell + 1 == ring_.cells.size() ? 0 : cell + 1; }
    Cell previous(Cell cell) const { return (cell == 0 ? static_cast<Cell>(ring_.cells.size()) : cell) - 1; }
    LoadLimit::Look look(Cell cell, double& critical) const {
        return limit_.look(
            ring_.cells[previous(cell)], ring_.cells[cell], ring_.cells[next(cell)],
            log_strength_of(ring_, cell), [] { return std::uint64_t{0}; }, critical);
    }
    bool is_active(Cell cell) const {
        double critical = 0.0;
        return look(cell, critical) == LoadLimit::Look::active;
    }

    LatticeRing& ring_;
    const Material& material_;
    FragmentQuantile draw_;
    LoadLimit limit_;
    double probability_;
    std::vector<unsigned char> listed_;
    std::vector<Cell> active_;
    std::vector<Cell> crushing_;
    std::vector<Cell> candidates_;
};

}  // namespace

TimeSteppedLattice::TimeSteppedLattice(Index cells, const Material& material, const Grading& grading,
                                       const TimeStepping& stepping, const LatticeOptions& options)
    : LatticeState(cells, material, grading, options), stepping_(stepping) {
    require_stepping(stepping);
}

TimeSteppedLattice::TimeSteppedLattice(VectorView<const double> sizes, const Material& material,
                                       const TimeStepping& stepping, const LatticeOptions& options)
    : LatticeState(sizes, material, options), stepping_(stepping) {
    require_stepping(stepping);
}

TimeSteppedLattice::TimeSteppedLattice(std::vector<LatticeRing> rings, const Material& material,
                                       const TimeStepping& stepping, const LatticeOptions& options)
    : LatticeState(std::move(rings), material, options), stepping_(stepping) {
    require_stepping(stepping);
}

bool TimeSteppedLattice::load_ring(LatticeRing& ring, double stress_ratio,
                                   const std::function<bool()>& go_on) const {
    Passes passes(ring, material(), options().mean, stepping_.crush_probability);
    double load = std::min(std::max(passes.weakest(), ring.stepped_to), stress_ratio);
    for (;;) {
        ring.stepped_to = load;
        passes.set_load(load);
        while (!passes.at_rest()) {
            if (go_on && !go_on()) return false;
            passes.pass();
        }
        if (load == stress_ratio) return true;
        load = std::min(load * stepping_.load_factor, stress_ratio);
    }
}

std::uint64_t TimeSteppedLattice::pass(double stress_ratio) {
    require_load(stress_ratio);
    const auto before = total_crushes();
    for_each_ring(
        [&](LatticeRing& ring, const auto&) {
            Passes passes(ring, material(), options().mean, stepping_.crush_probability);
            passes.set_load(stress_ratio);
            passes.pass();
            if (ring.loaded_to && stress_ratio < *ring.loaded_to) return;
            ring.loaded_to = ring.stepped_to = stress_ratio;
            ring.at_rest = passes.at_rest();
        },
        {});
    return total_crushes() - before;
}

}  // namespace comminute
