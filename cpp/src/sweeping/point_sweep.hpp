// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <utility>
#include <vector>

#include "comminute/fabric.hpp"
#include "sweeping/band_sweep.hpp"

namespace comminute::detail {

/// Brings atoms and ridges to rest: an atom by the zone at its exact place, a ridge by the length of each bin that the
/// zone covers on it. An atom that crushes leaves ridges; what crushes at its exact size enters the bins, where its
/// fragments and the bins of its partner make an outer product. Blend of Eq. 67: (1 - rate) slow + rate fast.
///
/// Between runs it keeps its zones and where the fragments of each exact size land, since a load path meets the same
/// few sizes at every load.
class PointSweep {
  public:
    PointSweep(const LogGrid& grid, const Material& material, FragmentPmf fragments, double rate);

    /// From the load under which the state is at rest to a larger one. Forgets the run before.
    void run(const Fabric& state, double stress_ratio);

    const std::vector<Atom>& atoms() const { return atoms_; }
    std::vector<Ridge> ridges() const;
    std::vector<OuterProduct> arrivals();
    double crushed() const { return crushed_[0]; }
    double crushed_neighbour() const { return crushed_[1]; }

  private:
    using Place = std::pair<Axis, double>;  // which log size is exact, and its value
    /// Mass in a bin or the share of it that moves, in two parts: below and above the ridge's exact size.
    struct Parts {
        double below = 0.0;
        double above = 0.0;
    };
    /// Where the zone begins and ends along a ridge, below its exact size and above it.
    struct Reach {
        double below_from, below_to;
        double above_from, above_to;
    };
    struct Line {
        std::vector<Parts> settled;
        std::vector<Parts> arrived;
    };

    Line& line(Axis exact, double at);
    std::vector<double>& into_bins(Axis exact, double at);
    void crush_atom(const Atom& atom);
    void crush_line(const Place& place, Line& line);
    void fall_along(double mass, Index from, double at, std::vector<Parts>& onto) const;
    void spread(double mass, Index from, std::vector<double>& onto) const;
    void count(Axis axis, double mass) { crushed_[axis == Axis::grain ? 0 : 1] += mass; }
    const std::vector<double>& fragments_of(double at);
    double finer(double psi, double than_fragment_of) const;
    Reach reach(const CrushZones& zones, double at) const;
    Parts active(const Reach& zone, double at, Index bin) const;

    LogGrid grid_;
    Material material_;
    FragmentPmf fragments_;
    double rate_;
    CrushZones before_;
    CrushZones after_;
    std::map<double, std::vector<double>> fragments_of_;  // (N) by exact size
    std::vector<Atom> atoms_;
    std::map<Place, Line> lines_;
    std::map<Place, std::vector<double>>
        into_bins_;  // by what crushed at its exact size: bins of its partners
    double crushed_[2] = {0.0, 0.0};
};

}  // namespace comminute::detail
