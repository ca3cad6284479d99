// SPDX-License-Identifier: BSD-3-Clause
// Crushing of atoms, and of ridges bin by bin from coarse to fine (docs/theory/one_sweep.md, section 11).
#include "sweeping/point_sweep.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "zones/moving_shares.hpp"
#include "zones/shell_zone.hpp"

namespace comminute::detail {
namespace {

constexpr std::size_t most_sizes_kept = 256;  // more of them belong to several fabrics, not to one load path

Axis other(Axis axis) {
    return axis == Axis::grain ? Axis::neighbour : Axis::grain;
}

// Share of [from, to] that the zone covers.
double overlap(double from, double to, double zone_from, double zone_to) {
    if (!(to > from)) return 0.0;
    return std::clamp((std::min(to, zone_to) - std::max(from, zone_from)) / (to - from), 0.0, 1.0);
}

// Equal but for rounding: either grain may be the first to crush.
bool equal_sizes(double a, double b) {
    return std::abs(a - b) <=
           8.0 * std::numeric_limits<double>::epsilon() * std::max({1.0, std::abs(a), std::abs(b)});
}

}  // namespace

PointSweep::PointSweep(const LogGrid& grid, const Material& material, FragmentPmf fragments, double rate)
    : grid_(grid),
      material_(material),
      mass_(std::move(fragments.mass)),
      below_(std::move(fragments.below)),
      rate_(rate),
      before_(grid, material, 0.0),
      after_(grid, material, 0.0) {}

void PointSweep::count(Axis axis, double mass) {
    (axis == Axis::grain ? crushed_grain_ : crushed_neighbour_) += mass;
}

// Probability that a fragment of an exact size ends below psi.
double PointSweep::finer(double psi, double than_fragment_of) const {
    const double r = std::min(psi - than_fragment_of, 0.0);
    return std::visit([r](const auto& law) { return law.cdf(r); }, material_.fragments);
}

// (N) landing places of the fragments of one exact size; the fines bin takes all mass below it.
const Array<double>& PointSweep::fragments_of(double at) {
    Array<double>& pmf = fragments_of_[at];
    if (!pmf.empty()) return pmf;
    pmf.resize(grid_.bins());
    double below = 0.0;
    for (Index i = 0; i < grid_.bins(); ++i) {
        const double finer_than = finer(grid_.edge(i + 1), at);
        pmf[i] = finer_than - below;
        below = finer_than;
    }
    return pmf;
}

PointSweep::RidgeMass& PointSweep::ridge_mass(Axis exact, double at) {
    RidgeMass& found = ridges_[{exact, at}];
    found.settled.resize(grid_.bins());
    found.arrived.resize(grid_.bins());
    return found;
}

Array<double>& PointSweep::into_bins(Axis exact, double at) {
    Array<double>& bins = into_bins_[{exact, at}];
    bins.resize(grid_.bins());
    return bins;
}

// Fragments of an exact size `from`, beside a partner that keeps its exact size `at`: a ridge.
void PointSweep::land_on_ridge(Axis exact, double at, double from, double mass) {
    if (mass == 0.0) return;
    RidgeMass& ridge = ridge_mass(exact, at);
    const Array<double>& pmf = fragments_of(from);
    const Index own = grid_.bin_of(at);
    const double within = finer(grid_.edge(own + 1), from) - finer(at, from);
    for (Index i = 0; i < grid_.bins(); ++i) {
        const double above = i < own ? 0.0 : (i > own ? pmf[i] : std::clamp(within, 0.0, pmf[i]));
        ridge.arrived[i].above += mass * above;
        ridge.arrived[i].below += mass * (pmf[i] - above);
    }
}

void PointSweep::crush_atom(const Atom& atom) {
    const double grain = equal_sizes(atom.psi, atom.psibar) ? 0.5 : (atom.psi > atom.psibar ? 1.0 : 0.0);
    const double slow = (1.0 - rate_) * atom.mass;
    land_on_ridge(Axis::neighbour, atom.psibar, atom.psi, slow * grain);
    land_on_ridge(Axis::grain, atom.psi, atom.psibar, slow * (1.0 - grain));
    const double fast = rate_ * atom.mass;
    count(Axis::grain, slow * grain + fast);
    count(Axis::neighbour, slow * (1.0 - grain) + fast);
    if (fast == 0.0) return;
    const Array<double>& pmf = fragments_of(atom.psibar);
    Array<double>& partners = into_bins(Axis::grain, atom.psi);
    for (Index j = 0; j < pmf.size(); ++j) partners[j] += fast * pmf[j];
}

// Fragments of mass that crushes along a ridge until it leaves its bin. In the bin of the exact size they land on both
// sides of it.
void PointSweep::fall_along(double mass, Index from, double at, Array<Parts>& onto) const {
    const Index own = grid_.bin_of(at);
    // Rounding may put an exact size that lies on an edge outside its bin by a unit in the last place.
    const double upper_part = std::clamp((grid_.edge(own + 1) - at) / grid_.spacing(), 0.0, 1.0);
    const double leaves = below_[1];
    for (Index k = 0; k < from; ++k) {
        const double share = k == 0 ? below_[from] : mass_[from - k];
        const double landed = mass * share / leaves;
        const double above = k < own ? 0.0 : (k > own ? landed : landed * upper_part);
        onto[k].above += above;
        onto[k].below += landed - above;
    }
}

// Fragments of one crush, some of which stay in the bin.
void PointSweep::spread(double mass, Index from, Array<double>& onto) const {
    if (from == 0) {
        onto[0] += mass;
        return;
    }
    for (Index k = 1; k <= from; ++k) onto[k] += mass * mass_[from - k];
    onto[0] += mass * below_[from];
}

// Below the exact size the zone reaches as far as its half-width there, W. Above it the partner is the larger grain, and
// the zone lies between the roots of D^2 = W^2 + k D, D the partner's log size less the exact one.
PointSweep::Reach PointSweep::reach(const CrushZones& zones, double at) const {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Reach zone{infinity, -infinity, infinity, -infinity};  // nowhere
    const double width = zones.half_width(at);
    if (width >= 0.0) {
        zone.below_from = at - width;
        zone.below_to = at;
    }
    const double k = material_.k();
    const double tip = zone_onset(material_, std::log(zones.stress_ratio()));
    if (std::isinf(k)) {
        zone.above_from = tip;
        zone.above_to = infinity;
        return zone;
    }
    const double square = k * (at - tip);
    const double discriminant = 0.25 * k * k + square;
    if (!(discriminant >= 0.0)) return zone;
    const double far = 0.5 * k + std::sqrt(discriminant);
    zone.above_from = at + (square < 0.0 ? -square / far : 0.0);
    zone.above_to = at + far;
    return zone;
}

// Shares of the two parts of a bin that lie in the zone.
PointSweep::Parts PointSweep::active(const Reach& zone, double at, Index bin) const {
    const double from = grid_.edge(bin);
    const double to = grid_.edge(bin + 1);
    return {overlap(from, std::min(to, at), zone.below_from, zone.below_to),
            overlap(std::max(from, at), to, zone.above_from, zone.above_to)};
}

// Above the exact size the partner is the larger grain and crushes along the ridge; under fast loading the grain of exact
// size crushes too, and its mass enters the bins.
void PointSweep::crush_above(double mass, Index bin, const Place& place, RidgeMass& ridge) {
    const auto [exact, at] = place;
    const double leaves = below_[1];
    const double crushing = mass / (rate_ + (1.0 - rate_) * leaves);
    const double slow = (1.0 - rate_) * crushing;
    fall_along(slow * leaves, bin, at, ridge.arrived);
    count(other(exact), crushing);
    count(exact, rate_ * crushing);
    if (rate_ > 0.0) spread(rate_ * crushing, bin, into_bins(exact, at));
}

// Below the exact size the grain of exact size is the larger one, and its fragments enter the bins.
void PointSweep::crush_below(double mass, Index bin, const Place& place) {
    const auto [exact, at] = place;
    Array<double>& partners = into_bins(exact, at);
    partners[bin] += (1.0 - rate_) * mass;
    count(exact, mass);
    count(other(exact), rate_ * mass);
    if (rate_ > 0.0) spread(rate_ * mass, bin, partners);
}

void PointSweep::crush_ridge(const Place& place, RidgeMass& ridge) {
    const double at = place.second;
    const Reach zone_before = reach(before_, at);
    const Reach zone_after = reach(after_, at);
    for (Index j = grid_.bins() - 1; j >= 0; --j) {
        Parts& settled = ridge.settled[j];
        const Parts arrived = ridge.arrived[j];
        if (settled.sum() + arrived.sum() == 0.0) continue;
        const Parts before = active(zone_before, at, j);
        const Parts after = active(zone_after, at, j);
        const double above =
            moving_shares(before.above, after.above).divide(settled.above, arrived.above, &settled.above);
        const double below =
            moving_shares(before.below, after.below).divide(settled.below, arrived.below, &settled.below);
        if (above > 0.0) crush_above(above, j, place, ridge);
        if (below > 0.0) crush_below(below, j, place);
    }
}

void PointSweep::run(const Fabric& state, double stress_ratio) {
    atoms_.clear();
    ridges_.clear();
    into_bins_.clear();
    crushed_grain_ = crushed_neighbour_ = 0.0;
    if (state.atoms().empty() && state.ridges().empty()) return;
    if (fragments_of_.size() > most_sizes_kept) fragments_of_.clear();
    const double settled = state.settled_at().value_or(0.0);
    if (before_.stress_ratio() != settled) before_.set_load(settled);
    if (after_.stress_ratio() != stress_ratio) after_.set_load(stress_ratio);
    for (const Ridge& ridge : state.ridges()) {
        Array<Parts>& there = ridge_mass(ridge.exact, ridge.at).settled;
        const VectorView<const double> mass(ridge.mass);
        const Index own = grid_.bin_of(ridge.at);
        for (Index j = 0; j < grid_.bins(); ++j) {
            const double above = j < own ? 0.0 : (j > own ? mass[j] : ridge.above);
            there[j].above += above;
            there[j].below += mass[j] - above;
        }
    }
    for (const Atom& atom : state.atoms()) {
        if (after_.active(atom.psi, atom.psibar)) {
            crush_atom(atom);
        } else {
            atoms_.push_back(atom);
        }
    }
    for (auto& [place, ridge] : ridges_) crush_ridge(place, ridge);
}

std::vector<Ridge> PointSweep::ridges() const {
    std::vector<Ridge> left;
    for (const auto& [place, mass] : ridges_) {
        Ridge ridge{place.first, place.second, {}, 0.0};
        double total = 0.0;
        for (const Parts& there : mass.settled) {
            ridge.mass.push_back(there.sum());
            total += ridge.mass.back();
        }
        ridge.above = mass.settled[grid_.bin_of(ridge.at)].above;
        if (total > 0.0) left.push_back(std::move(ridge));
    }
    return left;
}

Arrivals PointSweep::arrivals() {
    Arrivals products;
    for (const auto& [place, partners] : into_bins_) {
        const Array<double>& pmf = fragments_of(place.second);
        if (place.first == Axis::grain) {
            products.push_back({pmf, partners});
        } else {
            products.push_back({partners, pmf});
        }
    }
    return products;
}

}  // namespace comminute::detail
