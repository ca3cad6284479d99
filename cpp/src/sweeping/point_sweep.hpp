// SPDX-License-Identifier: BSD-3-Clause
// Atoms and ridges, mass at exact sizes, brought to rest (docs/theory/one_sweep.md, section 11).
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "base/arrays.hpp"
#include "comminute/criterion.hpp"
#include "comminute/fabric.hpp"
#include "comminute/fragments.hpp"
#include "comminute/material.hpp"
#include "sweeping/outer_product.hpp"

namespace comminute::detail {

/// Brings atoms and ridges to rest: an atom by the zone at its exact place, a ridge by the length of each bin that the
/// zone covers on it. An atom that crushes leaves ridges. Mass that crushes at its exact size enters the bins, where its
/// fragments and the bins of its partner make an outer product. Blend of Eq. 67: (1 - rate) slow + rate fast.
///
/// Between runs it keeps its zones and the landing places of each exact size's fragments, since a load path meets the
/// same few sizes at every load.
class PointSweep {
  public:
    PointSweep(const LogGrid& grid, const Material& material, FragmentPmf fragments, double rate);

    /// Moves from the load under which the state is at rest to a larger one. Forgets the run before.
    void run(const Fabric& state, double stress_ratio);

    const std::vector<Atom>& atoms() const { return atoms_; }
    std::vector<Ridge> ridges() const;
    Arrivals arrivals();
    /// Mass crushed in psi and in psibar, every crush counted.
    double crushed() const { return crushed_grain_; }
    double crushed_neighbour() const { return crushed_neighbour_; }

  private:
    using Place = std::pair<Axis, double>;  // the axis on which the log size is exact, and that log size
    /// Two numbers for one bin of a ridge: for its part below the ridge's exact size and for its part above.
    struct Parts {
        double below = 0.0;
        double above = 0.0;
        double sum() const { return below + above; }
    };
    /// Ends of the zone along a ridge, below its exact size and above it.
    struct Reach {
        double below_from, below_to;
        double above_from, above_to;
    };
    /// (N) mass along a ridge: at rest under the load before, and landed since.
    struct RidgeMass {
        Array<Parts> settled;
        Array<Parts> arrived;
    };

    RidgeMass& ridge_mass(Axis exact, double at);
    Array<double>& into_bins(Axis exact, double at);
    void crush_atom(const Atom& atom);
    void land_on_ridge(Axis exact, double at, double from, double mass);
    void crush_ridge(const Place& place, RidgeMass& ridge);
    void crush_above(double mass, Index bin, const Place& place, RidgeMass& ridge);
    void crush_below(double mass, Index bin, const Place& place);
    void fall_along(double mass, Index from, double at, Array<Parts>& onto) const;
    void spread(double mass, Index from, Array<double>& onto) const;
    void count(Axis axis, double mass);
    const Array<double>& fragments_of(double at);
    double finer(double psi, double than_fragment_of) const;
    Reach reach(const CrushZones& zones, double at) const;
    Parts active(const Reach& zone, double at, Index bin) const;

    LogGrid grid_;
    Material material_;
    Array<double> mass_;   // (N) f_m of the fragments in bins
    Array<double> below_;  // (N) share of mass from bin m that lands in the fines bin
    double rate_;
    CrushZones before_;
    CrushZones after_;
    std::map<double, Array<double>> fragments_of_;  // (N) landing places of fragments, by exact size
    std::vector<Atom> atoms_;
    std::map<Place, RidgeMass> ridges_;
    std::map<Place, Array<double>> into_bins_;  // (N) bins of the partners, by the exact size that crushed
    double crushed_grain_ = 0.0;
    double crushed_neighbour_ = 0.0;
};

}  // namespace comminute::detail
