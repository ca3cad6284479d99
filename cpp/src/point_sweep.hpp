// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "band_sweep.hpp"
#include "comminute/fabric.hpp"

namespace comminute {

/// Brings atoms and ridges to rest: an atom by the zone at its exact place, a ridge by the length of each bin that the
/// zone covers on it. An atom that crushes leaves ridges; what crushes at its exact size enters the bins, where its
/// fragments and the bins of its partner make an outer product. Blend of Eq. 67: (1 - rate) slow + rate fast.
class PointSweep {
  public:
    PointSweep(const LogGrid& grid, const Material& material, const FragmentPmf& fragments, double rate);

    /// From the load under which the state is at rest to a larger one.
    void run(const Fabric& state, double stress_ratio);

    const std::vector<Atom>& atoms() const { return atoms_; }
    std::vector<Ridge> ridges() const;
    std::vector<OuterProduct> arrivals() const;
    double crushed() const { return crushed_[0]; }
    double crushed_neighbour() const { return crushed_[1]; }

  private:
    using Place = std::pair<Axis, double>;  // which log size is exact, and its value
    /// Mass in a bin or the share of it that moves, in two parts: below and above the ridge's exact size.
    struct Parts {
        double below = 0.0;
        double above = 0.0;
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
    std::vector<double> fragments_of(double at) const;
    double finer(double psi, double than_fragment_of) const;
    Parts active(const CrushZones& zones, double at, Index bin) const;

    LogGrid grid_;
    Material material_;
    const FragmentPmf& fragments_;
    double rate_;
    std::optional<CrushZones> before_;
    std::optional<CrushZones> after_;
    std::vector<Atom> atoms_;
    std::map<Place, Line> lines_;
    std::map<Place, std::vector<double>>
        into_bins_;  // by what crushed at its exact size: bins of its partners
    double crushed_[2] = {0.0, 0.0};
};

}  // namespace comminute
